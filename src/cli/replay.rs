//! `packlight render SCENE --pixel X,Y [--sample N]`: samples of one pixel by themselves, as numbers.

use std::fmt;

use serde::Serialize;

use crate::{
    compile::Scene,
    render::{self, Settings},
};

/// Values of some samples of a pixel, by channel.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Replay {
    scene: String,
    pixel: [u32; 2],
    channels: Vec<String>,
    samples: Vec<Sample>,
}

#[derive(Clone, Debug, Serialize)]
struct Sample {
    sample: u32,
    /// Text where JSON has no number: `NaN`, `inf`, `-inf`.
    values: Vec<Value>,
}

/// A number that may be none.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum Value {
    Finite(f32),
    Other(String),
}

impl From<f32> for Value {
    fn from(value: f32) -> Self {
        if value.is_finite() { Self::Finite(value) } else { Self::Other(value.to_string()) }
    }
}

impl Replay {
    /// One sample, or all that the pixel has.
    pub(super) fn new(
        scene: &Scene,
        name: String,
        settings: &Settings,
        pixel: [u32; 2],
        one: Option<u32>,
    ) -> Self {
        let numbers = one.map_or(0..scene.sampler.sample_count, |n| n..n.saturating_add(1));
        let mut channels = Vec::new();
        let mut samples = Vec::new();
        for sample in numbers {
            let (names, values): (Vec<_>, Vec<_>) =
                render::replay(scene, settings, pixel.into(), sample).into_iter().unzip();
            channels = names;
            samples.push(Sample { sample, values: values.into_iter().map(Value::from).collect() });
        }
        Self { scene: name, pixel, channels, samples }
    }
}

impl fmt::Display for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.pixel;
        writeln!(f, "{}, pixel ({x}, {y})", self.scene)?;
        write!(f, "  sample")?;
        for channel in &self.channels {
            write!(f, " {channel:>14}")?;
        }
        writeln!(f)?;
        for Sample { sample, values } in &self.samples {
            write!(f, "  {sample:>6}")?;
            for value in values {
                match value {
                    Value::Finite(number) => write!(f, " {number:>14}")?,
                    Value::Other(text) => write!(f, " {text:>14}")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// For clap: two whole numbers.
pub(super) fn pixel(argument: &str) -> Result<[u32; 2], String> {
    let numbers = argument.split_once(',').map(|(x, y)| (x.trim().parse(), y.trim().parse()));
    match numbers {
        Some((Ok(x), Ok(y))) => Ok([x, y]),
        _ => Err("expected column,row, as in --pixel 3,4".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_two_whole_numbers() {
        assert_eq!(pixel("3, 4"), Ok([3, 4]));
        for wrong in ["3", "3,4,5", "-1,2", "a,b"] {
            assert!(pixel(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_in_words() {
        let sample = Sample { sample: 7, values: [0.5, f32::NAN, f32::INFINITY].map(Value::from).into() };
        let channels = ["R", "G", "B"].map(String::from).into();
        let replay = Replay { scene: "a.xml".into(), pixel: [3, 4], channels, samples: vec![sample] };
        let text = replay.to_string();
        for part in ["a.xml, pixel (3, 4)", "     7 ", "0.5", "NaN", "inf"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        let json = serde_json::to_string(&replay).unwrap();
        assert!(json.contains(r#"[0.5,"NaN","inf"]"#), "{json}");
    }
}
