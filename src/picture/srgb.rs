//! The transfer functions of sRGB, IEC 61966-2-1.
//!
//! Powers come from `libm` in double precision, so that a picture has the same bits on every platform.

use std::sync::LazyLock;

/// Encoded value to linear light; both in [0, 1].
pub(super) fn to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        libm::pow((f64::from(encoded) + 0.055) / 1.055, 2.4) as f32
    }
}

/// Linear light to encoded value; both in [0, 1].
pub(super) fn from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        (1.055 * libm::pow(f64::from(linear), 1.0 / 2.4) - 0.055) as f32
    }
}

/// [`to_linear`] of the 256 values of a byte.
pub(super) static BYTE_TO_LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| to_linear(byte as f32 / 255.0)));

/// Linear light to the nearest byte; clamped, and 0 for NaN.
pub(super) fn to_byte(linear: f32) -> u8 {
    // NaN is not greater than 0.
    let clamped = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    (from_linear(clamped) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_round_trip() {
        for byte in 0..=255 {
            assert_eq!(to_byte(BYTE_TO_LINEAR[usize::from(byte)]), byte);
        }
    }

    #[test]
    fn known_values() {
        assert_eq!(to_linear(0.0), 0.0);
        assert_eq!(to_linear(1.0), 1.0);
        assert!((to_linear(0.5) - 0.214_041_14).abs() < 1e-7);
        assert!((from_linear(0.18) - 0.461_356_13).abs() < 1e-6);
        assert!((to_linear(10.0 / 255.0) - 10.0 / 255.0 / 12.92).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_colour_is_clamped() {
        assert_eq!(to_byte(f32::NAN), 0);
        assert_eq!(to_byte(-1.0), 0);
        assert_eq!(to_byte(f32::INFINITY), 255);
        assert_eq!(to_byte(7.0), 255);
    }
}
