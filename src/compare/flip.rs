//! ꟻLIP: what an observer sees who flips between two pictures \[ANA20\].
//!
//! Colours are blurred as the eye blurs them, and the distance between them is raised to a power that shrinks
//! where edges or points come or go:
//!
//! ```text
//! ΔE = (ΔE_c)^(1 − ΔE_f)   in [0, 1], of each pixel
//! ```
//!
//! For pictures without an upper end \[ANM21\] it is the largest over exposures, from where the brightest pixel
//! is just not white to where the median is not.

use super::{CompareError, colour, plane::Plane, planes};
use crate::picture::Picture;

/// Pixels a degree: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
const PIXELS_PER_DEGREE: f32 = 3840.0 * std::f32::consts::PI / 180.0;

/// Exponent and knee of the colour distance, and what the knee becomes.
const Q_C: f32 = 0.7;
const P_C: f32 = 0.4;
const P_T: f32 = 0.95;
/// Exponent of the feature distance.
const Q_F: f32 = 0.5;
/// Width of the feature detector in degrees.
const FEATURE_WIDTH: f32 = 0.082;

/// Contrast sensitivity: weight and width of the Gaussians of luminance, red against green, and blue against
/// yellow, which has two.
const LUMINANCE: [(f32, f32); 1] = [(1.0, 0.0047)];
const RED_GREEN: [(f32, f32); 1] = [(1.0, 0.0053)];
const BLUE_YELLOW: [(f32, f32); 2] = [(34.1, 0.04), (13.5, 0.025)];
const WIDEST: f32 = 0.04;

/// ꟻLIP of each pixel, of pictures on a screen: linear light, clamped to [0, 1].
///
/// # Errors
/// [`CompareError`].
pub fn flip_ldr(reference: &Picture, test: &Picture) -> Result<Vec<f32>, CompareError> {
    let (r, t) = planes(reference, test)?;
    let width = reference.width as usize;
    Ok(flip(width, &clamped(r, |x| x), &clamped(t, |x| x)))
}

/// ꟻLIP of each pixel, of light without an upper end.
///
/// # Errors
/// [`CompareError`].
pub fn flip_hdr(reference: &Picture, test: &Picture) -> Result<Vec<f32>, CompareError> {
    let (r, t) = planes(reference, test)?;
    let width = reference.width as usize;
    let (first, last) = exposures(r);
    let count = (last - first).ceil().max(2.0) as u32;
    let mut worst = vec![0.0f32; r[0].len()];
    for step in 0..count {
        let stops = first + (last - first) * step as f32 / (count - 1) as f32;
        let scale = libm::exp2f(stops);
        let shown = |planes| clamped(planes, |x| tone(x * scale));
        let errors = flip(width, &shown(r), &shown(t));
        worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
    }
    Ok(worst)
}

/// Pixels in [0, 1]; what is not a number is black.
fn clamped(planes: [&[f32]; 3], tone: impl Fn(f32) -> f32) -> Vec<[f32; 3]> {
    let value = |x: f32| if x > 0.0 { tone(x).clamp(0.0, 1.0) } else { 0.0 };
    (0..planes[0].len()).map(|i| planes.map(|plane| value(plane[i]))).collect()
}

/// The curve under which exposures are compared: the numerator's and the denominator's coefficients of x²,
/// x and 1.
const TONE: [[f32; 3]; 2] = [[0.36 * 2.51, 0.6 * 0.03, 0.0], [0.36 * 2.43, 0.6 * 0.59, 0.14]];

fn tone(x: f32) -> f32 {
    // Its limit is reached long before the squares overflow.
    let x = x.min(1e9);
    let [above, below] = TONE.map(|[a, b, c]| (a * x + b) * x + c);
    above / below
}

/// Stops, from the brightest pixel to the median one: where each is brought to 0.85.
fn exposures(planes: [&[f32]; 3]) -> (f32, f32) {
    const WHITE: f32 = 0.85;
    let [a, b, c] = std::array::from_fn(|i| TONE[0][i] - WHITE * TONE[1][i]);
    let x = (-b + (b * b - 4.0 * a * c).max(0.0).sqrt()) / (2.0 * a);
    let x_other = (-b - (b * b - 4.0 * a * c).max(0.0).sqrt()) / (2.0 * a);
    let x = x.max(x_other);
    let luminance = |i: usize| 0.2126 * planes[0][i] + 0.7152 * planes[1][i] + 0.0722 * planes[2][i];
    let mut luminances: Vec<f32> =
        (0..planes[0].len()).map(luminance).map(|y| if y.is_finite() { y.max(0.0) } else { 0.0 }).collect();
    luminances.sort_by(f32::total_cmp);
    // Of an even number, the middle of the two in the middle.
    let (n, last) = (luminances.len(), luminances.len() - 1);
    let median = 0.5 * (luminances[last / 2] + luminances[n / 2]);
    let stops = |y: f32| libm::log2f(x / y.max(f32::MIN_POSITIVE));
    let first = stops(luminances[last]);
    // A picture that is half black has no median to speak of.
    (first, stops(median.max(1e-4)).max(first))
}

fn flip(width: usize, reference: &[[f32; 3]], test: &[[f32; 3]]) -> Vec<f32> {
    let (reference, test) = (opponent(width, reference), opponent(width, test));
    let colours = colour_distance(&reference, &test);
    let features = feature_distance(&reference[0], &test[0]);
    colours.into_iter().zip(features).map(|(colour, feature)| libm::powf(colour, 1.0 - feature)).collect()
}

fn opponent(width: usize, pixels: &[[f32; 3]]) -> [Plane; 3] {
    let pixels: Vec<[f32; 3]> = pixels.iter().map(|&rgb| colour::ycxcz(rgb)).collect();
    std::array::from_fn(|c| Plane { width, values: pixels.iter().map(|pixel| pixel[c]).collect() })
}

fn colour_distance(reference: &[Plane; 3], test: &[Plane; 3]) -> Vec<f32> {
    let seen = |planes: &[Plane; 3]| -> Vec<[f32; 3]> {
        let [y, cx, cz] = [
            blurred(&planes[0], &LUMINANCE),
            blurred(&planes[1], &RED_GREEN),
            blurred(&planes[2], &BLUE_YELLOW),
        ];
        let rgb = |i: usize| colour::from_ycxcz([y.values[i], cx.values[i], cz.values[i]]);
        (0..y.values.len()).map(|i| colour::lab_hunt(rgb(i).map(|x| x.clamp(0.0, 1.0)))).collect()
    };
    let distance = |a: [f32; 3], b: [f32; 3]| {
        let [l, x, y] = std::array::from_fn(|i| a[i] - b[i]);
        libm::powf(l.abs() + (x * x + y * y).sqrt(), Q_C)
    };
    let most = distance(colour::lab_hunt([0.0, 1.0, 0.0]), colour::lab_hunt([0.0, 0.0, 1.0]));
    let knee = P_C * most;
    let spread = |d: f32| {
        if d < knee { P_T / knee * d } else { P_T + (d - knee) / (most - knee) * (1.0 - P_T) }
    };
    seen(reference).into_iter().zip(seen(test)).map(|(a, b)| spread(distance(a, b))).collect()
}

/// By the contrast sensitivity of one opponent colour.
fn blurred(plane: &Plane, gaussians: &[(f32, f32)]) -> Plane {
    let pi = std::f32::consts::PI;
    let radius = (3.0 * (WIDEST / (2.0 * pi * pi)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let kernel = |width: f32| -> Vec<f32> {
        let degrees = |x: i32| x as f32 / PIXELS_PER_DEGREE;
        (-radius..=radius).map(|x| libm::expf(-pi * pi * degrees(x) * degrees(x) / width)).collect()
    };
    // A sum over a square is the square of the sum over its side.
    let mass = |kernel: &[f32]| kernel.iter().sum::<f32>() * kernel.iter().sum::<f32>();
    let parts: Vec<(f32, Vec<f32>)> =
        gaussians.iter().map(|&(weight, width)| (weight * (pi / width).sqrt(), kernel(width))).collect();
    let total: f32 = parts.iter().map(|(weight, kernel)| weight * mass(kernel)).sum();
    let blurs = parts.iter().map(|(weight, kernel)| {
        let scaled: Vec<f32> = kernel.iter().map(|x| x * weight / total).collect();
        plane.convolved(kernel, &scaled)
    });
    blurs.reduce(|a, b| a.combined(&b, |a, b| a + b)).unwrap_or_else(|| plane.clone())
}

fn feature_distance(reference: &Plane, test: &Plane) -> Vec<f32> {
    let (reference, test) = (features(reference), features(test));
    let [edges, points] = std::array::from_fn(|i| reference[i].combined(&test[i], |a, b| (a - b).abs()));
    let largest = edges.combined(&points, f32::max);
    largest.values.into_iter().map(|d| libm::powf(d * std::f32::consts::FRAC_1_SQRT_2, Q_F)).collect()
}

/// How much of an edge, and of a point, is at each pixel.
fn features(luminance: &Plane) -> [Plane; 2] {
    let normalised = Plane {
        width: luminance.width,
        values: luminance.values.iter().map(|y| (y + 16.0) / 116.0).collect(),
    };
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let gaussian = |x: f32| libm::expf(-x * x / (2.0 * deviation * deviation));
    let across: Vec<f32> = (-radius..=radius).map(|x| gaussian(x as f32)).collect();
    let sum: f32 = across.iter().sum();
    let across: Vec<f32> = across.iter().map(|x| x / sum).collect();
    let detectors: [fn(f32, f32) -> f32; 2] =
        [|x, _| -x, |x, deviation| x * x / (deviation * deviation) - 1.0];
    detectors.map(|detector| {
        let along: Vec<f32> =
            (-radius..=radius).map(|x| detector(x as f32, deviation) * gaussian(x as f32)).collect();
        let mass = |sign: f32| along.iter().map(|x| (sign * x).max(0.0)).sum::<f32>();
        let (positive, negative) = (mass(1.0), mass(-1.0));
        let along: Vec<f32> =
            along.iter().map(|x| if *x > 0.0 { x / positive } else { x / negative }).collect();
        let (x, y) = (normalised.convolved(&along, &across), normalised.convolved(&across, &along));
        x.combined(&y, |x, y| (x * x + y * y).sqrt())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::picture;

    fn mean(errors: &[f32]) -> f32 {
        errors.iter().sum::<f32>() / errors.len() as f32
    }

    #[test]
    fn the_same_picture_is_no_difference() {
        let same = picture(9, 7, |i, c| (i * 7 + c) as f32 * 0.01);
        assert!(flip_ldr(&same, &same).unwrap().iter().all(|&error| error == 0.0));
        assert!(flip_hdr(&same, &same).unwrap().iter().all(|&error| error == 0.0));
    }

    #[test]
    fn green_and_blue_are_as_far_apart_as_can_be() {
        let (green, blue) =
            (picture(30, 30, |_, c| [0.0, 1.0, 0.0][c]), picture(30, 30, |_, c| [0.0, 0.0, 1.0][c]));
        let errors = flip_ldr(&green, &blue).unwrap();
        assert!((mean(&errors) - 1.0).abs() < 1e-3, "{}", mean(&errors));
    }

    #[test]
    fn a_point_is_seen_and_errors_stay_below_one() {
        let flat = picture(31, 31, |_, _| 0.2);
        let point = picture(31, 31, |i, _| if i == 15 * 31 + 15 { 1.0 } else { 0.2 });
        let errors = flip_ldr(&flat, &point).unwrap();
        assert!(errors[15 * 31 + 15] > 0.2 && errors[0] < 1e-3, "{} {}", errors[15 * 31 + 15], errors[0]);
        assert!(errors.iter().all(|error| (0.0..=1.0).contains(error)));
    }

    #[test]
    fn brighter_and_darker_light_is_compared_where_it_is_seen() {
        let (dim, bright) = (picture(8, 8, |i, _| i as f32), picture(8, 8, |i, _| 1.5 * i as f32));
        let scaled = |by: f32| picture(8, 8, move |i, _| by * i as f32);
        let one = mean(&flip_hdr(&dim, &bright).unwrap());
        let other = mean(&flip_hdr(&scaled(1000.0), &scaled(1500.0)).unwrap());
        assert!(one > 0.02 && (one - other).abs() < 1e-3, "{one} {other}");
    }
}
