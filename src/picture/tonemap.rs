//! Light to what a screen can show.
//!
//! A PNG holds 0 to 1, light has no end. A curve decides what becomes of what is brighter. Input is linear
//! sRGB after exposure, output is linear light of the screen, to be encoded as sRGB.

/// What becomes of light that is brighter than the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// It is white, colour by colour.
    #[default]
    Clip,
    /// x / (1 + x) of the luminance \[RSSF02\] (equation 3): never white, colours stay.
    Reinhard,
    /// Hill's fit of the Academy's reference rendering for an sRGB screen \[Hil17\].
    Aces,
    /// AgX \[Sob22\] in Wrensch's polynomial \[Wre23\]: bright colours go to white without changing hue.
    Agx,
}

impl Tone {
    /// The colour on the screen; not yet clamped to [0, 1] by [`Tone::Clip`].
    pub(super) fn map(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Clip => rgb,
            Self::Reinhard => {
                let luminance = dot([0.2126, 0.7152, 0.0722], rgb);
                rgb.map(|x| x / (1.0 + luminance.max(0.0)))
            }
            Self::Aces => aces(rgb),
            Self::Agx => agx(rgb),
        }
    }
}

type Matrix = [[f32; 3]; 3];

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times(matrix: Matrix, v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| dot(row, v))
}

fn aces(rgb: [f32; 3]) -> [f32; 3] {
    // sRGB to the rendering space of the Academy, and back from the screen's, with their saturation.
    const IN: Matrix =
        [[0.597_19, 0.354_58, 0.048_23], [0.076, 0.908_34, 0.015_66], [0.028_4, 0.133_83, 0.837_77]];
    const OUT: Matrix = [
        [1.604_75, -0.531_08, -0.073_67],
        [-0.102_08, 1.108_13, -0.006_05],
        [-0.003_27, -0.072_76, 1.076_02],
    ];
    let curve =
        |x: f32| (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081);
    // Beyond this the curve has reached its end, and its squares would reach that of the floats.
    const ENOUGH: f32 = 1e6;
    times(OUT, times(IN, rgb).map(|x| curve(x.clamp(0.0, ENOUGH))))
}

fn agx(rgb: [f32; 3]) -> [f32; 3] {
    const IN: Matrix = [
        [0.842_479_06, 0.078_433_6, 0.079_223_745],
        [0.042_328_242, 0.878_468_6, 0.079_166_13],
        [0.042_375_654, 0.078_433_6, 0.879_143],
    ];
    const OUT: Matrix = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_635, -0.098_043_45, 1.151_073_7],
    ];
    // Stops about middle grey that the curve spans.
    const LEAST: f32 = -12.473_93;
    const MOST: f32 = 4.026_069;
    let curve = |x: f32| {
        let stops = libm::log2f(x.max(1e-10)).clamp(LEAST, MOST);
        let x = (stops - LEAST) / (MOST - LEAST);
        let coefficients = [15.5, -40.14, 31.96, -6.868, 0.429_8, 0.119_1, -0.002_32];
        coefficients.into_iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
    };
    // What comes out is encoded for a screen of gamma 2.2.
    times(OUT, times(IN, rgb).map(curve)).map(|x| libm::powf(x.max(0.0), 2.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Tone; 4] = [Tone::Clip, Tone::Reinhard, Tone::Aces, Tone::Agx];

    #[test]
    fn black_stays_black_and_brighter_stays_brighter() {
        for tone in ALL {
            let grey = |x: f32| tone.map([x; 3])[1];
            assert!(grey(0.0).abs() < 2e-3, "{tone:?}: {}", grey(0.0));
            let mut last = grey(0.01);
            for step in 1..40 {
                let next = grey(0.01 * (0.25 * step as f32).exp2());
                assert!(next >= last - 1e-6, "{tone:?}: {next} after {last}");
                last = next;
            }
            assert!(tone == Tone::Clip || last < 1.1, "{tone:?}: {last}");
        }
    }

    #[test]
    fn grey_stays_grey() {
        for tone in ALL {
            for x in [0.02, 0.18, 1.0, 6.0] {
                let rgb = tone.map([x; 3]);
                assert!(rgb.iter().all(|c| (c - rgb[1]).abs() < 4e-3), "{tone:?}: {rgb:?}");
            }
        }
    }

    #[test]
    fn known_values() {
        assert_eq!(Tone::Reinhard.map([1.0; 3]), [0.5; 3]);
        // The curve of the Academy's screens brings 18 % grey to about a tenth.
        let grey = Tone::Aces.map([0.18; 3])[0];
        assert!((0.09..0.12).contains(&grey), "{grey}");
        // AgX brings middle grey to the middle of what is encoded, ½ to the power of 2.2.
        let grey = Tone::Agx.map([0.18; 3])[0];
        assert!((0.20..0.23).contains(&grey), "{grey}");
    }

    #[test]
    fn very_bright_is_still_a_number() {
        for tone in ALL {
            assert!(tone.map([1e30, 1e30, 0.0]).iter().all(|x| x.is_finite()), "{tone:?}");
        }
    }
}
