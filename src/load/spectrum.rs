//! Measured reflectance at a few wavelengths to linear sRGB.
//!
//! ```text
//! X = X_w ∫ R x̄ S dλ / ∫ x̄ S dλ        likewise Y and Z; S = D65, X_w its tristimulus
//! ```
//!
//! with the CIE 1931 observer. A surface that reflects everything is (1, 1, 1),
//! whichever wavelengths were measured.

use super::cie;

/// XYZ of D65 to linear sRGB, IEC 61966-2-1, and XYZ of its white.
const TO_RGB: [[f64; 3]; 3] = [
    [3.240_625_5, -1.537_208, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];
const WHITE: [f64; 3] = [0.950_456, 1.0, 1.089_058];

/// Weights that turn values at some wavelengths into linear sRGB.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Observer {
    /// R, G and B of a reflectance of 1 in each band and 0 in the others.
    bands: Vec<[f64; 3]>,
}

impl Observer {
    /// For ascending wavelengths in nanometres; each stands for the wavelengths nearest to it.
    pub(super) fn new(wavelengths: &[f64]) -> Self {
        let last = wavelengths.len() - 1;
        let weigh = |i: usize| {
            let (low, high) = (wavelengths[i.saturating_sub(1)], wavelengths[(i + 1).min(last)]);
            let [x, y, z, daylight] = cie::row(wavelengths[i]);
            let power = daylight * if last > 0 { high - low } else { 1.0 };
            [x, y, z].map(|curve| curve * power)
        };
        let bands: Vec<[f64; 3]> = (0..=last).map(weigh).collect();
        let total = [0, 1, 2].map(|k| bands.iter().map(|band| band[k]).sum::<f64>());
        let to_rgb = |band: [f64; 3]| {
            let xyz = [0, 1, 2].map(|k| if total[k] > 0.0 { WHITE[k] * band[k] / total[k] } else { 0.0 });
            TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
        };
        Self { bands: bands.into_iter().map(to_rgb).collect() }
    }

    /// Linear sRGB of a value at each wavelength; what lies outside the gamut is cut off at 0.
    pub(super) fn rgb(&self, values: &[f64]) -> [f32; 3] {
        [0, 1, 2].map(|k| {
            let sum: f64 = self.bands.iter().zip(values).map(|(band, value)| band[k] * value).sum();
            sum.max(0.0) as f32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wavelengths() -> Vec<f64> {
        (0..31).map(|i| 400.0 + 10.0 * f64::from(i)).collect()
    }

    #[test]
    fn white_is_white_and_grey_is_grey() {
        for wavelengths in [wavelengths(), vec![450.0, 550.0, 600.0], vec![400.0, 410.0, 500.0, 690.0]] {
            let observer = Observer::new(&wavelengths);
            for value in [1.0, 0.2] {
                for channel in observer.rgb(&vec![value; wavelengths.len()]) {
                    assert!((f64::from(channel) - value).abs() < 2e-4 * value, "{channel}");
                }
            }
        }
    }

    #[test]
    fn bands_have_their_colours() {
        let observer = Observer::new(&wavelengths());
        let band = |from: f64, to: f64| {
            let values: Vec<f64> =
                wavelengths().into_iter().map(|w| f64::from(u8::from((from..to).contains(&w)))).collect();
            observer.rgb(&values)
        };
        let [r, g, b] = band(600.0, 701.0);
        assert!(r > 0.5 && g < 0.1 && b < 0.05, "{r} {g} {b}");
        let [r, g, b] = band(500.0, 580.0);
        assert!(g > 0.5 && r < 0.35 && b < 0.2, "{r} {g} {b}");
        let [r, g, b] = band(400.0, 490.0);
        assert!(b > 0.7 && r < 0.2 && g < 0.2, "{r} {g} {b}");
    }

    #[test]
    fn the_curves_are_those_of_the_observer() {
        // CIE 1931, from the standard's table: y̅(555) = 1, x̅(600) = 1.0622, z̅(450) = 1.7721.
        assert!((cie::row(555.0)[1] - 1.0).abs() < 0.02);
        assert!((cie::row(600.0)[0] - 1.0622).abs() < 0.02);
        assert!((cie::row(450.0)[2] - 1.7721).abs() < 0.05);
    }
}
