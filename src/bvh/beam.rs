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
use crate::simd::{LANES, Mask, Mask8, Mask16, Real, f32x8, f32x16, vector3};

/// Beams in lanes, all into one octant.
pub(super) struct Beam<R> {
    /// Where the rays point along each axis.
    negative: [bool; 3],
    /// The origin that makes a near plane nearest.
    near_org: [R; 3],
    /// The origin that makes a far plane farthest.
    far_org: [R; 3],
    /// The reciprocal direction of least magnitude.
    rdir_least: [R; 3],
    /// That of greatest magnitude: infinite if a ray lies in the planes of the axis.
    rdir_greatest: [R; 3],
    t_near: R,
}

/// The planes of a node's children, measured from an origin.
pub(super) struct Distances {
    /// Of the planes that are met first along each axis; lanes are children.
    near: [[f32; LANES]; 3],
    /// Of those that are met last.
    far: [[f32; LANES]; 3],
}

impl Distances {
    /// The rays from the same origin that enter a child before `t_far`: as [`Beam::rays`]; lanes are rays.
    #[inline]
    pub(super) fn entered<R: Real>(&self, place: usize, ray: &RayLanes<R>, t_far: R) -> R::Mask {
        let of = |[x, y, z]: &[[f32; LANES]; 3]| {
            vector3(R::splat(x[place]), R::splat(y[place]), R::splat(z[place]))
        };
        let near = of(&self.near) * ray.rdir;
        let far = (of(&self.far) * ray.rdir).scale(R::splat(aabb::WIDEN));
        let low = near.z.max(near.y.max(near.x.max(ray.t_near)));
        low.le(far.z.min(far.y.min(far.x.min(t_far))))
    }
}

/// Least and greatest of a quantity, in lanes.
type Range<R> = (R, R);

impl Beam<f32x8> {
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

    /// The children of a node that a beam may enter; lanes are children, and so all lanes one beam.
    #[inline]
    pub(super) fn children(&self, node: &Node, farthest: f32) -> (Mask8, f32x8) {
        let planes = |axis: usize| {
            let (near, far) = node.slabs(axis, self.negative[axis]);
            (f32x8::from(*near), f32x8::from(*far))
        };
        self.meets(planes, f32x8::splat(farthest))
    }

    /// The same for a beam from one origin, and what its rays and narrower beams need to know of the planes.
    #[inline]
    pub(super) fn children_and_distances(&self, node: &Node, farthest: f32) -> (Mask8, f32x8, Distances) {
        let nowhere = [[0.0; LANES]; 3];
        let mut distances = Distances { near: nowhere, far: nowhere };
        let (mut low, mut high) = (self.t_near, f32x8::splat(farthest));
        for axis in 0..3 {
            let (near, far) = node.slabs(axis, self.negative[axis]);
            let near = f32x8::from(*near) - self.near_org[axis];
            let far = f32x8::from(*far) - self.far_org[axis];
            (distances.near[axis], distances.far[axis]) = (near.to_array(), far.to_array());
            let (near, far) = self.meets_slab(axis, near, far);
            low = near.max(low);
            high = far.min(high);
        }
        (low.le(high), low, distances)
    }
}

impl Beam<f32x16> {
    /// The beams of up to four runs, a bundle each, the last of them in what lanes are left; `None` if they point into
    /// several octants.
    pub(super) fn of_runs(runs: [&Extent; 4]) -> Option<Self> {
        let lanes = |of: fn(&Extent) -> &[extent::Range; 3], axis: usize| {
            let [a, b, c, d] = runs.map(|extent| of(extent)[axis]);
            let of_quarters = |[a, b, c, d]: [[f32; 4]; 4]| {
                f32x16::of_halves([f32x8::of_halves(a, b), f32x8::of_halves(c, d)])
            };
            (of_quarters([a.0, b.0, c.0, d.0]), of_quarters([a.1, b.1, c.1, d.1]))
        };
        let org = [0, 1, 2].map(|axis| lanes(|extent| &extent.org, axis));
        let rdir = [0, 1, 2].map(|axis| lanes(|extent| &extent.rdir, axis));
        let t_near = runs.iter().fold(f32::INFINITY, |least, extent| Real::min(least, extent.t_near));
        Self::new(org, rdir, f32x16::splat(t_near))
    }

    /// The directions of the beams, if all of them have one origin and begin there or beyond.
    pub(super) fn pencils(&self) -> Option<Pencils> {
        if !f32x16::zero().le(self.t_near).all() {
            return None;
        }
        let origin = |axis: usize| {
            let first = f32x16::splat(self.near_org[axis].lane(0));
            let same = first.equal(self.near_org[axis]) & first.equal(self.far_org[axis]);
            same.all().then(|| first.lane(0))
        };
        let org = glam::vec3(origin(0)?, origin(1)?, origin(2)?);
        let one = f32x16::splat(1.0);
        // Least and greatest in magnitude are each other's reciprocals.
        let least =
            vector3(self.rdir_greatest[0], self.rdir_greatest[1], self.rdir_greatest[2]).map(|r| one / r);
        let greatest = vector3(self.rdir_least[0], self.rdir_least[1], self.rdir_least[2]).map(|r| one / r);
        Some(Pencils::new(org, self.negative, least.min(greatest), least.max(greatest)))
    }

    /// One beam around all lanes, in all lanes.
    pub(super) fn around(&self) -> Beam<f32x8> {
        let low = |x: f32x16| f32x8::splat(x.reduce_min());
        let high = |x: f32x16| f32x8::splat(x.reduce_max());
        let turned = |axis: usize, near: f32x16, far: f32x16| match self.negative[axis] {
            true => (low(near), high(far)),
            false => (high(near), low(far)),
        };
        let org = [0, 1, 2].map(|axis| turned(axis, self.near_org[axis], self.far_org[axis]));
        let rdir = [0, 1, 2].map(|axis| turned(axis, self.rdir_greatest[axis], self.rdir_least[axis]));
        Beam {
            negative: self.negative,
            near_org: org.map(|(near, _)| near),
            far_org: org.map(|(_, far)| far),
            rdir_least: rdir.map(|(_, least)| least),
            rdir_greatest: rdir.map(|(greatest, _)| greatest),
            t_near: low(self.t_near),
        }
    }

    /// The beams that may enter a child; lanes are beams.
    #[inline]
    pub(super) fn beams(&self, node: &Node, place: usize, farthest: f32x16) -> Mask16 {
        self.meets(|axis| self.planes(node, place, axis), farthest).0
    }

    /// The same for [pencils](Self::pencils). Which end of a beam meets a plane that is ahead first is known; one that is
    /// behind does not constrain where the box begins, and where it ends, nothing is hit.
    #[inline]
    pub(super) fn beams_from_one(&self, distances: &Distances, place: usize, farthest: f32x16) -> Mask16 {
        let (mut low, mut high) = (self.t_near, farthest);
        for axis in 0..3 {
            let near = f32x16::splat(distances.near[axis][place]) * self.rdir_least[axis];
            let far = f32x16::splat(distances.far[axis][place]) * self.rdir_greatest[axis];
            low = near.max(low);
            high = (far * f32x16::splat(aabb::WIDEN)).min(high);
        }
        low.le(high)
    }
}

impl<R: Real> Beam<R> {
    fn new(org: [Range<R>; 3], rdir: [Range<R>; 3], t_near: R) -> Option<Self> {
        let zero = [R::zero(); 3];
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
            if high.lt(R::zero()).all() {
                beam.negative[axis] = true;
                (beam.near_org[axis], beam.far_org[axis]) = (org_low, org_high);
                (beam.rdir_least[axis], beam.rdir_greatest[axis]) = (high, low);
            } else if low.ge(R::zero()).all() {
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
    fn meets(&self, planes: impl Fn(usize) -> (R, R), farthest: R) -> (R::Mask, R) {
        let (mut low, mut high) = (self.t_near, farthest);
        for axis in 0..3 {
            let (near, far) = planes(axis);
            let (near, far) = self.meets_slab(axis, near - self.near_org[axis], far - self.far_org[axis]);
            low = near.max(low);
            high = far.min(high);
        }
        (low.le(high), low)
    }

    /// Bounds on where the planes of a slab are met, by their distances from the origins.
    ///
    /// 0·∞ is a ray in the plane itself, which does not constrain. NaN is kept, and loses where it stands on the left
    /// of a maximum or minimum.
    #[inline]
    fn meets_slab(&self, axis: usize, near: R, far: R) -> (R, R) {
        let near = (near * self.rdir_least[axis]).min(near * self.rdir_greatest[axis]);
        let far = (far * self.rdir_least[axis]).max(far * self.rdir_greatest[axis]);
        (near, far * R::splat(aabb::WIDEN))
    }

    /// The rays of a packet within the beam that enter a child before `t_far`: the exact test; lanes are
    /// rays.
    #[inline]
    pub(super) fn rays<P: Real>(&self, node: &Node, place: usize, ray: &RayLanes<P>, t_far: P) -> P::Mask {
        let [x, y, z] = [0, 1, 2].map(|axis| self.planes(node, place, axis));
        let (near, far) = (vector3(x.0, y.0, z.0), vector3(x.1, y.1, z.1));
        let near = (near - ray.org) * ray.rdir;
        let far = ((far - ray.org) * ray.rdir).scale(P::splat(aabb::WIDEN));
        let low = near.z.max(near.y.max(near.x.max(ray.t_near)));
        low.le(far.z.min(far.y.min(far.x.min(t_far))))
    }

    /// The bounds of one child along an axis, in all lanes.
    #[inline]
    fn planes<P: Real>(&self, node: &Node, place: usize, axis: usize) -> (P, P) {
        let (near, far) = node.slabs(axis, self.negative[axis]);
        (P::splat(near[place]), P::splat(far[place]))
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

    /// Rays from one origin or from several: with one sign along each axis, mostly, each at a corner of one of the boxes; or
    /// from among the boxes, all into one octant.
    fn aimed(random: &mut Random, boxes: &[Aabb; 8], one_origin: bool) -> Rayx8 {
        let among = random.below(4) == 0;
        let side = random.vector() * if among { 0.6 } else { 8.0 };
        let origin = |random: &mut Random| side + if one_origin { Vec3::ZERO } else { random.vector() };
        packet(&std::array::from_fn(|_| {
            let (bounds, org) = (&boxes[random.below(8) as usize], origin(random));
            let corners = [bounds.min, bounds.max];
            let corner =
                Vec3::from_array(std::array::from_fn(|axis| corners[random.below(2) as usize][axis]));
            let dir = if among { (corner - org).abs() } else { corner - org };
            Ray::new(org, dir, 0.0, f32::INFINITY)
        }))
    }

    fn boxes(random: &mut Random) -> ([Aabb; 8], Node) {
        let boxes = std::array::from_fn(|_| {
            let (centre, size) = (random.vector(), random.vector().abs());
            Aabb { min: centre - size, max: centre + size }
        });
        let mut node = Node::EMPTY;
        for (place, bounds) in boxes.iter().enumerate() {
            node.set(place, *bounds, Child::leaf(place as u32, 1));
        }
        (boxes, node)
    }

    /// Corners are where slabs leave no room for rounding.
    #[test]
    fn a_beam_enters_what_a_ray_of_it_enters() {
        let mut random = Random::new(3);
        let (mut beams, mut entered) = (0, 0);
        for i in 0..20_000 {
            let (boxes, node) = boxes(&mut random);
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
            }
        }
        assert!(beams > 1000 && entered > 10_000, "{beams} beams, {entered} boxes entered");
    }

    /// Sixteen beams, each around a ray and the one after it, and the one beam around all of them.
    #[test]
    fn beams_in_lanes_enter_what_their_rays_enter() {
        let mut random = Random::new(4);
        let (mut entered, mut inside) = (0, 0);
        for i in 0..40_000 {
            let (boxes, node) = boxes(&mut random);
            let one_origin = i % 2 == 0;
            let rays = aimed(&mut random, &boxes, one_origin);
            let range = |x: f32x8| {
                let next = |i: usize| x.lane((i + 1) % LANES);
                let of = |pick: fn(f32, f32) -> f32| f32x16::from_fn(|i| pick(x.lane(i % LANES), next(i)));
                (of(Real::min), of(Real::max))
            };
            let (org, rdir) = (rays.org, rays.rdir);
            let org = [org.x, org.y, org.z].map(range);
            let rdir = [rdir.x, rdir.y, rdir.z].map(range);
            let Some(beams) = Beam::new(org, rdir, f32x16::zero()) else { continue };
            let t_far = [f32::INFINITY, 1.0][i / 2 % 2];
            let all = beams.around();
            let (children, nearest) = all.children(&node, t_far);
            let (same, same_nearest, distances) = all.children_and_distances(&node, t_far);
            assert_eq!(same.to_bitmask(), children.to_bitmask());
            assert_eq!(same_nearest.to_array(), nearest.to_array());
            for (place, bounds) in boxes.iter().enumerate() {
                let exact = all.rays(&node, place, &rays, f32x8::splat(t_far));
                let lanes = beams.beams(&node, place, f32x16::splat(t_far)).to_bitmask();
                let from_one = beams.beams_from_one(&distances, place, f32x16::splat(t_far)).to_bitmask();
                let within = bounds.contains(Aabb::of_points([rays.lane(0).org]));
                for lane in (0..LANES).filter(|&lane| exact.lane(lane)) {
                    entered += 1;
                    let around = 1 << lane | 1 << ((lane + LANES - 1) % LANES);
                    assert_eq!(
                        lanes & (around | around << 8),
                        around | around << 8,
                        "case {i}, child {place}"
                    );
                    assert!(children.lane(place), "case {i}: a ray enters child {place}");
                    if one_origin {
                        inside += u32::from(within);
                        let around = around | around << 8;
                        assert_eq!(from_one & around, around, "case {i}, child {place}");
                    }
                }
                if one_origin {
                    let known = distances.entered(place, &rays, f32x8::splat(t_far));
                    assert_eq!(known.to_bitmask(), exact.to_bitmask(), "case {i}, child {place}");
                    assert_eq!(from_one & !lanes, 0, "case {i}, child {place}");
                }
            }
        }
        assert!(entered > 10_000 && inside > 1000, "{entered} boxes entered, {inside} from inside");
    }
}
