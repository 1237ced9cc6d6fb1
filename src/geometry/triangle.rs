//! Ray against triangle \[MT97\].
//!
//! With s = org − v₀, p = dir × e₂, q = s × e₁ and det = e₁·p, Cramer's rule on
//! org + t·dir = v₀ + u·e₁ + v·e₂ gives
//!
//! ```text
//! u = s·p / det     v = dir·q / det     t = e₂·q / det
//! ```
//!
//! A hit has u ≥ 0, v ≥ 0 and w = 1 − u − v ≥ 0: det and the numerators of all three have one sign. Unlike
//! the paper there is no culling and no epsilon, and t is clamped to the triangle's own slabs (see
//! [`geometry`](super)).
//!
//! Numerators are rounded by less than a margin that grows with the edges and the distance. Beyond it their
//! signs are certain. Within it two neighbours might both say that the ray is on the other's side of their
//! edge; there, and for hardly any ray, [`crossing`] decides, which can't.
//!
//! In lanes, a bound on the margins that is cheaper than they are takes their place ([`Aspect::margin`]):
//! whoever is beyond it, on either side, is certain. Only where a lane is not, the margins are worked out, and
//! that out of the way ([`TriangleLanes::intersect`]).

mod aspect;

use glam::Vec3;

use aspect::within;
pub use aspect::{Aspect, AspectColumns};

use super::{Aabb, Ray, RayLanes, aabb, crossing::crossing};
use crate::simd::{Mask, Real, Vector3, vector3};

/// Bound on the rounding of a numerator, in units of all its products: with a = |s| + |e₁| + |e₂| and
/// e = |e₁| + |e₂|, by components, the sum of aᵢ·|dir|ⱼ·eₖ over the permutations of the axes. A product takes
/// part in at most 7 roundings, two of them of the differences that s and an edge are; w adds two more. These
/// are 12, for the margin is rounded itself.
const ULPS: f32 = 6.0 * f32::EPSILON;
/// Against products that underflow.
const LEAST: f32 = 1e-34;
/// Against directions so short that what they have to do with margins underflows: far less than that of any others.
const SHORT: f32 = f32::MIN_POSITIVE;

/// Three vertices: all that neighbours share to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex.
    pub v0: Vec3,
    /// Second vertex.
    pub v1: Vec3,
    /// Third vertex.
    pub v2: Vec3,
}

impl Triangle {
    /// From three vertices.
    #[inline]
    pub fn new(v0: Vec3, v1: Vec3, v2: Vec3) -> Self {
        Self { v0, v1, v2 }
    }

    /// v₁ − v₀.
    #[inline]
    pub fn e1(&self) -> Vec3 {
        self.v1 - self.v0
    }

    /// v₂ − v₀.
    #[inline]
    pub fn e2(&self) -> Vec3 {
        self.v2 - self.v0
    }

    /// |e₁| + |e₂| by sums of absolute components: kept beside the vertices, it is what the bound on rounding
    /// needs.
    #[inline]
    pub fn edges(&self) -> f32 {
        self.e1().abs().element_sum() + self.e2().abs().element_sum()
    }

    /// The box that decides hits.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points([self.v0, self.v1, self.v2])
    }

    /// One ray: (t, u, v).
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, f32, f32)> {
        let (e1, e2) = (self.e1(), self.e2());
        let p = ray.dir.cross(e2);
        let det = e1.dot(p);
        let s = ray.org - self.v0;
        let u = s.dot(p);
        let q = s.cross(e1);
        let v = ray.dir.dot(q);
        let w = det - u - v;
        let least = Real::min(Real::min(u, v), w);
        let greatest = Real::max(Real::max(u, v), w);
        let inside = Real::max(least, -greatest);
        let (d, e) = (ray.dir.abs(), e1.abs() + e2.abs());
        let a = s.abs() + e;
        let products = Vec3::new(a.y * e.z + a.z * e.y, a.z * e.x + a.x * e.z, a.x * e.y + a.y * e.x);
        let margin = d.dot(products * ULPS) + LEAST;
        let (t, u, v) = if inside > margin {
            let inverse = 1.0 / det;
            (e2.dot(q) * inverse + 0.0, u * inverse, v * inverse)
        } else if inside >= -margin {
            crossing(ray.org, ray.dir, [self.v0, self.v1, self.v2])?
        } else {
            return None;
        };
        let (low, high) =
            self.bounds().interval(&Ray { t_near: f32::NEG_INFINITY, t_far: f32::INFINITY, ..*ray });
        let t = Real::min(high, Real::max(low, t));
        (low <= high && ray.t_near < t && t <= ray.t_far).then_some((t, u, v))
    }
}

/// What a direction has to do with the margins of triangles. A fifth more than ULPS, against the rounding of
/// the margins themselves.
#[inline]
pub(super) fn rounding<R: Real>(dir: Vector3<R>) -> R {
    dir.abs().element_sum() * R::splat(1.2 * ULPS) + R::splat(SHORT)
}

/// The same, by components: for the margins that [`Aspect::margin_towards`] works out.
#[inline]
pub(super) fn roundings<R: Real>(dir: Vector3<R>) -> Vector3<R> {
    dir.abs().map(|d| d * R::splat(1.2 * ULPS) + R::splat(SHORT))
}

/// aⱼ·bₖ + aₖ·bⱼ for each axis i and the two others.
#[inline]
fn products<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    vector3(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}

/// Triangles in lanes: eight of a block, or one in all of them.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLanes<R> {
    /// First vertices.
    pub v0: Vector3<R>,
    /// Second vertices.
    pub v1: Vector3<R>,
    /// Third vertices.
    pub v2: Vector3<R>,
    /// [`Triangle::edges`].
    pub edges: R,
}

impl<R: Real> TriangleLanes<R> {
    /// As seen from an origin.
    #[inline(always)]
    pub fn aspect(&self, org: Vector3<R>) -> Aspect<R> {
        let (e1, e2) = (self.v1 - self.v0, self.v2 - self.v0);
        let s = org - self.v0;
        let q = s.cross(e1);
        Aspect { e1, e2, s, q, depth: e2.dot(q) }
    }

    /// The (lower, upper) corners of their boxes.
    #[inline(always)]
    pub fn corners(&self) -> (Vector3<R>, Vector3<R>) {
        (self.v0.min(self.v1).min(self.v2), self.v0.max(self.v1).max(self.v2))
    }

    /// Where rays are within their boxes.
    #[inline(always)]
    fn slabs(&self, ray: &RayLanes<R>) -> (R, R) {
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        aabb::interval(self.corners(), (ray.org, ray.rdir), all)
    }

    /// Eight rays, eight triangles, or eight of each: (hit, t, u, v) of the lanes in `active`.
    #[inline(never)]
    pub fn intersect(&self, ray: &RayLanes<R>, active: R::Mask) -> (R::Mask, R, R, R) {
        let aspect = self.aspect(ray.org);
        let tested = aspect.test(aspect.margin(self.edges, ray.margin), ray, active);
        let doubtful = tested.near & !tested.certain;
        let (t, u, v) = tested.quotients(aspect.depth);
        let found = (tested.near & tested.certain, t, u, v);
        let found = if doubtful.any() { self.look_again(ray, doubtful, tested.inside, found) } else { found };
        within(ray, found.0, (found.1, found.2, found.3), self.slabs(ray))
    }

    /// The same for rays whose origin the triangles have been seen from; `None`, and [`intersect`](Self::intersect)
    /// decides, if a lane is so near to an edge that more has to be asked.
    // Always: as a call, rays and triangles would go through memory. And nothing is called from here: what lives
    // across a call, however rare, is kept in memory from the start.
    #[inline(always)]
    pub fn intersect_seen(
        &self,
        aspect: &Aspect<R>,
        margin: R,
        ray: &RayLanes<R>,
        active: R::Mask,
    ) -> Option<(R::Mask, R, R, R)> {
        aspect.answer(&aspect.test(margin, ray, active), ray, || self.slabs(ray))
    }

    /// The same, for one ray to each block of triangles: rays that leave a surface cross the planes of those around them
    /// just before they begin, and what they have certainly behind them is not looked at further.
    #[inline(always)]
    pub fn intersect_ahead(
        &self,
        aspect: &Aspect<R>,
        margin: R,
        ray: &RayLanes<R>,
        active: R::Mask,
    ) -> Option<(R::Mask, R, R, R)> {
        let mut tested = aspect.test(margin, ray, active);
        tested.near = tested.near & !(tested.certain & aspect.behind(self.edges, &tested, ray));
        aspect.answer(&tested, ray, || self.slabs(ray))
    }

    /// Decides about lanes whose numerators are within the bound: by their margins, and within these by
    /// [`crossing`].
    #[cold]
    #[inline(never)]
    fn look_again(
        &self,
        ray: &RayLanes<R>,
        lanes: R::Mask,
        inside: R,
        (hit, t, u, v): (R::Mask, R, R, R),
    ) -> (R::Mask, R, R, R) {
        let e = (self.v1 - self.v0).abs() + (self.v2 - self.v0).abs();
        let a = (ray.org - self.v0).abs() + e;
        let margin = ray.dir.abs().dot(products(a, e).scale(R::splat(ULPS))) + R::splat(LEAST);
        let certain = margin.lt(inside) & lanes;
        let found = (hit | certain, t, u, v);
        let doubtful = (-margin).le(inside) & lanes & !certain;
        if doubtful.any() { self.ask_again(ray, doubtful, found) } else { found }
    }

    /// Replaces the answers of some lanes by those of [`crossing`].
    #[cold]
    #[inline(never)]
    fn ask_again(
        &self,
        ray: &RayLanes<R>,
        lanes: R::Mask,
        (hit, t, u, v): (R::Mask, R, R, R),
    ) -> (R::Mask, R, R, R) {
        let (mut bits, mut left) = (hit.to_bitmask(), lanes.to_bitmask());
        let mut rows = [t, u, v].map(|row| std::array::from_fn::<_, 16, _>(|i| row.lane(i % R::LANES)));
        while left != 0 {
            let lane = left.trailing_zeros() as usize % 16;
            left &= left - 1;
            let vertices = [self.v0.lane(lane), self.v1.lane(lane), self.v2.lane(lane)];
            if let Some((t, u, v)) = crossing(ray.org.lane(lane), ray.dir.lane(lane), vertices) {
                bits |= 1 << lane;
                [rows[0][lane], rows[1][lane], rows[2][lane]] = [t, u, v];
            }
        }
        let [t, u, v] = rows.map(|row| R::from_fn(|lane| row[lane]));
        (R::Mask::from_bitmask(bits), t, u, v)
    }
}

#[cfg(test)]
mod tests;
