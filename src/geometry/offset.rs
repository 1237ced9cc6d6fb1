//! Where the next ray starts, so that it neither finds the surface it leaves nor passes through it.
//!
//! A computed point differs from the true one by at most half an ulp of each coordinate for its last
//! rounding, plus some ulps of the size of the surface around it, since positions are sums of a vertex
//! and parts of edges. The kernels' own error in the distance to the plane is a few ulps of that size
//! too. The origin moves along the geometric normal by the sum of both, projected onto the normal
//! \[PJH23\] (section 6.8), to the side that the ray leaves by. There is no constant in units of the scene:
//! the bound scales with it.
//!
//! A shadow ray to a point on a light ends just short of it ([`REACH`]), by the rounding of its direction
//! and of the kernels over its length.

use crate::simd::{Real, Vector3};

/// `t_far` of a ray from one point to another whose direction is their difference. Rounding of that
/// difference moves the end by an ulp of its length, and the kernels find the surface there with an error
/// of some more: products of the distance and the edges, over the cosine at the light.
pub const REACH: f32 = 1.0 - 16.0 * f32::EPSILON;

/// Ulps of the point's own coordinates: its rounding, and that of the moved point.
const POSITION: f32 = 1.0 * f32::EPSILON;
/// Ulps of the surface's size: the interpolation, and the kernel's distance to the plane.
const EXTENT: f32 = 4.0 * f32::EPSILON;

/// The point `p` on a surface of size `extent` with unit normal `n_g`, moved to the side of `w`.
#[inline]
pub fn offset_origin<R: Real>(
    p: Vector3<R>,
    extent: Vector3<R>,
    n_g: Vector3<R>,
    w: Vector3<R>,
) -> Vector3<R> {
    let error = p.abs().scale(R::splat(POSITION)) + extent.scale(R::splat(EXTENT));
    let distance = n_g.abs().dot(error);
    let distance = R::select(w.dot(n_g).lt(R::zero()), -distance, distance);
    p + n_g.scale(distance)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn the_origin_moves_by_both_errors_to_the_side_that_the_ray_leaves_by() {
        let (p, extent) = (Vec3::new(0.5, -2.0, -3.0), Vec3::new(1.0, 2.0, 4.0));
        let moved =
            |n: Vec3, w: Vec3| Vec3::from(offset_origin::<f32>(p.into(), extent.into(), n.into(), w.into()));
        // An ulp of the coordinate along the normal, and four of the size.
        for (axis, ulps) in [(Vec3::X, 4.5), (Vec3::Y, 10.0), (Vec3::Z, 19.0)] {
            let distance = axis * (ulps * f32::EPSILON);
            let leaving = axis + Vec3::new(0.1, -0.2, 0.3);
            assert_eq!(moved(axis, leaving), p + distance);
            assert_eq!(moved(axis, -leaving), p - distance);
            assert_eq!(moved(-axis, leaving), p + distance);
            assert_eq!(moved(-axis, -leaving), p - distance);
        }
    }
}
