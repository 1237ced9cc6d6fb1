//! What of a test of triangles does not depend on a ray's direction, and the test itself.

use glam::Vec3;

use super::{LEAST, products};
use crate::geometry::{RayLanes, aabb};
use crate::simd::{Bits, LANES, Mask, Real, Vector3, f32x8, vector3};

/// Bound on the rounding of e₂·q, in units of the product of all components' sums: eight roundings of each product,
/// |e₁||e₂| ≤ (|e₁| + |e₂|)²/4, and a fifth more against the rounding of the bound itself.
const DEPTH_ULPS: f32 = 1.2 * f32::EPSILON;

/// Triangles as they are seen from where rays start: what of the test does not depend on a direction.
#[derive(Clone, Copy, Debug)]
pub struct Aspect<R> {
    /// e₁.
    pub e1: Vector3<R>,
    /// e₂.
    pub e2: Vector3<R>,
    /// org − v₀.
    pub s: Vector3<R>,
    /// s × e₁.
    pub q: Vector3<R>,
    /// e₂·q, the numerator of t.
    pub depth: R,
}

/// Eight triangles as rays from one origin into one octant see them, in columns, from which lanes are read where they
/// are needed.
#[derive(Clone, Copy, Debug)]
pub struct AspectColumns {
    /// e₁, e₂, s and q.
    vectors: [[[f32; LANES]; 3]; 4],
    depth: [f32; LANES],
    /// From the origin to the planes of the triangles' boxes that are met first along each axis, and last.
    slabs: [[[f32; LANES]; 3]; 2],
}

impl AspectColumns {
    /// From lanes, their boxes' (lower, upper) corners, and where the rays point along each axis.
    #[inline]
    pub fn new(
        aspect: &Aspect<f32x8>,
        (min, max): (Vector3<f32x8>, Vector3<f32x8>),
        (org, negative): (Vec3, [bool; 3]),
    ) -> Self {
        let Aspect { e1, e2, s, q, depth } = *aspect;
        let columns = |v: Vector3<f32x8>| [v.x, v.y, v.z].map(f32x8::to_array);
        let org = Vector3::splat(org);
        let [mut near, mut far] = [min - org, max - org].map(columns);
        for axis in 0..3 {
            if negative[axis] {
                std::mem::swap(&mut near[axis], &mut far[axis]);
            }
        }
        Self { vectors: [e1, e2, s, q].map(columns), depth: depth.to_array(), slabs: [near, far] }
    }

    /// Rays against the triangle in a lane, by the operations of [`TriangleLanes::intersect_seen`](super::TriangleLanes).
    #[inline(always)]
    pub fn intersect<R: Real>(
        &self,
        lane: usize,
        margin: f32,
        ray: &RayLanes<R>,
        active: R::Mask,
    ) -> Option<(R::Mask, R, R, R)> {
        let splat =
            |[x, y, z]: &[[f32; LANES]; 3]| vector3(R::splat(x[lane]), R::splat(y[lane]), R::splat(z[lane]));
        let [e1, e2, s, q] = self.vectors.each_ref().map(splat);
        let aspect = Aspect { e1, e2, s, q, depth: R::splat(self.depth[lane]) };
        let tested = aspect.test(R::splat(margin), ray, active);
        // Whatever may be a hit is worked out to its end: a branch would be guessed wrong too often.
        let [near, far] = self.slabs.each_ref().map(splat);
        let slabs = aabb::within_slabs(near, far, ray.rdir);
        let found = within(ray, tested.near, tested.quotients(aspect.depth), slabs);
        let doubtful = (tested.near & !tested.certain).any();
        (!doubtful).then_some(found)
    }
}

/// Numerators, and what they say.
pub(super) struct Tested<R: Real> {
    /// Not certainly a miss.
    pub(super) near: R::Mask,
    /// Neither a hit nor a miss by rounding.
    pub(super) certain: R::Mask,
    /// The least magnitude of a numerator: negative if not all have one sign.
    pub(super) inside: R,
    det: R,
    u: R,
    v: R,
}

impl<R: Real> Tested<R> {
    /// (t, u, v), by the numerator of t. A division, so not before they are wanted.
    #[inline(always)]
    pub(super) fn quotients(&self, depth: R) -> (R, R, R) {
        let inverse = R::one() / self.det;
        // A zero added: rays from +0 and from −0 see the same aspect, and have the same t.
        (depth * inverse + R::zero(), self.u * inverse, self.v * inverse)
    }
}

impl<R: Real> Aspect<R> {
    /// A bound on the margins: a sum of products is at most the product of the sums. `edges` are the triangles',
    /// `rounding` is the rays' [`margin`](RayLanes::margin).
    #[inline(always)]
    pub fn margin(&self, edges: R, rounding: R) -> R {
        self.size(edges) * rounding + R::splat(LEAST)
    }

    /// The margins themselves, for any direction of which `rounding` bounds what it has to do with them: a quarter of
    /// the bound, for twice the work.
    #[inline(always)]
    pub fn margin_towards(&self, rounding: Vector3<R>) -> R {
        let e = self.e1.abs() + self.e2.abs();
        products(self.s.abs() + e, e).dot(rounding) + R::splat(LEAST)
    }

    /// |s| + |e₁| + |e₂| by sums of components, times the edges'.
    #[inline(always)]
    fn size(&self, edges: R) -> R {
        (self.s.abs().element_sum() + edges) * edges
    }

    #[inline(always)]
    pub(super) fn test(&self, margin: R, ray: &RayLanes<R>, active: R::Mask) -> Tested<R> {
        let Self { e1, e2, s, q, .. } = *self;
        let p = ray.dir.cross(e2);
        let det = e1.dot(p);
        let u = s.dot(p);
        let v = ray.dir.dot(q);
        let w = det - u - v;
        let inside = u.min(v).min(w).max(-u.max(v).max(w));
        let near = (-margin).le(inside) & active;
        Tested { near, certain: margin.lt(inside), inside, det, u, v }
    }

    /// Lanes whose plane is certainly crossed before the ray begins, if their numerators are certain.
    ///
    /// Then they are no hits: t < 0 lies in the slabs of the triangle's box, the differences and products that
    /// make slabs keep their signs when they are rounded, and so t is not above 0 after the clamp.
    #[inline(always)]
    pub(super) fn behind(&self, edges: R, tested: &Tested<R>, ray: &RayLanes<R>) -> R::Mask {
        let sign = tested.det.to_bits() & R::Bits::splat(1 << 31);
        let depth = R::from_bits(self.depth.to_bits() ^ sign);
        let room = self.size(edges) * (edges * R::splat(DEPTH_ULPS)) + R::splat(LEAST);
        // A sum that overflowed says nothing of its sign, and by an infinite determinant all is divided to 0.
        let finite = R::splat(f32::MIN).le(depth) & tested.det.abs().le(R::splat(f32::MAX));
        depth.lt(-room) & finite & R::zero().le(ray.t_near)
    }

    /// What is to be said of lanes, if it is certain; `slabs` are those of their boxes.
    #[inline(always)]
    pub(super) fn answer(
        &self,
        tested: &Tested<R>,
        ray: &RayLanes<R>,
        slabs: impl FnOnce() -> (R, R),
    ) -> Option<(R::Mask, R, R, R)> {
        let &Tested { near, certain, .. } = tested;
        let nothing = R::zero();
        if near.none() {
            return Some((near, nothing, nothing, nothing));
        }
        let doubtful = (near & !certain).any();
        (!doubtful).then(|| within(ray, near, tested.quotients(self.depth), slabs()))
    }
}

/// Hits that lie in the triangles' boxes, whose slabs are given, and in the rays' ranges.
#[inline(always)]
pub(super) fn within<R: Real>(
    ray: &RayLanes<R>,
    hit: R::Mask,
    (t, u, v): (R, R, R),
    (low, high): (R, R),
) -> (R::Mask, R, R, R) {
    let t = high.min(low.max(t));
    (hit & low.le(high) & ray.t_near.lt(t) & t.le(ray.t_far), t, u, v)
}
