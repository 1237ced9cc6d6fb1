//! Light from a picture wrapped around the scene.
//!
//! The poles are on ±y of the light's own space, row 0 at +y: row j of H is at the angle θ = πj/(H − 1)
//! from it, so the first and the last row are the poles. Column i of W has its centre at
//! φ = 2π(i + ½)/W, and columns wrap; φ = atan2(x, −z). Radiance is bilinear in φ and θ.
//!
//! Directions are drawn with a density that is bilinear over the same cells, each between four texels,
//! but in φ and **cos θ**, in which solid angle is uniform:
//! ```text
//! p(ω) = m(φ, cos θ)/∫m dω,   m = the mean of the bands at the four texels, bilinear,
//! ```
//! and that is exactly the density of what `sample` draws: a row by its running sum, a column by its own,
//! and the place within the cell by inverting the two linear densities \[PJH23\] (section 12.5). Wherever
//! there is light, p is above 0, at the poles too.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::distribution::{find, linear, push_sums};
use crate::math::{Frame, INV_TWO_PI, atan2, sin_cos_turns};
use crate::simd::{Bits, MOST, Real, Vector3, vector3};

mod integral;
#[cfg(test)]
mod tests;

pub use integral::{ShCoefficients, sh_irradiance};

/// An environment map, ready to be looked up and sampled.
#[derive(Clone, Debug)]
pub struct Envmap {
    /// Row-major; at least two rows.
    texels: Vec<[f32; 3]>,
    width: usize,
    height: usize,
    /// World images of the axes: orthonormal.
    axes: [Vec3; 3],
    /// 1 − cos θ of each row, without cancellation; also 1 + cos θ, from the other end.
    caps: Vec<f32>,
    /// Running sums over rows of cells.
    rows: Vec<f32>,
    /// Running sums over the cells of each row: width + 1 a row.
    columns: Vec<f32>,
    /// 1/∫m dω; 0 where there is no light.
    density: f32,
    flux: Vec3,
}

/// What the bilinear functions need of a direction.
struct Place<R> {
    /// The texels about it: rows above and below, columns left and right.
    corners: [[Vector3<R>; 2]; 2],
    /// From the left column to the right one.
    x: R,
    /// From the upper row to the lower one, in θ.
    theta: R,
    /// The same, in cos θ.
    cap: R,
}

impl Envmap {
    /// A map of W/(m² sr), row-major, neither negative nor beyond 32 bits; `axes` are the world images of
    /// the light's own, orthonormal and of either hand. A single row is repeated.
    pub fn new(mut texels: Vec<[f32; 3]>, width: u32, axes: [Vec3; 3]) -> Self {
        let width = width as usize;
        if texels.len() == width {
            texels.extend_from_within(..);
        }
        let height = texels.len() / width;
        let cap = |j: usize| {
            let (sin, _) = sin_cos_turns(j as f32 / (4 * (height - 1)) as f32);
            2.0 * sin * sin
        };
        let mut map = Self {
            caps: (0..height).map(cap).collect(),
            texels,
            width,
            height,
            axes,
            rows: Vec::new(),
            columns: Vec::new(),
            density: 0.0,
            flux: Vec3::ZERO,
        };
        map.weigh();
        map
    }

    /// Running sums and integrals over the cells.
    fn weigh(&mut self) {
        let (mut columns, mut rows) = (Vec::with_capacity((self.height - 1) * (self.width + 1)), Vec::new());
        let mut flux = DVec3::ZERO;
        for j in 0..self.height - 1 {
            let texel = |i: usize, j: usize| Vec3::from(self.texels[j * self.width + i]).as_dvec3();
            let pair = |i: usize| texel(i, j) + texel(i, j + 1);
            let mean = |i: usize| 0.25 * (pair(i) + pair((i + 1) % self.width));
            let cells: Vec<DVec3> = (0..self.width).map(mean).collect();
            let weights: Vec<f64> = cells.iter().map(|cell| cell.element_sum() / 3.0).collect();
            let (high, low) = self.edges(j);
            let solid_angle = std::f64::consts::TAU / self.width as f64 * f64::from(low - high).abs();
            rows.push(push_sums(&weights, &mut columns) * solid_angle);
            flux += cells.into_iter().sum::<DVec3>() * solid_angle;
        }
        let total = push_sums(&rows, &mut self.rows);
        self.columns = columns;
        self.density = if total > 0.0 { (1.0 / total) as f32 } else { 0.0 };
        self.flux = flux.as_vec3();
    }

    /// ∫L dω over the sphere, W/m²: what a small ball's cross-section receives from all around.
    pub fn flux(&self) -> Vec3 {
        self.flux
    }

    /// Rows of cells from here on are measured from the lower pole.
    fn lower(&self) -> usize {
        self.height / 2
    }

    /// 1 ∓ cos θ at the upper and the lower edge of a row of cells, from the pole on its side.
    #[inline]
    fn edges(&self, j: usize) -> (f32, f32) {
        let last = self.height - 1;
        let at = |row: usize| self.caps[if j < self.lower() { row } else { last - row }];
        (at(j), at(j + 1))
    }

    #[inline]
    fn edges_of<R: Real>(&self, row: R::Bits) -> (R, R) {
        let edges: [(f32, f32); MOST] =
            std::array::from_fn(|i| if i < R::LANES { self.edges(row.lane(i) as usize) } else { (0.0, 0.0) });
        (R::from_fn(|i| edges[i].0), R::from_fn(|i| edges[i].1))
    }

    #[inline]
    fn corners<R: Real>(&self, row: R::Bits, column: R::Bits) -> [[Vector3<R>; 2]; 2] {
        let texel = |lane: usize, down: usize, right: usize| {
            let column = (column.lane(lane) as usize + right) % self.width;
            Vec3::from(self.texels[(row.lane(lane) as usize + down) * self.width + column])
        };
        [0, 1].map(|down| [0, 1].map(|right| Vector3::from_fn(|lane| texel(lane, down, right))))
    }

    /// Where a direction of the light's own space falls.
    #[inline]
    fn place<R: Real>(&self, dir: Vector3<R>) -> Place<R> {
        let sin2 = dir.x * dir.x + dir.z * dir.z;
        let cells = (self.height - 1) as f32;
        let down = atan2(sin2.sqrt(), dir.y) * R::splat(cells / PI);
        let row = down.floor().clamp(0.0, cells - 1.0);
        let around = atan2(dir.x, -dir.z) * R::splat(INV_TWO_PI);
        let around = R::select(around.lt(R::zero()), around + R::one(), around);
        // From the last column's centre on, a turn back, so that no cell is cut.
        let right = around * R::splat(self.width as f32) - R::splat(0.5);
        let right = R::select(right.lt(R::zero()), right + R::splat(self.width as f32), right);
        let column = right.floor().clamp(0.0, self.width as f32 - 1.0);

        let (row_bits, column_bits) = (row.to_int(), column.to_int());
        let is_upper = row.lt(R::splat(self.lower() as f32));
        let pole = R::select(is_upper, dir.y, -dir.y);
        let cap = R::select(pole.gt(R::zero()), sin2 / (R::one() + pole), R::one() - pole);
        let (high, low) = self.edges_of::<R>(row_bits);
        Place {
            corners: self.corners(row_bits, column_bits),
            x: (right - column).clamp(0.0, 1.0),
            theta: (down - row).clamp(0.0, 1.0),
            cap: ((cap - high) / (low - high)).clamp(0.0, 1.0),
        }
    }

    #[inline]
    fn frame<R: Real>(&self) -> Frame<R> {
        let [s, t, n] = self.axes.map(Vector3::splat);
        Frame { s, t, n }
    }

    /// Radiance from a world direction of unit length, and the density per solid angle with which
    /// [`sample`](Self::sample) draws it.
    #[inline]
    pub fn arriving<R: Real>(&self, from: Vector3<R>) -> (Vector3<R>, R) {
        let place = self.place(self.frame().to_local(from));
        let across = |row: &[Vector3<R>; 2]| row[0] + (row[1] - row[0]).scale(place.x);
        let [above, below] = [across(&place.corners[0]), across(&place.corners[1])];
        let radiance = above.scale(R::one() - place.theta) + below.scale(place.theta);
        let weight = band_sum(above) * (R::one() - place.cap) + band_sum(below) * place.cap;
        (radiance, weight * R::splat(self.density / 3.0))
    }

    /// A world direction.
    #[inline]
    pub fn sample<R: Real>(&self, (u, v): (R, R)) -> Vector3<R> {
        let (row, v) = find(&self.rows, R::Bits::splat(0), self.height - 1, v);
        let first = row.wrapping_mul(R::Bits::splat(self.width as u32 + 1));
        let (place, u) = find(&self.columns, first, self.width, u);
        let column = R::Bits::from_fn(|i| place.lane(i) - first.lane(i));
        let corners = self.corners::<R>(row, column).map(|row| row.map(band_sum));

        let [[a, b], [c, d]] = corners;
        let cap = linear(v, a + b, c + d);
        let mix = |upper: R, lower: R| upper * (R::one() - cap) + lower * cap;
        let x = linear(u, mix(a, c), mix(b, d));

        let (high, low) = self.edges_of::<R>(row);
        let cap = high + (low - high) * cap;
        let (sin, cos) = ((cap * (R::splat(2.0) - cap)).max(R::zero()).sqrt(), R::one() - cap);
        let is_upper = R::from_int(row).lt(R::splat(self.lower() as f32));
        let turns = (R::from_int(column) + R::splat(0.5) + x) * R::splat(1.0 / self.width as f32);
        let (sin_phi, cos_phi) = sin_cos_turns(turns);
        self.frame().to_world(vector3(sin * sin_phi, R::select(is_upper, cos, -cos), -sin * cos_phi))
    }
}

#[inline]
fn band_sum<R: Real>(v: Vector3<R>) -> R {
    v.x + v.y + v.z
}
