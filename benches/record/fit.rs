//! Does something grow like log N?

/// Nodes against the size of the mesh, as a + b log₂ N by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) a: f64,
    pub(crate) b: f64,
    /// Share of the variance that the line explains.
    pub(crate) r2: f64,
    /// Slope of the last step in mean slopes: 1 for a straight line, 1.75 for N^0.2 and 2.25 for N^(1/3) over
    /// four tenfold steps.
    pub(crate) last_step: f64,
    /// The p of N^p in the last step: 1/ln N for log N itself, which is 0.067 from one million to ten.
    pub(crate) exponent: f64,
}

/// The greatest [`Fit::last_step`] that still passes for a straight line.
const STRAIGHT: f64 = 1.5;
/// The least [`Fit::exponent`] of a power, where the line is not straight.
const POWER: f64 = 0.125;

/// What grows so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Growth {
    /// A straight line over log N.
    Logarithm,
    /// A line that bends upwards, but no power of N: meshes of one kind that are not the same surface at every
    /// size, as a sphereflake that gains balls, have such.
    Bent,
    /// A power of N.
    Power,
}

impl Fit {
    /// Of points (N, nodes) in ascending order; fewer than four say nothing.
    pub(crate) fn of(points: &[(f64, f64)]) -> Option<Self> {
        let &[first, _, .., before, last] = points else {
            return None;
        };
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|p| p.0.log2()), mean(&|p| p.1));
        let covariance = mean(&|p| (p.0.log2() - x) * (p.1 - y));
        let (of_x, of_y) = (mean(&|p| (p.0.log2() - x).powi(2)), mean(&|p| (p.1 - y).powi(2)));
        let slope = |from: (f64, f64), to: (f64, f64)| (to.1 - from.1) / (to.0 / from.0).log2();
        let b = covariance / of_x;
        Some(Self {
            a: y - b * x,
            b,
            r2: covariance * covariance / (of_x * of_y),
            last_step: slope(before, last) / slope(first, last),
            exponent: (last.1 / before.1).ln() / (last.0 / before.0).ln(),
        })
    }

    /// What the last step says.
    pub(crate) fn growth(&self) -> Growth {
        if self.last_step <= STRAIGHT {
            Growth::Logarithm
        } else if self.exponent < POWER {
            Growth::Bent
        } else {
            Growth::Power
        }
    }
}
