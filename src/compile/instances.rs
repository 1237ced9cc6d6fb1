//! Groups of shapes, compiled once, and the places where they stand: a tree in the leaves of a tree.
//!
//! An instance is one primitive of the scene, with one number, whatever its group holds. What a ray hits in
//! the group is the group's own number for it, and travels in the hit's `u`, as bits: two numbers of 28 bits
//! would not fit into one of 32, and barycentric weights are two products that shading can do again
//! ([`shading`]). So a hit keeps its 16 bytes, and a scene may place more triangles than 32 bits can count.

mod placing;
mod shading;

use std::cell::RefCell;

use rayon::prelude::*;

use super::primitives::{INSTANCE, Primitives, accept, accept_single};
use super::shapes::Degenerate;
use super::surfaces::Surfaces;
use super::{
    CompileError, References, Summary,
    shapes::{self, Named},
};
use crate::bvh::{Bvh, Hitx8, Quality, Reference, Traversal};
use crate::geometry::{Aabb, Hit, Placement, PrimitiveId, Ray, RayLanes, Rayx8};
use crate::scene::{GroupIndex, Instance, Shape, ShapeGroup};
use crate::simd::{Bits, Mask8, Real, f32x8, u32x8};

/// A group in its own space, with its own numbers.
#[derive(Debug)]
pub(super) struct Group {
    surfaces: Surfaces,
    primitives: Primitives,
    bvh: Bvh,
    degenerate: Vec<Degenerate>,
}

/// Which group, and where.
#[derive(Clone, Copy, Debug)]
struct Placed {
    group: u32,
    placement: Placement,
}

/// All instances of a scene.
#[derive(Debug, Default)]
pub(super) struct Instances {
    groups: Vec<Group>,
    placed: Vec<Placed>,
    /// The number of the first among the primitives of the scene; the others follow.
    first: u32,
    /// For each slot the place in `placed`; [`u32::MAX`] is padding.
    slots: Vec<u32>,
}

thread_local! {
    /// A group is traced in the middle of a trace that has a stack of its own.
    static BELOW: RefCell<Traversal> = RefCell::new(Traversal::new(()));
}

impl Group {
    /// Compiles the shapes of a group, and builds its tree.
    fn new(shapes: Vec<Shape>, named: &Named, quality: Quality) -> Result<Self, CompileError> {
        if let Some(shape) = shapes.iter().find(|shape| shape.radiance.is_some()) {
            return Err(CompileError::EmitterInGroup { shape: shape.name.clone() });
        }
        let shapes::Shapes { surfaces, references, degenerate, .. } =
            shapes::compile(shapes, named, &mut vec![])?;
        let mut bvh = Bvh::build_with(references, quality);
        let slots = bvh.take_slots();
        let primitives = Primitives::new(slots, Instances::default(), &surfaces);
        Ok(Self { surfaces, primitives, bvh, degenerate })
    }
}

impl Instances {
    /// Compiles the groups of a description and places them. `first` is the number of the first instance;
    /// `references` receives those that can be hit.
    pub(super) fn new(
        (groups, instances): (Vec<ShapeGroup>, &[Instance]),
        named: &Named,
        quality: Quality,
        first: u32,
        references: &mut References,
    ) -> Result<Self, CompileError> {
        let named = Named { metered: None, ..*named };
        let groups =
            groups.into_iter().map(|group| Ok((group.name, Group::new(group.shapes, &named, quality)?)));
        let (names, groups): (Vec<_>, Vec<_>) = groups.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let parts: Vec<_> = groups.iter().map(|group| placing::parts(&group.bvh)).collect();
        let place = |instance: &Instance| {
            let group = instance.group.0 as usize;
            let refusal = || CompileError::OutOfRange { shape: names[group].clone() };
            let placement = placing::place(&instance.to_world, &parts[group]).ok_or_else(refusal)?;
            Ok(Placed { group: instance.group.0, placement })
        };
        let placed = instances.par_iter().map(place).collect::<Result<Vec<_>, _>>()?;
        references.extend(
            (first..)
                .zip(&placed)
                .filter(|(_, placed)| !parts[placed.group as usize].is_empty())
                .map(|(index, placed)| Reference::new(placed.placement.bounds, index, INSTANCE)),
        );
        Ok(Self { groups, placed, first, slots: vec![] })
    }

    /// Is a primitive of the scene an instance?
    #[inline]
    pub(super) fn holds(&self, primitive: u32) -> bool {
        primitive.wrapping_sub(self.first) < self.placed.len() as u32
    }

    /// Puts instances into slots, as the tree assigned them to numbers of primitives.
    pub(super) fn fill(&mut self, slots: &[u32]) {
        self.slots = slots.to_vec();
    }

    /// Triangles without area, group by group.
    pub(super) fn degenerate(&self) -> impl Iterator<Item = Degenerate> + '_ {
        (0..).zip(&self.groups).flat_map(|(index, group)| {
            let group_index = Some(GroupIndex(index));
            group.degenerate.iter().map(move |&one| Degenerate { group: group_index, ..one })
        })
    }

    /// Adds groups and instances to what has been compiled; `share` is the part of the upper tree's bytes that
    /// one primitive has.
    pub(super) fn add_to(&self, summary: &mut Summary, share: f64) {
        let triangles =
            |group: &Group| group.surfaces.triangles.len() as u64 - Degenerate::total(&group.degenerate);
        let hit = |group: &Group| triangles(group) + group.surfaces.quadrics();
        for group in &self.groups {
            summary.triangles += triangles(group);
            summary.quadrics += group.surfaces.quadrics();
            summary.degenerate += Degenerate::total(&group.degenerate);
            summary.bvh_nodes += group.bvh.nodes().len() as u64;
            summary.bvh_bytes += (size_of_val(group.bvh.nodes()) + group.primitives.bytes()) as u64;
        }
        summary.groups = self.groups.len() as u32;
        summary.instances = self.placed.len() as u64;
        let counts: Vec<u64> = self.groups.iter().map(hit).collect();
        summary.placed = self.placed.iter().map(|placed| counts[placed.group as usize]).sum();
        let own = size_of_val(self.placed.as_slice()) + size_of_val(self.slots.as_slice());
        summary.bvh_bytes += own as u64;
        if !self.is_empty() {
            summary.instance_bytes = (own as f64 / self.placed.len() as f64 + share).round() as u64;
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.placed.len()
    }

    /// The box of a primitive that is an instance.
    pub(super) fn bounds(&self, primitive: u32) -> Option<Aabb> {
        self.holds(primitive).then(|| self.placed[(primitive - self.first) as usize].placement.bounds)
    }

    /// Is nothing placed?
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// The instance in a slot, its number and its group.
    #[inline]
    fn at(&self, slot: usize) -> Option<(&Placement, u32, &Group)> {
        let number = self.slots[slot];
        let placed = self.placed.get(number.wrapping_sub(self.first) as usize)?;
        Some((&placed.placement, number, &self.groups[placed.group as usize]))
    }

    /// A packet against the instance in a slot.
    // Out of the way of triangles, here and below: a group is worth a call.
    #[cold]
    #[inline(never)]
    pub(super) fn intersect_packet<const ANY: bool>(
        &self,
        slot: usize,
        ray: &Rayx8,
        active: Mask8,
        hit: &mut Hitx8,
    ) {
        let Some((placement, number, group)) = self.at(slot) else { return };
        let Some(entered) = placement.enter(&RayLanes { t_far: hit.t, ..*ray }, active) else { return };
        let none = u32x8::splat(PrimitiveId::NONE.0);
        let mut inside = Hitx8 { t: entered.ray.t_far, u: f32x8::zero(), v: f32x8::zero(), primitive: none };
        BELOW.with_borrow_mut(|below| {
            let (leaves, lanes) = (&group.primitives, entered.lanes);
            group.bvh.intersect_packet::<ANY, _, ()>(leaves, &entered.ray, lanes, &mut inside, below);
        });
        let blocked = inside.t.equal(f32x8::splat(f32::NEG_INFINITY));
        let found = entered.lanes & if ANY { blocked } else { !inside.primitive.equal(none) };
        let what = f32x8::from_bits(inside.primitive);
        accept::<ANY, f32x8>(hit, found, (entered.clamp(inside.t), what, f32x8::zero()), || {
            u32x8::splat(number)
        });
    }

    /// One ray against `count` instances, by the kernels of eight lanes.
    pub(super) fn intersect_alone<const ANY: bool>(
        &self,
        slot: usize,
        count: usize,
        ray: &Ray,
        hit: &mut Hit,
    ) {
        for slot in slot..slot + count {
            self.intersect::<ANY>(slot, ray, hit, |group, ray, inside| {
                BELOW.with_borrow_mut(|below| {
                    group.bvh.intersect_alone::<ANY, _, ()>(&group.primitives, ray, inside, below);
                });
            });
        }
    }

    /// One ray against the instance in a slot, by the scalar kernels.
    #[cold]
    #[inline(never)]
    pub(super) fn intersect_single<const ANY: bool>(&self, slot: usize, ray: &Ray, hit: &mut Hit) {
        self.intersect::<ANY>(slot, ray, hit, |group, ray, inside| {
            BELOW.with_borrow_mut(|below| {
                group.bvh.intersect_single::<ANY, _, ()>(&group.primitives, ray, inside, below);
            });
        });
    }

    /// One ray against every primitive of every instance.
    pub(super) fn brute_force(&self, ray: &Ray, hit: &mut Hit) {
        for slot in 0..self.slots.len() {
            self.intersect::<false>(slot, ray, hit, |group, ray, inside| {
                *inside = group.primitives.brute_force(ray);
            });
        }
    }

    /// One ray against the instance in a slot; `trace` finds what it hits in the group.
    #[inline]
    fn intersect<const ANY: bool>(
        &self,
        slot: usize,
        ray: &Ray,
        hit: &mut Hit,
        trace: impl FnOnce(&Group, &Ray, &mut Hit),
    ) {
        let Some((placement, number, group)) = self.at(slot) else { return };
        let limited = RayLanes::<f32>::splat(&Ray { t_far: hit.t, ..*ray });
        let Some(entered) = placement.enter(&limited, true) else { return };
        let mut inside = Hit { t: entered.ray.t_far, ..Hit::MISS };
        if entered.lanes {
            trace(group, &entered.ray.lane(0), &mut inside);
        }
        let found = if ANY { inside.t == f32::NEG_INFINITY } else { inside.primitive != PrimitiveId::NONE };
        if found {
            let what = f32::from_bits(inside.primitive.0);
            accept_single::<ANY>(hit, (entered.clamp(inside.t), what, 0.0), number);
        }
    }
}
