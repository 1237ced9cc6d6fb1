//! Planes of numbers, and what a neighbourhood makes of them.

/// Numbers over pixels, row by row.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// Columns by one kernel and rows by the other, about each pixel. Both are of odd length; beyond its
    /// border the picture goes on as it is there.
    pub(super) fn convolved(&self, columns: &[f32], rows: &[f32]) -> Self {
        self.along(columns, 1).along(rows, self.width)
    }

    /// Along a row or a column: neighbours are `step` apart in memory.
    fn along(&self, kernel: &[f32], step: usize) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width.max(1));
        let radius = kernel.len() / 2;
        let value = |i: usize| {
            let (place, length) = if step == 1 { (i % width, width) } else { (i / width, height) };
            let first = i - place * step;
            let tap = |(k, &weight): (usize, &f32)| {
                let at = (place + k).saturating_sub(radius).min(length - 1);
                weight * self.values[first + at * step]
            };
            kernel.iter().enumerate().map(tap).sum()
        };
        Self { width, values: (0..self.values.len()).map(value).collect() }
    }

    /// Of two planes, number by number.
    pub(super) fn combined(&self, other: &Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let pairs = self.values.iter().zip(&other.values);
        Self { width: self.width, values: pairs.map(|(&a, &b)| f(a, b)).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_weighed_and_borders_repeated() {
        let plane = Plane { width: 3, values: vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0] };
        let blurred = plane.convolved(&[1.0, 0.0, 0.0], &[1.0]);
        assert_eq!(blurred.values, [1.0, 1.0, 2.0, 8.0, 8.0, 16.0]);
        let blurred = plane.convolved(&[1.0], &[0.0, 0.5, 0.5]);
        assert_eq!(blurred.values, [4.5, 9.0, 18.0, 8.0, 16.0, 32.0]);
    }
}
