//! Spherical harmonics up to order 2, real, orthonormal, without the alternating sign of physics.
//!
//! ```text
//! (l, m)  (0, 0)   (1, −1) (1, 0) (1, 1)   (2, −2) (2, −1) (2, 0)     (2, 1) (2, 2)
//! Y       0.2821   0.4886 · (y, z, x)      1.0925 · (xy, yz, ·, zx, ·)
//!                                          0.3154 (3z² − 1) at (2, 0), 0.5463 (x² − y²) at (2, 2)
//! ```

use std::f64::consts::PI;

use crate::simd::{Real, Vector3};

/// Values of the nine functions at a unit vector, by l, then m \[RH01\].
#[inline]
pub fn sh_basis<R: Real>(d: Vector3<R>) -> [R; 9] {
    let of = |factor: f32, value: R| R::splat(factor) * value;
    [
        R::splat(0.282_094_8),
        of(0.488_602_52, d.y),
        of(0.488_602_52, d.z),
        of(0.488_602_52, d.x),
        of(1.092_548_5, d.x * d.y),
        of(1.092_548_5, d.y * d.z),
        of(0.315_391_57, R::splat(3.0) * d.z * d.z - R::one()),
        of(1.092_548_5, d.z * d.x),
        of(0.546_274_24, d.x * d.x - d.y * d.y),
    ]
}

/// Â_l: what a hemisphere's cosine makes of radiance of order l, so that irradiance is
/// E(n) = Σ Â_l L_lm Y_lm(n) \[RH01\] (equation 8). π, 2π/3, π/4, 0, −π/24, …
pub fn sh_cosine(l: u32) -> f64 {
    match l {
        1 => 2.0 * PI / 3.0,
        odd if odd % 2 == 1 => 0.0,
        even => {
            let sign = if even % 4 == 0 { -1.0 } else { 1.0 };
            // l!/(2ˡ (l/2)!²), factor by factor.
            let ratio: f64 = (1..=even / 2).map(|k| f64::from(2 * k - 1) / f64::from(2 * k)).product();
            sign * 2.0 * PI / (f64::from(even) + 2.0) / (f64::from(even) - 1.0) * ratio
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// ∫ f dω by midpoints in cos θ and φ.
    fn sphere(f: impl Fn(Vec3) -> f64) -> f64 {
        let (rows, columns) = (2000, 32);
        let mut sum = 0.0;
        for i in 0..rows {
            let z = (f64::from(i) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            for j in 0..columns {
                let (sin, cos) = ((f64::from(j) + 0.5) / f64::from(columns) * 2.0 * PI).sin_cos();
                let r = (1.0 - z * z).sqrt();
                sum += f(Vec3::new((r * cos) as f32, (r * sin) as f32, z as f32));
            }
        }
        sum * 4.0 * PI / f64::from(rows * columns)
    }

    #[test]
    fn the_functions_are_orthonormal() {
        for i in 0..9 {
            for j in 0..9 {
                let product = sphere(|d| {
                    let y = sh_basis::<f32>(d.into());
                    f64::from(y[i]) * f64::from(y[j])
                });
                let want = if i == j { 1.0 } else { 0.0 };
                assert!((product - want).abs() < 2e-5, "{i} {j}: {product}");
            }
        }
    }

    #[test]
    fn cosines_have_their_closed_forms() {
        let want = [PI, 2.0 * PI / 3.0, PI / 4.0, 0.0, -PI / 24.0];
        for (l, want) in want.into_iter().enumerate() {
            assert!((sh_cosine(l as u32) - want).abs() < 1e-14, "{l}: {}", sh_cosine(l as u32));
        }
    }

    /// The hemisphere's cosine itself, projected: A_l = ∫ max(z, 0) Y_l0 dω, Â_l = √(4π/(2l + 1)) A_l.
    #[test]
    fn cosines_are_projections() {
        for (l, index) in [(0, 0), (1, 2), (2, 6)] {
            let a = sphere(|d| f64::from(d.z.max(0.0)) * f64::from(sh_basis::<f32>(d.into())[index]));
            let hat = (4.0 * PI / f64::from(2 * l + 1)).sqrt() * a;
            assert!((hat - sh_cosine(l)).abs() < 2e-5, "{l}: {hat}");
        }
    }
}
