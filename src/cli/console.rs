//! stdout: what was asked for, and nothing else.

use std::io::{self, ErrorKind, Write, stdout};

use serde::Serialize;

use super::failure::Failure;

/// Writes to stdout. A reader that has had enough (`packlight info … | head -1`) is not a failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    forgive(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// One JSON object and a newline.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print(&(json + "\n"))
}

/// One JSON object on a line of its own.
pub(super) fn print_json_line(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print(&(json + "\n"))
}

fn forgive(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Sentence(format!("can't write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_broken_pipe_is_forgiven() {
        assert!(forgive(Ok(())).is_ok());
        assert!(forgive(Err(ErrorKind::BrokenPipe.into())).is_ok());
        assert!(forgive(Err(ErrorKind::StorageFull.into())).is_err());
    }
}
