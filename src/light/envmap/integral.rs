//! Integrals over an environment map, in double precision.
//!
//! Each cell between four texels is summed by Gauss's rule of 2 × 2 points in φ and θ, of the same
//! bilinear radiance that is rendered with.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::Envmap;
use crate::math::{sh_basis, sh_cosine};

/// A coefficient for each band, by l, then m.
pub type ShCoefficients = [DVec3; 9];

/// Gauss's two points in [0, 1]: ½ ∓ 1/√12.
const POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl Envmap {
    /// Rows of cells, for [`for_each_in_row`](Self::for_each_in_row).
    pub fn cell_rows(&self) -> usize {
        self.height - 1
    }

    /// Calls `f` with directions of the light's own space and the radiance from there times its solid
    /// angle, which add up to the integral over a row of cells.
    pub fn for_each_in_row(&self, row: usize, mut f: impl FnMut(DVec3, DVec3)) {
        let texel = |i: usize, j: usize| Vec3::from(self.texels[j * self.width + i % self.width]).as_dvec3();
        let (step, turn) = (PI / self.cell_rows() as f64, TAU / self.width as f64);
        for down in POINTS {
            let theta = (row as f64 + down) * step;
            let (sin, cos) = (libm::sin(theta), libm::cos(theta));
            let column = |i: usize| texel(i, row).lerp(texel(i, row + 1), down);
            for i in 0..self.width {
                let (left, right) = (column(i), column(i + 1));
                for across in POINTS {
                    let phi = (i as f64 + 0.5 + across) * turn;
                    let dir = DVec3::new(sin * libm::sin(phi), cos, -sin * libm::cos(phi));
                    f(dir, left.lerp(right, across) * (0.25 * step * turn * sin));
                }
            }
        }
    }

    /// L_lm = ∫ L Y_lm dω of a row of cells \[RH01\].
    pub fn project_row(&self, row: usize) -> ShCoefficients {
        let mut sums = [DVec3::ZERO; 9];
        self.for_each_in_row(row, |dir, flux| {
            let basis = sh_basis::<f32>(dir.as_vec3().into());
            for (sum, y) in sums.iter_mut().zip(basis) {
                *sum += f64::from(y) * flux;
            }
        });
        sums
    }

    /// E(n) = ∫ L max(n·ω, 0) dω of a row of cells, for each of some normals, W/m².
    pub fn irradiance_row(&self, row: usize, normals: &[DVec3]) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; normals.len()];
        self.for_each_in_row(row, |dir, flux| {
            for (sum, n) in sums.iter_mut().zip(normals) {
                *sum += n.dot(dir).max(0.0) * flux;
            }
        });
        sums
    }
}

/// E(n) = Σ Â_l L_lm Y_lm(n), W/m² \[RH01\].
pub fn sh_irradiance(coefficients: &ShCoefficients, n: DVec3) -> DVec3 {
    let basis = sh_basis::<f32>(n.as_vec3().into());
    let order = [0, 1, 1, 1, 2, 2, 2, 2, 2];
    (0..9).map(|i| sh_cosine(order[i]) * f64::from(basis[i]) * coefficients[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: usize, height: usize, radiance: impl Fn(f64, f64) -> f64) -> Envmap {
        let texel = |i: usize| {
            let theta = PI * (i / width) as f64 / (height - 1) as f64;
            [radiance(theta, ((i % width) as f64 + 0.5) / width as f64 * TAU) as f32; 3]
        };
        Envmap::new((0..width * height).map(texel).collect(), width as u32, [Vec3::X, Vec3::Y, Vec3::Z])
    }

    fn projected(map: &Envmap) -> ShCoefficients {
        let rows = (0..map.cell_rows()).map(|row| map.project_row(row));
        rows.fold([DVec3::ZERO; 9], |sum, row| std::array::from_fn(|i| sum[i] + row[i]))
    }

    fn irradiance(map: &Envmap, n: DVec3) -> f64 {
        (0..map.cell_rows()).map(|row| map.irradiance_row(row, &[n])[0].x).sum()
    }

    #[test]
    fn a_sky_of_one_has_one_coefficient_and_irradiance_pi() {
        let sky = map(64, 33, |_, _| 1.0);
        let coefficients = projected(&sky);
        assert!((coefficients[0].x - (4.0 * PI).sqrt()).abs() < 1e-5, "{}", coefficients[0].x);
        assert!(coefficients[1..].iter().all(|c| c.length() < 1e-5));
        for n in [DVec3::Y, DVec3::new(0.6, 0.0, -0.8)] {
            assert!((sh_irradiance(&coefficients, n).x - PI).abs() < 1e-5);
            // The cosine has a kink within cells.
            assert!((irradiance(&sky, n) - PI).abs() < 2e-3, "{}", irradiance(&sky, n));
        }
    }

    /// An order-2 sky has its irradiance in nine coefficients, all of it.
    #[test]
    fn what_varies_slowly_is_exact() {
        let sky = map(256, 129, |theta, phi| {
            let d = Vec3::new(
                (theta.sin() * phi.sin()) as f32,
                theta.cos() as f32,
                (-theta.sin() * phi.cos()) as f32,
            );
            let y = sh_basis::<f32>(d.into());
            f64::from(4.0 + 0.7 * y[1] - 1.1 * y[3] + 0.9 * y[5] + y[6] - 0.4 * y[8])
        });
        let coefficients = projected(&sky);
        for (i, want) in [(1, 0.7), (3, -1.1), (5, 0.9), (6, 1.0), (8, -0.4), (2, 0.0), (4, 0.0), (7, 0.0)] {
            assert!((coefficients[i].x - want).abs() < 2e-3, "{i}: {}", coefficients[i].x);
        }
        for n in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.48, 0.6, -0.64)] {
            let (nine, brute) = (sh_irradiance(&coefficients, n).x, irradiance(&sky, n));
            assert!((nine / brute - 1.0).abs() < 1e-4, "{nine} {brute}");
        }
    }

    /// Half a sky has nothing of the even orders but 0, and Â_l is 0 for the odd ones from 3 on.
    #[test]
    fn half_a_sky_has_the_irradiance_of_its_height() {
        let sky = map(512, 257, |theta, _| {
            if theta < PI / 2.0 {
                1.0
            } else if theta > PI / 2.0 {
                0.0
            } else {
                0.5
            }
        });
        let coefficients = projected(&sky);
        for n in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(0.6, 0.8, 0.0)] {
            let want = PI * (1.0 + n.y) / 2.0;
            assert!((irradiance(&sky, n) - want).abs() < 2e-3 * PI);
            assert!((sh_irradiance(&coefficients, n).x - want).abs() < 1e-3 * PI, "{n}");
        }
    }
}
