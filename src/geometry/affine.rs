//! Affine maps x ↦ M x + m, one for all lanes or one a lane.

use glam::{DAffine3, Vec3};

use crate::simd::{Real, Vector3, vector3};

/// M by its rows, and m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Rows of the linear part.
    pub rows: [Vec3; 3],
    /// The translation.
    pub offset: Vec3,
}

impl From<&DAffine3> for Affine {
    /// Rounded once.
    fn from(map: &DAffine3) -> Self {
        let m = map.matrix3;
        Self {
            rows: [m.row(0), m.row(1), m.row(2)].map(glam::DVec3::as_vec3),
            offset: map.translation.as_vec3(),
        }
    }
}

/// Maps in lanes.
#[derive(Clone, Copy, Debug)]
pub struct AffineLanes<R> {
    rows: [Vector3<R>; 3],
    offset: Vector3<R>,
}

impl<R: Real> AffineLanes<R> {
    /// The same map in every lane.
    #[inline]
    pub fn splat(map: &Affine) -> Self {
        Self { rows: map.rows.map(Vector3::splat), offset: Vector3::splat(map.offset) }
    }

    /// The map of each lane.
    #[inline]
    pub fn from_fn<'m>(map: impl Fn(usize) -> &'m Affine) -> Self {
        let row = |k: usize| Vector3::from_fn(|i| map(i).rows[k]);
        Self { rows: [row(0), row(1), row(2)], offset: Vector3::from_fn(|i| map(i).offset) }
    }

    /// M p + m.
    #[inline]
    pub fn point(&self, p: Vector3<R>) -> Vector3<R> {
        self.direction(p) + self.offset
    }

    /// M d.
    #[inline]
    pub fn direction(&self, d: Vector3<R>) -> Vector3<R> {
        let [x, y, z] = self.rows;
        vector3(x.dot(d), y.dot(d), z.dot(d))
    }

    /// Mᵀ n: what takes normals where the inverse of this map takes points.
    #[inline]
    pub fn normal_back(&self, n: Vector3<R>) -> Vector3<R> {
        let [x, y, z] = self.rows;
        x.scale(n.x) + y.scale(n.y) + z.scale(n.z)
    }

    /// |M| |d|: no image of a vector with these components, whatever their signs, is longer along an axis.
    #[inline]
    pub fn reach(&self, d: Vector3<R>) -> Vector3<R> {
        let ([x, y, z], d) = (self.rows.map(Vector3::abs), d.abs());
        vector3(x.dot(d), y.dot(d), z.dot(d))
    }

    /// |M| |p| + |m|: half an ulp of this is what rounding of M, of m and of each operation adds to the
    /// image of a point.
    #[inline]
    pub fn magnitude(&self, p: Vector3<R>) -> Vector3<R> {
        self.reach(p) + self.offset.abs()
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    #[test]
    fn normals_go_back_by_the_transpose_and_reach_has_no_signs() {
        // Integers: nothing is rounded.
        let m = DMat3::from_cols_array(&[1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0, 8.0, -9.0]);
        let map = DAffine3 { matrix3: m, translation: glam::DVec3::new(10.0, -20.0, 30.0) };
        let (map, v) = (AffineLanes::<f32>::splat(&Affine::from(&map)), Vec3::new(2.0, -3.0, 5.0));
        assert_eq!(Vec3::from(map.direction(v.into())), (m * v.as_dvec3()).as_vec3());
        assert_eq!(Vec3::from(map.point(v.into())), Vec3::new(59.0, 1.0, 9.0));
        assert_eq!(Vec3::from(map.normal_back(v.into())), (m.transpose() * v.as_dvec3()).as_vec3());
        let reach = Vec3::new(2.0 + 12.0 + 35.0, 4.0 + 15.0 + 40.0, 6.0 + 18.0 + 45.0);
        assert_eq!(Vec3::from(map.reach(v.into())), reach);
        assert_eq!(Vec3::from(map.magnitude(v.into())), reach + Vec3::new(10.0, 20.0, 30.0));
    }
}
