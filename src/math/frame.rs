//! Orthonormal frames.

use crate::simd::{Real, Vector3, vector3};

/// A right-handed orthonormal basis (s, t, n).
#[derive(Clone, Copy, Debug)]
pub struct Frame<R> {
    /// First tangent.
    pub s: Vector3<R>,
    /// Second tangent.
    pub t: Vector3<R>,
    /// Normal.
    pub n: Vector3<R>,
}

impl<R: Real> Frame<R> {
    /// A frame about a unit vector, without branches and without a singularity \[DBC17\].
    #[inline]
    pub fn around(n: Vector3<R>) -> Self {
        let sign = R::select(n.z.lt(R::zero()), -R::one(), R::one());
        let a = -R::one() / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: vector3(R::one() + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: vector3(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Components of a world vector in the frame.
    #[inline]
    pub fn to_local(&self, v: Vector3<R>) -> Vector3<R> {
        vector3(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// The world vector with these components.
    #[inline]
    pub fn to_world(&self, v: Vector3<R>) -> Vector3<R> {
        self.s.scale(v.x) + self.t.scale(v.y) + self.n.scale(v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for (x, y, z) in
            [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, -0.0), (0.3, -0.8, -0.4), (0.0, 1.0, 1e-9)]
        {
            let n = Vec3::new(x, y, z).normalize();
            let frame = Frame::<f32>::around(n.into());
            let [s, t, n] = [frame.s, frame.t, frame.n].map(Vec3::from);
            for v in [s, t, n] {
                assert!((v.length() - 1.0).abs() < 1e-6, "{v}");
            }
            assert!((s.cross(t) - n).length() < 1e-6, "{s} {t} {n}");
            let v = Vec3::new(0.1, -0.7, 2.0);
            assert!((Vec3::from(frame.to_world(frame.to_local(v.into()))) - v).length() < 1e-6);
        }
    }
}
