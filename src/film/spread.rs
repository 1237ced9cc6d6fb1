//! How far a tile still is from its limit, from what its samples say of themselves.
//!
//! Samples of a pixel are stratified and say nothing one by one; means of whole blocks do. With block means
//! b₁ … bₙ of a pixel's luminance, the variance of their mean is
//!
//! ```text
//! V = (Σ b² − (Σ b)² / n) / (n (n − 1))
//! ```
//!
//! and the *relative error* of a tile is √(mean of V) / (mean of b), over its pixels. It has no unit and no
//! constant in units of the scene. Later blocks fill the strata that earlier ones left, so V is rather too
//! large than too small.

use super::sums::Sums;

/// Blocks without which nothing is said: with fewer, a tile that by chance saw no light would be done.
const LEAST_BLOCKS: u32 = 4;

/// Block means of luminance over a tile's pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// n.
    pub blocks: u32,
    /// Σ b of each pixel.
    pub sums: Vec<f32>,
    /// Σ b² of each pixel.
    pub squares: Vec<f32>,
}

impl Spread {
    /// Of no blocks.
    pub fn new(pixels: usize) -> Self {
        Self { blocks: 0, sums: vec![0.0; pixels], squares: vec![0.0; pixels] }
    }

    /// Takes in a finished block, whose first three channels are R, G and B.
    pub(super) fn add(&mut self, block: &Sums) {
        let colours = block.plane(0).zip(block.plane(1)).zip(block.plane(2)).zip(block.counts());
        for ((sum, square), (((r, g), b), &count)) in self.sums.iter_mut().zip(&mut self.squares).zip(colours)
        {
            let mean = (0.2126 * r + 0.7152 * g + 0.0722 * b) / count.max(1) as f32;
            *sum += mean;
            *square += mean * mean;
        }
        self.blocks += 1;
    }

    /// The relative error of the tile; +∞ as long as too little is known, 0 where all is black.
    pub fn relative_error(&self) -> f64 {
        if self.blocks < LEAST_BLOCKS {
            return f64::INFINITY;
        }
        let n = f64::from(self.blocks);
        let (mut variance, mut mean) = (0.0, 0.0);
        for (&sum, &squares) in self.sums.iter().zip(&self.squares) {
            let (sum, squares) = (f64::from(sum), f64::from(squares));
            // Rounding can make equal numbers spread less than nothing.
            variance += ((squares - sum * sum / n) / (n * (n - 1.0))).max(0.0);
            mean += sum / n;
        }
        let pixels = self.sums.len() as f64;
        if variance == 0.0 { 0.0 } else { (variance / pixels).sqrt() / (mean / pixels).abs() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(blocks: &[f32]) -> Spread {
        let mut spread = Spread::new(1);
        for &value in blocks {
            let sums = Sums::from_planes(&[2.0 * value; 3], &[2.0], vec![2]);
            spread.add(&sums.expect("one pixel, three channels"));
        }
        spread
    }

    #[test]
    fn the_error_is_that_of_a_mean() {
        // Variance 5/3 of 1, 2, 3, 4; of their mean, 5/12; relative to 2.5.
        let error = spread(&[1.0, 2.0, 3.0, 4.0]).relative_error();
        assert!((error - (5.0f64 / 12.0).sqrt() / 2.5).abs() < 1e-7, "{error}");
    }

    #[test]
    fn little_is_unknown_and_black_is_known() {
        assert_eq!(spread(&[1.0; 3]).relative_error(), f64::INFINITY);
        assert_eq!(spread(&[0.0; 4]).relative_error(), 0.0);
        assert_eq!(spread(&[0.5; 9]).relative_error(), 0.0);
    }

    #[test]
    fn twice_the_light_is_the_same_error() {
        let (one, two) = (spread(&[1.0, 2.0, 4.0, 8.0]), spread(&[2.0, 4.0, 8.0, 16.0]));
        assert!((one.relative_error() - two.relative_error()).abs() < 1e-6);
    }
}
