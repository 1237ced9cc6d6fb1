//! Spans of time on the command line.

use std::time::Duration;

/// For clap: `60s`, `90`, `5m`, `1.5h`, `250ms`.
pub(super) fn parse(argument: &str) -> Result<Duration, String> {
    let digits = argument.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &argument[digits.len()..] {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => f64::NAN,
    };
    let seconds = digits.trim().parse::<f64>().map_or(f64::NAN, |number| number * unit);
    // A year is as good as for ever, and what is not a number is not positive.
    if seconds > 0.0 && seconds <= 366.0 * 86_400.0 {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err("expected a span of time, as in 60s, 5m, 1.5h or 250ms".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_understood() {
        for (text, seconds) in [("60s", 60.0), ("90", 90.0), ("5m", 300.0), ("1.5h", 5400.0), ("250ms", 0.25)]
        {
            assert_eq!(parse(text), Ok(Duration::from_secs_f64(seconds)));
        }
        for wrong in ["", "s", "0", "-1s", "5 parsecs", "nan", "inf", "1e300h"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
