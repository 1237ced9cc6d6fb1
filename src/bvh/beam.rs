//! Bounds on rays that point into one octant.
//!
//! A beam is an interval of origins and one of reciprocal directions along each axis, a beam a lane. The
//! bounds on products of intervals are taken with the rounded operations of the exact slab test, which are
//! monotone, so a box that a ray of the beam enters is never culled.

use super::{
    Node,
    extent::{self, Extent},
    packet::Packet,
};
use crate::geometry::{Pencils, RayLanes, aabb};
use crate::simd::{Mask8, Real, f32x8, vector3};

/// Beams in lanes, all into one octant.
pub(super) struct Beam {
    /// Where the rays point along each axis.
    negative: [bool; 3],
    /// The origin that makes a near plane nearest.
    near_org: [f32x8; 3],
    /// The origin that makes a far plane farthest.
    far_org: [f32x8; 3],
    /// The reciprocal direction of least magnitude.
    rdir_least: [f32x8; 3],
    /// That of greatest magnitude: infinite if a ray lies in the planes of the axis.
    rdir_greatest: [f32x8; 3],
    t_near: f32x8,
}

/// Least and greatest of a quantity, in lanes.
type Range = (f32x8, f32x8);

impl Beam {
    /// One beam around the active rays of a packet, in all lanes; `None` if they point into several
    /// octants.
    pub(super) fn of_packet<R: Packet>(ray: &RayLanes<R>, active: R::Mask) -> Option<Self> {
        let low = |x: R| R::select(active, x, R::splat(f32::INFINITY)).least();
        let high = |x: R| R::select(active, x, R::splat(f32::NEG_INFINITY)).greatest();
        let range = |x: R| (f32x8::splat(low(x)), f32x8::splat(high(x)));
        let t_near = f32x8::splat(low(ray.t_near));
        let (org, rdir) = ([ray.org.x, ray.org.y, ray.org.z], [ray.rdir.x, ray.rdir.y, ray.rdir.z]);
        Self::new(org.map(range), rdir.map(range), t_near)
    }

    /// The beams of two runs, a bundle each; `None` if they point into several octants.
    pub(super) fn of_runs(one: &Extent, other: &Extent) -> Option<Self> {
        let lanes = |of: fn(&Extent) -> &[extent::Range; 3], axis: usize| {
            let ((low, high), (other_low, other_high)) = (of(one)[axis], of(other)[axis]);
            (f32x8::of_halves(low, other_low), f32x8::of_halves(high, other_high))
        };
        let org = [0, 1, 2].map(|axis| lanes(|extent| &extent.org, axis));
        let rdir = [0, 1, 2].map(|axis| lanes(|extent| &extent.rdir, axis));
        Self::new(org, rdir, f32x8::splat(Real::min(one.t_near, other.t_near)))
    }

    /// The directions of the beams, if all of them have one origin.
    pub(super) fn pencils(&self) -> Option<Pencils> {
        let origin = |axis: usize| {
            let first = f32x8::splat(self.near_org[axis].lane(0));
            let same = first.equal(self.near_org[axis]) & first.equal(self.far_org[axis]);
            same.all().then(|| first.lane(0))
        };
        let org = glam::vec3(origin(0)?, origin(1)?, origin(2)?);
        let one = f32x8::splat(1.0);
        // Least and greatest in magnitude are each other's reciprocals.
        let least =
            vector3(self.rdir_greatest[0], self.rdir_greatest[1], self.rdir_greatest[2]).map(|r| one / r);
        let greatest = vector3(self.rdir_least[0], self.rdir_least[1], self.rdir_least[2]).map(|r| one / r);
        Some(Pencils::new(org, least.min(greatest), least.max(greatest)))
    }

    /// One beam around all lanes, in all lanes.
    pub(super) fn around(&self) -> Self {
        let low = |x: f32x8| f32x8::splat(x.reduce_min());
        let high = |x: f32x8| f32x8::splat(x.reduce_max());
        let mut beam = Self { t_near: low(self.t_near), ..*self };
        for axis in 0..3 {
            let negative = self.negative[axis];
            let (near, far) = (self.near_org[axis], self.far_org[axis]);
            let (least, greatest) = (self.rdir_least[axis], self.rdir_greatest[axis]);
            (beam.near_org[axis], beam.far_org[axis]) =
                if negative { (low(near), high(far)) } else { (high(near), low(far)) };
            (beam.rdir_least[axis], beam.rdir_greatest[axis]) =
                if negative { (high(least), low(greatest)) } else { (low(least), high(greatest)) };
        }
        beam
    }

    fn new(org: [Range; 3], rdir: [Range; 3], t_near: f32x8) -> Option<Self> {
        let zero = [f32x8::default(); 3];
        let mut beam = Self {
            negative: [false; 3],
            near_org: zero,
            far_org: zero,
            rdir_least: zero,
            rdir_greatest: zero,
            t_near,
        };
        for axis in 0..3 {
            let ((org_low, org_high), (low, high)) = (org[axis], rdir[axis]);
            let negative = high.lt(f32x8::zero());
            if negative.all() {
                beam.negative[axis] = true;
                (beam.near_org[axis], beam.far_org[axis]) = (org_low, org_high);
                (beam.rdir_least[axis], beam.rdir_greatest[axis]) = (high, low);
            } else if low.ge(f32x8::zero()).all() {
                (beam.near_org[axis], beam.far_org[axis]) = (org_high, org_low);
                (beam.rdir_least[axis], beam.rdir_greatest[axis]) = (low, high);
            } else {
                return None;
            }
        }
        Some(beam)
    }

    /// Which lanes may enter their box, and a bound on where. `planes(axis)` gives the bounds that are met
    /// first and last.
    #[inline]
    pub(super) fn meets(&self, planes: impl Fn(usize) -> (f32x8, f32x8), farthest: f32x8) -> (Mask8, f32x8) {
        let (mut low, mut high) = (self.t_near, farthest);
        for axis in 0..3 {
            let (near, far) = planes(axis);
            let (near, far) = (near - self.near_org[axis], far - self.far_org[axis]);
            // 0·∞: a ray in the plane itself, which does not constrain. NaN is kept because it stands
            // on the right, and then loses against `low` and `high`.
            let near = (near * self.rdir_least[axis]).min(near * self.rdir_greatest[axis]);
            let far = (far * self.rdir_least[axis]).max(far * self.rdir_greatest[axis]);
            low = near.max(low);
            high = (far * f32x8::splat(aabb::WIDEN)).min(high);
        }
        (low.le(high), low)
    }

    /// The children of a node that a beam may enter; lanes are children, and so all lanes one beam.
    #[inline]
    pub(super) fn children(&self, node: &Node, farthest: f32) -> (Mask8, f32x8) {
        let planes = |axis: usize| {
            let (near, far) = node.slabs(axis, self.negative[axis]);
            (f32x8::from(*near), f32x8::from(*far))
        };
        self.meets(planes, f32x8::splat(farthest))
    }

    /// The beams that may enter a child; lanes are beams.
    #[inline]
    pub(super) fn beams(&self, node: &Node, place: usize, farthest: f32x8) -> Mask8 {
        self.meets(|axis| self.planes(node, place, axis), farthest).0
    }

    /// The rays of a packet within the beam that enter a child before `t_far`: the exact test; lanes are
    /// rays.
    #[inline]
    pub(super) fn rays<R: Real>(&self, node: &Node, place: usize, ray: &RayLanes<R>, t_far: R) -> R::Mask {
        let [x, y, z] = [0, 1, 2].map(|axis| self.planes(node, place, axis));
        let (near, far) = (vector3(x.0, y.0, z.0), vector3(x.1, y.1, z.1));
        let near = (near - ray.org) * ray.rdir;
        let far = ((far - ray.org) * ray.rdir).scale(R::splat(aabb::WIDEN));
        let low = near.z.max(near.y.max(near.x.max(ray.t_near)));
        low.le(far.z.min(far.y.min(far.x.min(t_far))))
    }

    /// The bounds of one child along an axis, in all lanes.
    #[inline]
    fn planes<R: Real>(&self, node: &Node, place: usize, axis: usize) -> (R, R) {
        let (near, far) = node.slabs(axis, self.negative[axis]);
        (R::splat(near[place]), R::splat(far[place]))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::bvh::Child;
    use crate::geometry::{
        Aabb, Ray, Rayx8,
        seeds::{Random, packet},
    };
    use crate::simd::{LANES, Mask};

    /// Rays with one sign along each axis, each at a corner of one of the boxes, from one origin or from several.
    fn aimed(random: &mut Random, boxes: &[Aabb; 8], one_origin: bool) -> Rayx8 {
        let side = random.vector();
        let origin = |random: &mut Random| side * 8.0 + if one_origin { Vec3::ZERO } else { random.vector() };
        packet(&std::array::from_fn(|_| {
            let (bounds, org) = (&boxes[random.below(8) as usize], origin(random));
            let corners = [bounds.min, bounds.max];
            let corner =
                Vec3::from_array(std::array::from_fn(|axis| corners[random.below(2) as usize][axis]));
            Ray::new(org, corner - org, 0.0, f32::INFINITY)
        }))
    }

    /// Corners are where slabs leave no room for rounding.
    #[test]
    fn a_beam_enters_what_a_ray_of_it_enters() {
        let mut random = Random::new(3);
        let (mut beams, mut entered) = (0, 0);
        for i in 0..20_000 {
            let boxes: [Aabb; 8] = std::array::from_fn(|_| {
                let (centre, size) = (random.vector(), random.vector().abs());
                Aabb { min: centre - size, max: centre + size }
            });
            let mut node = Node::EMPTY;
            for (place, bounds) in boxes.iter().enumerate() {
                node.set(place, *bounds, Child::leaf(place as u32, 1));
            }
            let rays = aimed(&mut random, &boxes, i % 2 == 0);
            let active = Mask8::first(1 + random.below(8) as usize);
            let Some(beam) = Beam::of_packet(&rays, active) else { continue };
            beams += 1;
            let t_far = f32x8::splat([f32::INFINITY, 1.0][i / 2 % 2]);
            let (children, nearest) = beam.children(&node, t_far.lane(0));
            for (place, bounds) in boxes.iter().enumerate() {
                let exact = beam.rays(&node, place, &rays, t_far) & active;
                for lane in (0..LANES).filter(|&lane| exact.lane(lane)) {
                    entered += 1;
                    assert!(children.lane(place), "case {i}: a ray enters child {place}, its beam does not");
                    let (near, _) = bounds.interval(&rays.lane(lane));
                    assert!(nearest.lane(place) <= near, "case {i}: child {place} is said to be farther");
                }
                let all = beam.beams(&node, place, t_far);
                assert!(!exact.any() || all.all(), "case {i}: a ray enters child {place}, its beam does not");
            }
        }
        assert!(beams > 1000 && entered > 10_000, "{beams} beams, {entered} boxes entered");
    }
}
