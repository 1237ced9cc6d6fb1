//! Numbers in [0, 1] as colours whose lightness rises: black, violet, red, yellow, white.

use crate::picture::{Channel, Picture};

/// Encoded sRGB at equal steps.
const STOPS: [[f32; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [0.25, 0.05, 0.42],
    [0.60, 0.13, 0.45],
    [0.90, 0.35, 0.25],
    [0.99, 0.72, 0.22],
    [1.0, 1.0, 0.93],
];

/// A picture of values, linear light, to be written as it is.
pub fn false_colours(width: u32, values: &[f32]) -> Picture {
    let colour = |value: f32| {
        let scaled = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
        let below = (scaled as usize).min(STOPS.len() - 2);
        let share = scaled - below as f32;
        std::array::from_fn(|c| linear(STOPS[below][c] + (STOPS[below + 1][c] - STOPS[below][c]) * share))
    };
    let pixels: Vec<[f32; 3]> = values.iter().map(|&value| colour(value)).collect();
    let plane = |c: usize| pixels.iter().map(|pixel| pixel[c]).collect();
    let channels = ["R", "G", "B"].into_iter().enumerate();
    let channels = channels.map(|(c, name)| Channel { name: name.into(), samples: plane(c) });
    let height = (values.len() / width.max(1) as usize) as u32;
    Picture { width, height, channels: channels.collect(), place: None }
}

/// Light of an encoded value, by the power that is nearest to the curve of sRGB.
fn linear(encoded: f32) -> f32 {
    libm::powf(encoded, 2.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_lighter() {
        let values: Vec<f32> = (0..=100).map(|i| i as f32 / 100.0).collect();
        let picture = false_colours(101, &values);
        let plane = |name: &str| picture.plane(name).unwrap().to_vec();
        let (r, g, b) = (plane("R"), plane("G"), plane("B"));
        let lightness: Vec<f32> = (0..101).map(|i| 0.2126 * r[i] + 0.7152 * g[i] + 0.0722 * b[i]).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((picture.width, picture.height), (101, 1));
    }
}
