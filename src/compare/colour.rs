//! The spaces of colour in which differences are seen, all from linear sRGB and white at D65.

type Triple = [f32; 3];

/// CIE XYZ of linear sRGB (IEC 61966-2-1).
const TO_XYZ: [Triple; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The inverse of [`TO_XYZ`].
const FROM_XYZ: [Triple; 3] = [
    [3.241_003_2, -1.537_399, -0.498_615_86],
    [-0.969_224_3, 1.875_93, 0.041_554_23],
    [0.055_639_42, -0.204_011_21, 1.057_149],
];

fn dot(a: Triple, b: Triple) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times(matrix: &[Triple; 3], v: Triple) -> Triple {
    std::array::from_fn(|row| dot(matrix[row], v))
}

/// XYZ of white.
fn white() -> Triple {
    times(&TO_XYZ, [1.0; 3])
}

/// Opponent colours that are linear in light: luminance, red against green, blue against yellow.
pub(super) fn ycxcz(rgb: Triple) -> Triple {
    let (xyz, white) = (times(&TO_XYZ, rgb), white());
    let [x, y, z] = std::array::from_fn(|i| xyz[i] / white[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Linear sRGB of [`ycxcz`].
pub(super) fn from_ycxcz([y, cx, cz]: Triple) -> Triple {
    let y = (y + 16.0) / 116.0;
    let (relative, white) = ([y + cx / 500.0, y, y - cz / 200.0], white());
    times(&FROM_XYZ, std::array::from_fn(|i| relative[i] * white[i]))
}

/// CIE L*a*b*, with a* and b* weighed by lightness: colours of what is dark are seen less (Hunt's effect).
pub(super) fn lab_hunt(rgb: Triple) -> Triple {
    const DELTA: f32 = 6.0 / 29.0;
    let (xyz, white) = (times(&TO_XYZ, rgb), white());
    let f = |t: f32| {
        if t > DELTA * DELTA * DELTA { libm::cbrtf(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = std::array::from_fn(|i| f(xyz[i] / white[i]));
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for rgb in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.2, 0.7, 0.05]] {
            let back = from_ycxcz(ycxcz(rgb));
            assert!(rgb.iter().zip(back).all(|(a, b)| (a - b).abs() < 2e-5), "{rgb:?} {back:?}");
        }
    }

    #[test]
    fn white_is_white() {
        let [l, a, b] = lab_hunt([1.0; 3]);
        assert!((l - 100.0).abs() < 1e-3 && a.abs() < 1e-3 && b.abs() < 1e-3, "{l} {a} {b}");
        // L* of 18 % grey.
        assert!((lab_hunt([0.184_187; 3])[0] - 50.0).abs() < 1e-2);
    }
}
