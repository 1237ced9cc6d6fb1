//! `$name` in attributes: values from the command line and from `<default>`.

use std::path::Path;

use super::{source::Span, vocabulary::did_you_mean};
use crate::load::LoadError;

/// Most parameters of a scene: each use of one looks at all of them.
const MAX_PARAMETERS: usize = 4096;
/// Most bytes that parameters may put into a scene: forty defaults, each twice the one before, would be 2⁴⁰.
const MAX_WRITTEN: usize = 16 << 20;

/// The parameters known so far.
#[derive(Debug)]
pub(super) struct Parameters {
    known: Vec<Parameter>,
    /// Bytes that took the place of names.
    written: usize,
}

#[derive(Debug)]
struct Parameter {
    name: String,
    value: String,
    used: bool,
    from_command_line: bool,
}

impl Parameters {
    pub(super) fn new(defines: &[(String, String)]) -> Self {
        let mut parameters = Self { known: Vec::new(), written: 0 };
        // The last definition of a name wins, as on other command lines.
        for (name, value) in defines.iter().rev() {
            parameters.add(name, value, true);
        }
        parameters
    }

    fn add(&mut self, name: &str, value: &str, from_command_line: bool) {
        match self.known.iter_mut().find(|known| known.name == name) {
            Some(known) => known.used |= !from_command_line,
            None => self.known.push(Parameter {
                name: name.into(),
                value: value.into(),
                used: false,
                from_command_line,
            }),
        }
    }

    /// `<default>`: a value for a parameter that has none yet.
    ///
    /// # Errors
    /// If there are too many parameters.
    pub(super) fn default(&mut self, name: &str, value: &str, span: &Span) -> Result<(), LoadError> {
        self.add(name, value, false);
        match self.known.len() > MAX_PARAMETERS {
            true => Err(span.error(format!("the scene has more than {MAX_PARAMETERS} parameters"))),
            false => Ok(()),
        }
    }

    /// The text with every `$name` replaced.
    pub(super) fn substitute(&mut self, text: &str, span: &Span) -> Result<String, LoadError> {
        let mut pieces = text.split('$');
        let mut result = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            // The longest name: `$size_y` is not `$size` followed by `_y` if both are known.
            let best = self
                .known
                .iter_mut()
                .filter(|known| piece.starts_with(&known.name))
                .max_by_key(|known| known.name.len());
            let Some(parameter) = best else {
                let end = piece.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(piece.len());
                let name = &piece[..end];
                return Err(span
                    .error(format!("the parameter `${name}` has no value"))
                    .label("unknown parameter")
                    .help(match self.known.is_empty() {
                        true => format!(
                            "write <default name=\"{name}\" value=\"…\"/> before its use, or give -D {name}=…"
                        ),
                        false => did_you_mean(
                            name,
                            self.known.iter().map(|p| p.name.as_str()),
                            "the parameters here",
                        ),
                    }));
            };
            parameter.used = true;
            self.written += parameter.value.len();
            if self.written > MAX_WRITTEN {
                let limit = MAX_WRITTEN >> 20;
                return Err(span
                    .error(format!("the parameters put more than {limit} MiB into the scene"))
                    .help("parameters whose values name others several times grow like a power of two"));
            }
            result += &parameter.value;
            result += &piece[parameter.name.len()..];
        }
        Ok(result)
    }

    /// # Errors
    /// If the command line gave a parameter that the scene doesn't have.
    pub(super) fn finish(&self, path: &Path) -> Result<(), LoadError> {
        let Some(unused) = self.known.iter().find(|p| p.from_command_line && !p.used) else { return Ok(()) };
        let others = self.known.iter().filter(|p| p.used).map(|p| p.name.as_str());
        Err(LoadError::new(path, format!("the scene has no parameter `{}`", unused.name)).help(did_you_mean(
            &unused.name,
            others,
            "parameters of this scene",
        )))
    }
}
