//! Integrals over directions.

use glam::DVec3;

use crate::simd::{Real, Vector3};

/// ∫ f dω over cos θ and φ in these ranges, on one side of the horizon: in s = √(1 − |cos θ|), which
/// spreads out what happens about the pole, by Gauss's rule of two points; in φ by midpoints. `steps` is
/// the number of points along each, even and a multiple of the lanes.
pub fn integrate<R: Real, const N: usize>(
    cos: (f64, f64),
    phi: (f64, f64),
    steps: usize,
    f: impl Fn(Vector3<R>) -> [R; N],
) -> [f64; N] {
    let from_pole = |cos: f64| (1.0 - cos.abs()).sqrt();
    let (first, last) = (from_pole(cos.0), from_pole(cos.1));
    let side = if cos.0 < 0.0 { -1.0 } else { 1.0 };
    let (width, turn) = ((last - first) / (steps / 2) as f64, (phi.1 - phi.0) / steps as f64);
    let azimuths: Vec<(f64, f64)> = (0..steps).map(|j| (phi.0 + turn * (j as f64 + 0.5)).sin_cos()).collect();
    let mut sum = [0.0; N];
    for i in 0..steps {
        let in_cell = 0.5 + ((i % 2) as f64 - 0.5) / 3.0f64.sqrt();
        let s = first + width * ((i / 2) as f64 + in_cell);
        let cos = side * (1.0 - s * s);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let mut row = [0.0; N];
        for lanes in azimuths.chunks_exact(R::LANES) {
            let value = f(Vector3::from_fn(|k| {
                let (y, x) = lanes[k];
                DVec3::new(sin * x, sin * y, cos).as_vec3()
            }));
            for (sum, value) in row.iter_mut().zip(value) {
                *sum += (0..R::LANES).map(|k| f64::from(value.lane(k))).sum::<f64>();
            }
        }
        for (sum, row) in sum.iter_mut().zip(row) {
            *sum += s * row;
        }
    }
    // dω = 2 s ds dφ, and a row stands for half of its cell.
    sum.map(|sum| sum * width.abs() * turn)
}
