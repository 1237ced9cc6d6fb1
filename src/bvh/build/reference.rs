//! What the builder sees of a primitive: a box, a number, a class.

use rayon::prelude::*;

use super::bounds::Bounds;
use crate::geometry::Aabb;
use crate::simd::{prefetch, u32x8};

/// References in half a page.
const AHEAD: usize = 64;

/// A primitive, as the builder sees it: 32 bytes, half a cache line. A row of lanes, so that it is moved as a whole:
/// what is written in parts can't be read as a whole before it has left the processor's store buffer.
#[derive(Clone, Copy, Debug)]
pub struct Reference(u32x8);

impl Reference {
    /// A box, no coordinate of which is beyond half of the greatest float; the number that is handed back in
    /// [`Bvh::slots`](crate::bvh::Bvh::slots); and a class: leaves hold references of one.
    #[inline]
    pub fn new(bounds: Aabb, index: u32, class: u8) -> Self {
        let [x0, y0, z0] = (-bounds.min).to_array().map(f32::to_bits);
        let [x1, y1, z1] = bounds.max.to_array().map(f32::to_bits);
        Self(u32x8::new([x0, y0, z0, index, x1, y1, z1, u32::from(class)]))
    }

    /// Its box.
    #[inline]
    pub fn aabb(&self) -> Aabb {
        self.bounds().aabb()
    }

    /// Its box in a register.
    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_row(self.0)
    }

    /// Its number.
    #[inline]
    pub(super) fn index(&self) -> u32 {
        self.0.to_array()[3]
    }

    /// Its class.
    #[inline]
    pub(super) fn class(&self) -> u8 {
        self.0.to_array()[7] as u8
    }

    /// Asks memory for what stands some places on, while there is something else to do: what the processor foretells
    /// by itself ends with a page.
    #[inline]
    pub(super) fn ask_for_later(&self) {
        prefetch::<1>(std::ptr::from_ref(self).wrapping_add(AHEAD).cast());
    }

    /// Twice the middle of the box along an axis: what [`Bounds::centre`] has there, to the bit.
    #[inline]
    pub(super) fn centre(&self, axis: usize) -> f32 {
        let row = self.0.to_array();
        f32::from_bits(row[4 + axis]) - f32::from_bits(row[axis])
    }
}

/// What is left of references when their boxes are in a tree, in leaf order: 5 bytes each.
#[derive(Default)]
pub(super) struct Names {
    pub(super) indices: Vec<u32>,
    classes: Vec<u8>,
    /// Are there several classes at all?
    mixed: bool,
}

impl Names {
    /// Gives the boxes' memory back.
    pub(super) fn new(references: Vec<Reference>) -> Self {
        let mut names = Self::default();
        let both = references.par_iter().map(|reference| (reference.index(), reference.class()));
        both.unzip_into_vecs(&mut names.indices, &mut names.classes);
        let first = names.classes[0];
        // Not stopping at the first that differs: many at a time.
        names.mixed = names.classes.iter().fold(0, |bits, class| bits | (class ^ first)) != 0;
        names
    }

    /// The class of a place.
    #[inline]
    pub(super) fn class(&self, place: usize) -> u8 {
        self.classes[if self.mixed { place } else { 0 }]
    }

    /// Are so many from a place on of one class?
    #[inline]
    pub(super) fn are_of_one_class(&self, first: usize, count: usize) -> bool {
        let class = self.class(first);
        !self.mixed || self.classes[first..][..count].iter().all(|other| *other == class)
    }
}
