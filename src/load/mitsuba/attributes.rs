//! The attributes of one element: taken by name, and none may be left over.

use super::{
    source::Span,
    vocabulary::{did_you_mean, listed},
};
use crate::load::LoadError;

/// `name="value"`, parameters substituted.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) value: String,
    /// Of the name.
    pub(super) name_span: Span,
    /// Of the value.
    pub(super) span: Span,
}

/// The attributes of an element.
#[derive(Debug)]
pub(super) struct Attributes {
    pub(super) element: String,
    /// Of the element's name.
    pub(super) tag: Span,
    list: Vec<Attribute>,
    known: Vec<&'static str>,
}

impl Attributes {
    pub(super) fn new(element: &str, tag: Span, list: Vec<Attribute>) -> Self {
        Self { element: element.to_owned(), tag, list, known: Vec::new() }
    }

    pub(super) fn take(&mut self, name: &'static str) -> Option<Attribute> {
        self.known.push(name);
        let place = self.list.iter().position(|attribute| attribute.name == name)?;
        Some(self.list.remove(place))
    }

    pub(super) fn require(&mut self, name: &'static str) -> Result<Attribute, LoadError> {
        if let Some(attribute) = self.take(name) {
            return Ok(attribute);
        }
        let error = self.tag.error(format!("`{}` needs the attribute `{name}`", self.element));
        let stranger = self.list.first().map_or("", |attribute| attribute.name.as_str());
        match super::vocabulary::nearest(stranger, [name]) {
            Some(_) => Err(error.help(format!("did you mean `{name}` by `{stranger}`?"))),
            None => Err(error.help(format!("write <{} {name}=\"…\"", self.element))),
        }
    }

    /// # Errors
    /// If an attribute has not been taken.
    pub(super) fn finish(mut self) -> Result<(), LoadError> {
        let Some(stranger) = self.list.pop() else { return Ok(()) };
        let known = std::mem::take(&mut self.known);
        let error = stranger
            .name_span
            .error(format!("`{}` has no attribute `{}`", self.element, stranger.name))
            .label("unknown attribute");
        Err(error.help(did_you_mean(&stranger.name, known, "the attributes here")))
    }

    /// Three numbers from `x`, `y`, `z` (each `missing` if absent) or from `value`.
    pub(super) fn triple(&mut self, missing: f64) -> Result<Option<[f64; 3]>, LoadError> {
        let xyz = [self.take("x"), self.take("y"), self.take("z")];
        let Some(value) = self.take("value") else {
            if xyz.iter().all(Option::is_none) {
                return Ok(None);
            }
            let mut triple = [missing; 3];
            for (number, attribute) in triple.iter_mut().zip(xyz) {
                if let Some(attribute) = attribute {
                    *number = attribute.number()?;
                }
            }
            return Ok(Some(triple));
        };
        if xyz.iter().any(Option::is_some) {
            return Err(value
                .name_span
                .error("`value` and `x`, `y`, `z` exclude each other")
                .help("write one or the other"));
        }
        value.array().map(Some)
    }
}

impl Attribute {
    /// An error that underlines the value.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.span.error(message)
    }

    /// The value as a finite number that fits 32 bits.
    pub(super) fn number(&self) -> Result<f64, LoadError> {
        self.parse_number(self.value.trim())
    }

    fn parse_number(&self, word: &str) -> Result<f64, LoadError> {
        let number: f64 = word.parse().map_err(|_| {
            self.error(format!("`{word}` is not a number"))
                .label("expected a number")
                .help("numbers look like `2`, `-0.5` or `1e-3`; several are separated by blanks or commas")
        })?;
        if !number.is_finite() || number.abs() > f64::from(f32::MAX) {
            return Err(self
                .error(format!("`{word}` is not a finite number of 32 bits"))
                .help("magnitudes up to 3.4e38 can be rendered"));
        }
        Ok(number)
    }

    /// The value as numbers separated by commas, blanks or both.
    pub(super) fn numbers(&self) -> Result<Vec<f64>, LoadError> {
        self.value
            .split(|c: char| c == ',' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .map(|word| self.parse_number(word))
            .collect()
    }

    /// The value as exactly `N` numbers.
    pub(super) fn array<const N: usize>(&self) -> Result<[f64; N], LoadError> {
        let numbers = self.numbers()?;
        let found = numbers.len();
        numbers
            .try_into()
            .map_err(|_| self.error(format!("expected {N} numbers, found {found}")).label("counted here"))
    }

    /// The value as an integer.
    pub(super) fn integer(&self) -> Result<i64, LoadError> {
        let word = self.value.trim();
        word.parse().map_err(|_| {
            self.error(format!("`{word}` is not an integer")).help("integers look like `64` or `-1`")
        })
    }

    /// The value as `true` or `false`.
    pub(super) fn boolean(&self) -> Result<bool, LoadError> {
        match self.value.trim() {
            "true" => Ok(true),
            "false" => Ok(false),
            other => Err(self
                .error(format!("`{other}` is not a boolean"))
                .help(format!("booleans are {}", listed(["true", "false"])))),
        }
    }
}
