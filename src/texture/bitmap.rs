//! Pictures as textures.
//!
//! Texel (i, j) has its centre at ((i + ½)/w, (j + ½)/h), row 0 at v = 0. Texels are fetched lane by
//! lane; the interpolation is done in lanes.

use crate::simd::{MOST, Real, Vector3, vector3};

/// How the texels about a point are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The four nearest, linearly.
    Bilinear,
    /// The nearest.
    Nearest,
}

/// How a texture continues outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// Periodically.
    Repeat,
    /// Mirrored at each integer.
    Mirror,
    /// With its border texel.
    Clamp,
}

/// Linear sRGB texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// Row-major, `width` × `height`, neither zero.
    pub texels: Vec<[f32; 3]>,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// How texels are combined.
    pub filter: Filter,
    /// What lies outside.
    pub wrap: Wrap,
}

impl Bitmap {
    /// The colour at each lane's (u, v).
    #[inline]
    pub fn fetch<R: Real>(&self, (u, v): (R, R)) -> Vector3<R> {
        let (x, y) = (u * R::splat(self.width as f32), v * R::splat(self.height as f32));
        match self.filter {
            Filter::Nearest => self.gather(x.floor(), y.floor()),
            Filter::Bilinear => {
                let (x, y) = (x - R::splat(0.5), y - R::splat(0.5));
                let (left, top) = (x.floor(), y.floor());
                let (right, bottom) = (left + R::one(), top + R::one());
                let (fx, fy) = (x - left, y - top);
                let row = |y: R| self.gather(left, y).scale(R::one() - fx) + self.gather(right, y).scale(fx);
                row(top).scale(R::one() - fy) + row(bottom).scale(fy)
            }
        }
    }

    /// How fast the bilinear colour changes with u and with v.
    #[inline]
    pub fn gradient<R: Real>(&self, (u, v): (R, R)) -> [Vector3<R>; 2] {
        let (width, height) = (R::splat(self.width as f32), R::splat(self.height as f32));
        let (x, y) = (u * width - R::splat(0.5), v * height - R::splat(0.5));
        let (left, top) = (x.floor(), y.floor());
        let (right, bottom) = (left + R::one(), top + R::one());
        let (fx, fy) = (x - left, y - top);
        let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
        let [c00, c10, c01, c11] = corners.map(|(x, y)| self.gather(x, y));
        let along_x = (c10 - c00).scale(R::one() - fy) + (c11 - c01).scale(fy);
        let along_y = (c01 - c00).scale(R::one() - fx) + (c11 - c10).scale(fx);
        [along_x.scale(width), along_y.scale(height)]
    }

    #[inline]
    fn gather<R: Real>(&self, x: R, y: R) -> Vector3<R> {
        let mut lanes = [[0.0; 3]; MOST];
        for (i, lane) in lanes[..R::LANES].iter_mut().enumerate() {
            let (column, row) = (self.wrap(x.lane(i), self.width), self.wrap(y.lane(i), self.height));
            *lane = self.texels[row * self.width as usize + column];
        }
        let plane = |c: usize| R::from_fn(|i| lanes[i][c]);
        vector3(plane(0), plane(1), plane(2))
    }

    /// The index of a texel of the endless plane; texels out of reach of an `i32` are its ends.
    #[inline]
    fn wrap(&self, index: f32, size: u32) -> usize {
        let (index, size) = (i64::from(index as i32), i64::from(size));
        let wrapped = match self.wrap {
            Wrap::Repeat => index.rem_euclid(size),
            Wrap::Mirror => {
                let twice = index.rem_euclid(2 * size);
                if twice < size { twice } else { 2 * size - 1 - twice }
            }
            Wrap::Clamp => index.clamp(0, size - 1),
        };
        wrapped as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn ramp(filter: Filter, wrap: Wrap) -> Bitmap {
        let texels = (0..8).map(|i| [i as f32; 3]).collect();
        Bitmap { texels, width: 4, height: 2, filter, wrap }
    }

    fn at(bitmap: &Bitmap, u: f32, v: f32) -> f32 {
        let scalar = bitmap.fetch((u, v)).x;
        let lanes = bitmap.fetch((f32x8::splat(u), f32x8::splat(v)));
        assert_eq!(lanes.x.lane(6).to_bits(), scalar.to_bits());
        scalar
    }

    #[test]
    fn row_zero_is_at_v_zero_and_centres_are_exact() {
        for filter in [Filter::Bilinear, Filter::Nearest] {
            let bitmap = ramp(filter, Wrap::Repeat);
            assert_eq!(at(&bitmap, 0.125, 0.25), 0.0);
            assert_eq!(at(&bitmap, 0.875, 0.25), 3.0);
            assert_eq!(at(&bitmap, 0.125, 0.75), 4.0);
        }
        assert_eq!(at(&ramp(Filter::Bilinear, Wrap::Clamp), 0.25, 0.5), 2.5);
    }

    #[test]
    fn wrapping() {
        let nearest = |wrap, u| at(&ramp(Filter::Nearest, wrap), u, 0.1);
        assert_eq!([-0.1, 1.1, 2.6].map(|u| nearest(Wrap::Repeat, u)), [3.0, 0.0, 2.0]);
        assert_eq!([-0.1, 1.1, 2.6].map(|u| nearest(Wrap::Mirror, u)), [0.0, 3.0, 2.0]);
        assert_eq!([-0.1, 1.1, 2.6].map(|u| nearest(Wrap::Clamp, u)), [0.0, 3.0, 3.0]);
        for wild in [1e30, -1e30, f32::MAX] {
            at(&ramp(Filter::Bilinear, Wrap::Repeat), wild, 0.1);
        }
    }
}
