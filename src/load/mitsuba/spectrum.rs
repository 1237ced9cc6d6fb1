//! Spectral curves, reduced to linear sRGB through the eyes of the standard observer.
//!
//! ```text
//! (X, Y, Z) = ∫ s(λ) w(λ) (x̄, ȳ, z̄)(λ) dλ / ∫ w(λ) ȳ(λ) dλ
//! ```
//!
//! What shines is seen as it is, w = 1. What reflects is seen under daylight, w = D65, so that what is
//! alike at all wavelengths is grey. So does Mitsuba in its RGB mode; its metals known by name are
//! reduced with w = 1. Between its points a curve is linear, beyond them it is 0.

use std::{ops::Range, path::Path};

use super::attributes::Attribute;
use crate::load::{LoadError, cie, text};

/// XYZ to linear sRGB, for D65 white, as IEC 61966-2-1 has it.
const TO_SRGB: [[f64; 3]; 3] = [
    [3.240_479, -1.537_15, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

/// Values over wavelengths in nanometres, which ascend; at least two.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve(Vec<(f64, f64)>);

impl Curve {
    /// `400:0.1, 500:0.2`: pairs separated by commas, blanks or both.
    pub(super) fn parse(attribute: &Attribute) -> Result<Self, LoadError> {
        let words = attribute.value.split(|c: char| c == ',' || c.is_whitespace());
        let refuse = |why: String| {
            attribute.error(why).help("write wavelengths in nanometres, as in `400:0.1, 500:0.2`")
        };
        let mut points = Vec::new();
        for word in words.filter(|word| !word.is_empty()) {
            let pair = word.split_once(':').and_then(|(at, value)| point(at, value));
            let pair = pair.ok_or_else(|| refuse(format!("`{word}` is not a wavelength and a value")))?;
            follows(&points, pair).map_err(refuse)?;
            points.push(pair);
        }
        match points.len() {
            0 | 1 => Err(refuse("a curve needs two points at least".into())),
            _ => Ok(Self(points)),
        }
    }

    /// An `.spd` file: a wavelength and a value a line, remarks after `#`.
    pub(super) fn read(path: &Path) -> Result<Self, LoadError> {
        let text = text::read(path)?;
        let at = |range: Range<usize>, why: String| {
            LoadError::at(path, &text, range, why)
                .help("each line has a wavelength in nanometres and a value")
        };
        let mut points = Vec::new();
        for line in text.lines() {
            let content = line.split('#').next().unwrap_or_default().trim();
            if content.is_empty() {
                continue;
            }
            let mut words = content.split_whitespace();
            let pair = words.next().zip(words.next()).and_then(|(at, value)| point(at, value));
            let range = text::range_of(&text, content);
            let Some(pair) = pair.filter(|_| words.next().is_none()) else {
                return Err(at(range, format!("`{content}` is not a wavelength and a value")));
            };
            follows(&points, pair).map_err(|why| at(range, why))?;
            points.push(pair);
        }
        match points.len() {
            0 | 1 => Err(LoadError::new(path, "a curve needs two points at least")),
            _ => Ok(Self(points)),
        }
    }

    /// The largest value.
    pub(super) fn most(&self) -> f64 {
        self.0.iter().fold(0.0, |most, &(_, value)| most.max(value))
    }

    /// The colour of a light. Components may be negative, for colours that sRGB lacks.
    pub(super) fn emitted(&self) -> [f64; 3] {
        self.reduced(|_| 1.0)
    }

    /// The colour of a surface under daylight, or a coefficient of it.
    pub(super) fn reflected(&self) -> [f64; 3] {
        self.reduced(|[.., daylight]| daylight)
    }

    fn reduced(&self, weight: impl Fn([f64; 4]) -> f64) -> [f64; 3] {
        let mut xyz = [0.0; 3];
        let mut white = 0.0;
        // The middle of each nanometre: curves that break off do so between two of them.
        for nanometre in cie::VISIBLE {
            let wavelength = f64::from(nanometre) + 0.5;
            let row = cie::row(wavelength);
            let weight = weight(row);
            let value = self.at(wavelength) * weight;
            white += weight * row[1];
            for (sum, response) in xyz.iter_mut().zip(row) {
                *sum += value * response;
            }
        }
        TO_SRGB.map(|[x, y, z]| (x * xyz[0] + y * xyz[1] + z * xyz[2]) / white)
    }

    fn at(&self, wavelength: f64) -> f64 {
        let above = self.0.partition_point(|&(at, _)| at < wavelength);
        match (above.checked_sub(1).map(|below| self.0[below]), self.0.get(above)) {
            (_, Some(&(at, value))) if at == wavelength => value,
            (Some((from, low)), Some(&(to, high))) => low + (high - low) * (wavelength - from) / (to - from),
            _ => 0.0,
        }
    }
}

fn point(wavelength: &str, value: &str) -> Option<(f64, f64)> {
    let number = |word: &str| {
        word.trim().parse::<f64>().ok().filter(|x| x.is_finite() && x.abs() <= f64::from(f32::MAX))
    };
    number(wavelength).zip(number(value))
}

fn follows(points: &[(f64, f64)], (wavelength, value): (f64, f64)) -> Result<(), String> {
    if value < 0.0 {
        return Err(format!("the value {value} at {wavelength} nm is negative"));
    }
    match points.last() {
        Some(&(before, _)) if before >= wavelength => {
            Err(format!("the wavelength {wavelength} follows {before}: wavelengths have to ascend"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::mitsuba::presets::CONDUCTORS;

    #[track_caller]
    fn close(got: [f64; 3], want: [f64; 3], tolerance: f64) {
        let far = got.iter().zip(want).any(|(got, want)| (got - want).abs() > tolerance);
        assert!(!far, "   found {got:?}\nexpected {want:?}");
    }

    fn curve(points: &[(f64, f64)]) -> Curve {
        Curve(points.to_vec())
    }

    #[test]
    fn grey_is_grey_and_equal_energy_is_not() {
        let flat = curve(&[(360.0, 0.5), (830.0, 0.5)]);
        close(flat.reflected(), [0.5; 3], 2e-4);
        close(flat.emitted(), [1.2048, 0.9483, 0.9089].map(|band| band / 2.0), 2e-4);
    }

    /// What Mitsuba 3.9.1 makes of the same curves in `scalar_rgb`. Its sums under daylight take 1000 steps of
    /// 470/1000 nm for 999: a thousandth less than its own norm.
    #[test]
    fn curves_have_mitsubas_colours() {
        let lamp = curve(&[(400.0, 0.0), (500.0, 8.0), (600.0, 15.6), (700.0, 18.4)]);
        close(lamp.emitted(), [20.7108, 10.8546, 2.771_15], 5e-3);
        let daylight = |rgb: [f64; 3]| rgb.map(|band| band / 0.999);
        let flat = curve(&[(400.0, 0.78), (700.0, 0.78)]).reflected();
        close(flat, daylight([0.776_367, 0.779_81, 0.776_029]), 5e-4);
        let red = curve(&[(400.0, 0.4), (500.0, 0.1), (550.0, 0.6), (700.0, 0.3)]);
        close(red.reflected(), daylight([0.568_308, 0.435_65, 0.207_878]), 5e-4);
        let cyan = curve(&[(450.0, 2.0), (550.0, 3.0)]);
        close(cyan.emitted(), [-1.143_06, 1.782_61, 1.039_26], 1e-2);
    }

    #[test]
    fn metals_have_mitsubas_constants() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes/brdf/ior");
        if !folder.is_dir() {
            eprintln!("skipped: there is no {}", folder.display());
            return;
        }
        let read = |name: &str, what: &str| Curve::read(&folder.join(format!("{name}.{what}.spd"))).unwrap();
        for name in ["Au", "Ag", "Cu"] {
            let (_, eta, k) = CONDUCTORS.iter().find(|(known, ..)| *known == name).unwrap();
            close(read(name, "eta").emitted(), eta.map(f64::from), 2e-3);
            close(read(name, "k").emitted(), k.map(f64::from), 2e-3);
        }
        // As a `spectrum` element in Mitsuba, which weighs by daylight.
        close(
            read("Au", "eta").reflected(),
            [0.079_870_5, 0.404_652, 1.558_97].map(|band| band / 0.999),
            2e-3,
        );
        close(read("Cu", "k").reflected(), [3.270_16, 2.5896, 2.366_34].map(|band| band / 0.999), 2e-3);
    }

    #[test]
    fn between_points_curves_are_linear_and_beyond_them_nothing() {
        let curve = curve(&[(400.0, 1.0), (500.0, 3.0)]);
        let at = [399.9, 400.0, 450.0, 500.0, 500.1].map(|wavelength| curve.at(wavelength));
        assert_eq!(at, [0.0, 1.0, 2.0, 3.0, 0.0]);
    }

    #[test]
    fn files_are_refused_with_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.spd");
        for (text, expected) in [
            ("# n\n400 1\n500 x\n", "a.spd:3:1: `500 x` is not a wavelength and a value"),
            ("400 1\n  500 1 2", "a.spd:2:3: `500 1 2` is not a wavelength and a value"),
            ("400 1\n400 2", "a.spd:2:1: the wavelength 400 follows 400: wavelengths have to ascend"),
            ("400 1\n500 -2", "a.spd:2:1: the value -2 at 500 nm is negative"),
            ("400 1e99", "a.spd:1:1: `400 1e99` is not"),
            ("400 1 # alone", "a.spd: a curve needs two points at least"),
        ] {
            std::fs::write(&path, text).unwrap();
            let found = Curve::read(&path).unwrap_err().to_string();
            assert!(found.contains(expected), "{found}");
        }
        std::fs::write(&path, "# λ v\n400 1 # first\n\n500\t2\n").unwrap();
        assert_eq!(Curve::read(&path).unwrap(), curve(&[(400.0, 1.0), (500.0, 2.0)]));
    }
}
