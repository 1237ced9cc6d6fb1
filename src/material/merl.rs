//! Measured reflection: a table over half and difference angles \[MPB03\].
//!
//! With the half vector h = (θ_h, φ_h) of wi and wo, and wi = (θ_d, φ_d) in the frame where h is the pole
//! \[Rus98\], an isotropic material depends on (θ_h, θ_d, φ_d) only, and a reciprocal one on φ_d modulo π.
//! Cells of θ_h are wider away from the highlight: θ_h = (i/n)² π/2. Between the centres of cells the table
//! is linear.
//!
//! Half of the samples are by the cosine, the other half by half vectors as bright as the table is on
//! average at their angle.

pub(crate) mod file;
mod lobe;

use std::{
    f32::consts::{FRAC_PI_2, PI},
    fmt,
};

use glam::Vec3;

use super::{Sample, lambert::above, rough_conductor::reflect};
use crate::math::{Digest, acos, atan2, sin_cos_turns, warp};
use crate::simd::{Bits, MOST, Real, Vector3, vector3};
pub use file::MerlError;
use lobe::Lobe;

/// Cells of θ_h, θ_d and φ_d.
pub const MERL_CELLS: [usize; 3] = [90, 90, 180];

/// A table of f, linear sRGB, per steradian.
#[derive(Clone, PartialEq)]
pub struct MerlTable {
    /// θ_h-major, then θ_d, then φ_d.
    values: Vec<[f32; 3]>,
    lobe: Lobe,
}

/// A digest of the million values.
impl fmt::Debug for MerlTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digest = Digest::default().floats(self.values.iter().flatten().copied());
        f.debug_struct("MerlTable").field("digest", &digest.value()).finish()
    }
}

impl MerlTable {
    /// A table of these values; negative ones, by which files mark what was not measured, are black.
    fn new(mut values: Vec<[f32; 3]>) -> Self {
        values.iter_mut().flatten().for_each(|value| *value = value.max(0.0));
        let lobe = Lobe::new(&values);
        Self { values, lobe }
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.values.as_slice()) as u64
    }

    /// The table of an isotropic, reciprocal f(wo, wi): its values at the centres of the cells.
    pub fn tabulate(f: impl Fn(Vec3, Vec3) -> Vec3) -> Self {
        let [_, d_cells, phi_cells] = MERL_CELLS;
        let value = |cell: usize| {
            let centre = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
            let theta_d = centre(cell / phi_cells % d_cells, d_cells) * FRAC_PI_2;
            let phi_d = centre(cell % phi_cells, phi_cells) * PI;
            let theta_h = theta_h((cell / phi_cells / d_cells) as f32 + 0.5);
            let (wo, wi) = directions(theta_h, theta_d, phi_d);
            if wo.z > 0.0 && wi.z > 0.0 { f(wo, wi).to_array() } else { [0.0; 3] }
        };
        Self::new((0..MERL_CELLS.iter().product()).map(value).collect())
    }

    /// f, linear between the centres of cells.
    #[inline]
    fn fetch<R: Real>(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let half = R::splat(0.5);
        let h = (wo + wi).normalize();
        let (theta_h, theta_d, phi_d) = angles(h, wi);
        let [h_cells, d_cells, phi_cells] = MERL_CELLS;
        let place = |x: R, cells: usize| {
            let x = (x * R::splat(cells as f32) - half).clamp(0.0, cells as f32 - 1.0);
            let low = x.floor().min(R::splat(cells as f32 - 2.0));
            (low.to_int(), x - low)
        };
        let (h_cell, h_part) = place((theta_h / R::splat(FRAC_PI_2)).sqrt(), h_cells);
        let (d_cell, d_part) = place(theta_d / R::splat(FRAC_PI_2), d_cells);
        // φ goes round: half a cell before the first is the last.
        let turn = phi_d / R::splat(PI) * R::splat(phi_cells as f32) + R::splat(phi_cells as f32 - 0.5);
        let low = turn.floor();
        let (phi_cell, phi_part) = (low.to_int(), turn - low);
        let mut lanes = [[0.0f32; 3]; MOST];
        for (i, lane) in lanes[..R::LANES].iter_mut().enumerate() {
            let (h, d) = (h_cell.lane(i) as usize, d_cell.lane(i) as usize);
            let phi = phi_cell.lane(i) as usize;
            let parts = [h_part.lane(i), d_part.lane(i), phi_part.lane(i)];
            *lane = self.trilinear([h.min(h_cells - 2), d.min(d_cells - 2), phi], parts);
        }
        let plane = |c: usize| R::from_fn(|i| lanes[i][c]);
        vector3(plane(0), plane(1), plane(2))
    }

    fn trilinear(&self, [h, d, phi]: [usize; 3], [h_part, d_part, phi_part]: [f32; 3]) -> [f32; 3] {
        let [_, d_cells, phi_cells] = MERL_CELLS;
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let (a, b, c) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let weight = |far: usize, part: f32| if far == 1 { part } else { 1.0 - part };
            let w = weight(a, h_part) * weight(b, d_part) * weight(c, phi_part);
            let cell = self.values[((h + a) * d_cells + d + b) * phi_cells + (phi + c) % phi_cells];
            for (sum, value) in sum.iter_mut().zip(cell) {
                *sum += w * value;
            }
        }
        sum
    }
}

/// A measured material, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'t> {
    /// The measurements.
    pub table: &'t MerlTable,
}

impl Measured<'_> {
    /// f cos θ_i.
    #[inline]
    pub fn eval<R: Real>(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        self.table.fetch(wo, wi).scale(wi.z).only(above(wo, wi))
    }

    /// Half the half vectors' density over 4 wo·h, half cos θ_i/π.
    #[inline]
    pub fn pdf<R: Real>(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let h = (wo + wi).normalize();
        let cell = (acos(h.z) / R::splat(FRAC_PI_2)).sqrt() * R::splat(MERL_CELLS[0] as f32);
        let bright = self.table.lobe.density(cell) / (R::splat(4.0) * wo.dot(h));
        let half = R::splat(0.5);
        (half * bright + half * warp::cosine_hemisphere_pdf(wi.z)).only(above(wo, wi))
    }

    /// A direction by the cosine or by the table.
    #[inline]
    pub fn sample<R: Real>(&self, wo: Vector3<R>, lobe: R, (u, v): (R, R)) -> Sample<R> {
        let below = self.table.lobe.below_pole(u);
        let sin = (below * (R::splat(2.0) - below)).max(R::zero()).sqrt();
        let (s, c) = sin_cos_turns(v);
        let h = vector3(sin * c, sin * s, R::one() - below);
        let bright = lobe.lt(R::splat(0.5));
        let wi = Vector3::select(bright, reflect(wo, h), warp::cosine_hemisphere(u, v));
        let faces = wo.dot(h).gt(R::zero()) | !bright;
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), faces)
    }
}

/// θ_h of a place among its cells.
fn theta_h(cell: f32) -> f32 {
    let part = cell / MERL_CELLS[0] as f32;
    part * part * FRAC_PI_2
}

/// (θ_h, θ_d, φ_d), φ_d in [0, π].
#[inline]
fn angles<R: Real>(h: Vector3<R>, wi: Vector3<R>) -> (R, R, R) {
    let rim = (h.x * h.x + h.y * h.y).sqrt();
    let usable = rim.gt(R::zero());
    let scale = R::one() / R::select(usable, rim, R::one());
    let across = vector3(-(h.y * scale).only(usable), R::select(usable, h.x * scale, R::one()), R::zero());
    let along = across.cross(h);
    let phi = atan2(wi.dot(across), wi.dot(along));
    let phi = R::select(phi.lt(R::zero()), phi + R::splat(PI), phi);
    (acos(h.z), acos(wi.dot(h)), phi)
}

/// (wo, wi) of the angles, with φ_h = 0.
fn directions(theta_h: f32, theta_d: f32, phi_d: f32) -> (Vec3, Vec3) {
    let sin_cos = |angle: f32| sin_cos_turns(angle / std::f32::consts::TAU);
    let ((sin_h, cos_h), (sin_d, cos_d)) = (sin_cos(theta_h), sin_cos(theta_d));
    let (sin_phi, cos_phi) = sin_cos(phi_d);
    let d = Vec3::new(sin_d * cos_phi, sin_d * sin_phi, cos_d);
    let wi = Vec3::new(cos_h * d.x + sin_h * d.z, d.y, cos_h * d.z - sin_h * d.x);
    let h = Vec3::new(sin_h, 0.0, cos_h);
    (h * (2.0 * h.dot(wi)) - wi, wi)
}

#[cfg(test)]
mod tests;
