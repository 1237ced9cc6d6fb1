//! Measured reflection as text: the `.brdf` files of Cornell's Program of Computer Graphics.
//!
//! ```text
//! # a comment to the end of the line
//! 31                                         how many wavelengths
//! 400 410 … 700                              which, in nanometres
//! θ_i φ_i θ_o φ_o  f f … f                   radians, and f per steradian at each wavelength
//! ```
//!
//! Line ends mean nothing. Directions stand wherever the instrument happened to look, so they are
//! interpolated into the table that measured materials have.

mod scattered;

use std::{f64::consts::FRAC_PI_2, ops::Range, path::Path};

use super::{
    LoadError,
    spectrum::Observer,
    text::{self, range_of},
};
use crate::scene::MerlTable;
use scattered::{Scattered, tabulate};

/// Wavelengths in one file: more is a mistake, not an instrument.
const MAX_WAVELENGTHS: usize = 1024;
/// Measurements in one file. Each is compared with each node of the table that they become, so their number is a
/// matter of seconds; an instrument has some 1,400.
const MAX_MEASUREMENTS: usize = 10_000;
/// Directions may lie below the horizon by the last digit that was written.
const HORIZON: f64 = FRAC_PI_2 + 1e-5;

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<MerlTable, LoadError> {
    let text = text::read(path)?;
    let measurements = parse(path, &text)?;
    tabulate(&measurements).ok_or_else(|| {
        LoadError::new(path, format!("has {} measurements, too few for a table", measurements.len()))
    })
}

fn parse(path: &Path, text: &str) -> Result<Vec<Scattered>, LoadError> {
    let mut numbers = Numbers { path, text, words: words(text).collect::<Vec<_>>().into_iter() };
    let count = numbers.next("the number of wavelengths")?;
    if count.value.fract() != 0.0 || !(1.0..=MAX_WAVELENGTHS as f64).contains(&count.value) {
        let message = format!("`{}` is no number of wavelengths", &text[count.range.clone()]);
        return Err(numbers
            .error(count.range, message)
            .help(format!("a file starts with how many there are, from 1 to {MAX_WAVELENGTHS}")));
    }
    let mut wavelengths = Vec::new();
    for _ in 0..count.value as usize {
        let number = numbers.next("a wavelength")?;
        if number.value <= wavelengths.last().copied().unwrap_or(0.0) {
            return Err(numbers.error(number.range, "wavelengths must be positive and ascend"));
        }
        wavelengths.push(number.value);
    }
    let observer = Observer::new(&wavelengths);
    let mut found = Vec::new();
    let mut values = Vec::new();
    while !numbers.words.as_slice().is_empty() {
        let mut angle = |what: &str, polar: bool| {
            let number = numbers.next(what)?;
            match polar && !(0.0..=HORIZON).contains(&number.value) {
                true => Err(numbers
                    .error(number.range, format!("{what} of {} is not above the surface", number.value))
                    .help("it must lie between 0 and π/2 radians; are lines missing a number?")),
                false => Ok(number.value),
            }
        };
        let (theta_i, phi_i) = (angle("θ_i", true)?, angle("φ_i", false)?);
        let (theta_o, phi_o) = (angle("θ_o", true)?, angle("φ_o", false)?);
        values.clear();
        for wavelength in &wavelengths {
            values.push(numbers.next(&format!("f at {wavelength} nm"))?.value);
        }
        let (theta_i, theta_o) = (theta_i.min(FRAC_PI_2), theta_o.min(FRAC_PI_2));
        if found.len() == MAX_MEASUREMENTS {
            return Err(LoadError::new(path, format!("has more than {MAX_MEASUREMENTS} measurements"))
                .help("leave some out: the table that is made of them is coarser than that"));
        }
        found.push(Scattered { theta_i, theta_o, turn: phi_o - phi_i, value: observer.rgb(&values) });
    }
    Ok(found)
}

/// Words outside of comments.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace())
}

struct Number {
    value: f64,
    range: Range<usize>,
}

struct Numbers<'a> {
    path: &'a Path,
    text: &'a str,
    words: std::vec::IntoIter<&'a str>,
}

impl Numbers<'_> {
    fn error(&self, range: Range<usize>, message: impl Into<String>) -> LoadError {
        LoadError::at(self.path, self.text, range, message)
    }

    fn next(&mut self, what: &str) -> Result<Number, LoadError> {
        let Some(word) = self.words.next() else {
            let end = self.text.trim_end().len();
            return Err(self
                .error(end.saturating_sub(1)..end, format!("the file ends where {what} should stand"))
                .help("each measurement is four angles and a value a wavelength"));
        };
        let range = range_of(self.text, word);
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() && value.abs() <= f64::from(f32::MAX) => {
                Ok(Number { value, range })
            }
            _ => Err(self.error(range, format!("`{word}` is not a finite number: {what} should stand here"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "# two bands\n2 # of them\n450 600\n0.1 0 0.2 3.1 0.5 0.25\n0.3 0 0.2 0 0.5\n0.25\n";

    fn refusal(text: &str) -> String {
        parse(Path::new("a.brdf"), text).expect_err(text).to_string()
    }

    #[test]
    fn numbers_stand_where_they_like() {
        let found = parse(Path::new("a.brdf"), GOOD).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!((found[1].theta_i, found[1].theta_o, found[1].turn), (0.3, 0.2, 0.0));
        assert_eq!(found[0].value, found[1].value);
    }

    #[test]
    fn there_may_be_too_many() {
        let many = |count| "1\n500\n".to_owned() + &"0.1 0 0.2 0 0.5\n".repeat(count);
        assert_eq!(parse(Path::new("a.brdf"), &many(MAX_MEASUREMENTS)).unwrap().len(), MAX_MEASUREMENTS);
        assert_eq!(refusal(&many(MAX_MEASUREMENTS + 1)), "a.brdf: has more than 10000 measurements");
    }

    #[test]
    fn bad_files_are_told_with_their_line() {
        for (text, expected) in [
            ("", "a.brdf:1:1: the file ends where the number of wavelengths should stand"),
            ("# only\n# comments\n", "a.brdf:2:10: the file ends where the number of wavelengths"),
            ("2.5\n", "a.brdf:1:1: `2.5` is no number of wavelengths"),
            ("99999\n", "a.brdf:1:1: `99999` is no number of wavelengths"),
            ("2\n450 440\n", "a.brdf:2:5: wavelengths must be positive and ascend"),
            ("2\n450 600\n0.1 0 0.2 0 0.5 nan\n", "a.brdf:3:17: `nan` is not a finite number: f at 600 nm"),
            ("2\n450 600\n0.1 0 0.2 0 0.5 x\n", "a.brdf:3:17: `x` is not a finite number"),
            ("2\n450 600\n0.1 0 0.2 0 0.5\n", "a.brdf:3:15: the file ends where f at 600 nm should stand"),
            ("2\n450 600\n0.1 0 2.2 0 0.5 0.5\n", "a.brdf:3:7: θ_o of 2.2 is not above the surface"),
        ] {
            let found = refusal(text);
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }
}
