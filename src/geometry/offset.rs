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
