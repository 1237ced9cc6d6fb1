//! How two pictures of one size differ, in numbers and in false colours.
//!
//! Pictures are planes `R G B` of linear light. One is the reference r, the other the test t.

mod colour;
mod false_colour;
mod flip;
mod plane;

pub use false_colour::false_colours;
pub use flip::{flip_hdr, flip_ldr};

use crate::picture::Picture;

/// Why two pictures can't be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// They have other sizes.
    #[error("the pictures have {0} x {1} and {2} x {3} pixels; only equal sizes can be compared")]
    Sizes(u32, u32, u32, u32),
    /// A picture without colours.
    #[error("only pictures with the channels R, G and B can be compared")]
    NoColours,
}

/// What can be said of all pixels together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Mean of the test in that of the reference, of each colour; NaN where both are black.
    pub mean_ratio: [f64; 3],
    /// Mean of (t − r)² / (r² + 0.01) over pixels and colours.
    pub rel_mse: f64,
    /// Root of the mean of (t − r)², in the numbers of the pictures: linear light.
    pub rmse: f64,
    /// The largest |t − r|, likewise.
    pub largest: f64,
    /// Numbers that differ in any bit, of all.
    pub different: u64,
    /// Pixels with a number that is not finite in either picture; they are left out of all but
    /// `different`.
    pub not_finite: u64,
}

/// The planes of both pictures, reference and test.
type Planes<'a> = ([&'a [f32]; 3], [&'a [f32]; 3]);

fn planes<'a>(reference: &'a Picture, test: &'a Picture) -> Result<Planes<'a>, CompareError> {
    if (reference.width, reference.height) != (test.width, test.height) {
        return Err(CompareError::Sizes(reference.width, reference.height, test.width, test.height));
    }
    let colours = |picture: &'a Picture| {
        let [r, g, b] = ["R", "G", "B"].map(|name| picture.plane(name));
        r.zip(g).zip(b).map(|((r, g), b)| [r, g, b]).ok_or(CompareError::NoColours)
    };
    Ok((colours(reference)?, colours(test)?))
}

/// Compares all pixels.
///
/// # Errors
/// [`CompareError`].
pub fn difference(reference: &Picture, test: &Picture) -> Result<Difference, CompareError> {
    let (reference, test) = planes(reference, test)?;
    let pixels = reference[0].len();
    let (mut sums, mut rel, mut squares) = ([[0.0f64; 3]; 2], 0.0, 0.0);
    let (mut largest, mut different, mut not_finite) = (0.0f64, 0, 0);
    for i in 0..pixels {
        let (r, t) = (reference.map(|plane| plane[i]), test.map(|plane| plane[i]));
        different += r.iter().zip(&t).filter(|(r, t)| r.to_bits() != t.to_bits()).count() as u64;
        if !r.iter().chain(&t).all(|x| x.is_finite()) {
            not_finite += 1;
            continue;
        }
        for c in 0..3 {
            let (r, t) = (f64::from(r[c]), f64::from(t[c]));
            sums[0][c] += r;
            sums[1][c] += t;
            squares += (t - r) * (t - r);
            rel += (t - r) * (t - r) / (r * r + 0.01);
            largest = largest.max((t - r).abs());
        }
    }
    let count = 3.0 * (pixels as f64 - not_finite as f64).max(1.0);
    Ok(Difference {
        mean_ratio: std::array::from_fn(|c| sums[1][c] / sums[0][c]),
        rel_mse: rel / count,
        rmse: (squares / count).sqrt(),
        largest,
        different,
        not_finite,
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::picture::Channel;

    pub(crate) fn picture(width: u32, height: u32, value: impl Fn(usize, usize) -> f32) -> Picture {
        let samples = |c: usize| (0..(width * height) as usize).map(|i| value(i, c)).collect();
        let channels = ["R", "G", "B"].iter().enumerate();
        let channels = channels.map(|(c, &name)| Channel { name: name.into(), samples: samples(c) });
        Picture { width, height, channels: channels.collect(), place: None }
    }

    #[test]
    fn numbers_of_two_pixels() {
        let reference = picture(2, 1, |i, _| [1.0, 2.0][i]);
        let test = picture(2, 1, |i, c| [1.0, 2.0 + c as f32][i]);
        let difference = difference(&reference, &test).unwrap();
        assert_eq!(difference.mean_ratio, [1.0, 4.0 / 3.0, 5.0 / 3.0]);
        assert!((difference.rel_mse - (1.0 + 4.0) / 4.01 / 6.0).abs() < 1e-12);
        assert!((difference.rmse - (5.0f64 / 6.0).sqrt()).abs() < 1e-12);
        assert_eq!((difference.largest, difference.different, difference.not_finite), (2.0, 2, 0));
    }

    #[test]
    fn what_is_not_finite_is_left_out_and_counted() {
        let reference = picture(2, 1, |_, _| 1.0);
        let test = picture(2, 1, |i, _| [f32::NAN, 1.0][i]);
        let difference = difference(&reference, &test).unwrap();
        assert_eq!((difference.rel_mse, difference.not_finite, difference.different), (0.0, 1, 3));
    }

    #[test]
    fn other_sizes_are_refused() {
        let (a, b) = (picture(2, 1, |_, _| 1.0), picture(1, 2, |_, _| 1.0));
        assert_eq!(difference(&a, &b), Err(CompareError::Sizes(2, 1, 1, 2)));
        assert_eq!(
            difference(&a, &Picture { width: 2, height: 1, ..Picture::default() }),
            Err(CompareError::NoColours)
        );
    }
}
