//! Columns of a wavefront: plain numbers in an arena, read and written by slot.

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::integrator::Path;
use crate::geometry::RayLanes;
use crate::simd::{Bits, LANES, Mask, Mask8, Real, Vec3x8, f32x8, u32x8, vector3};

/// One number a slot. Lengths are padded to whole packets.
pub(super) type Column<'a> = BumpVec<'a, f32>;
/// One integer a slot.
pub(super) type IntColumn<'a> = BumpVec<'a, u32>;
/// Three numbers a slot.
pub(super) type Column3<'a> = [Column<'a>; 3];

pub(super) fn column3(arena: &Bump) -> Column3<'_> {
    std::array::from_fn(|_| BumpVec::new_in(arena))
}

#[inline]
pub(super) fn gather(column: &[f32], slots: &[u32; LANES]) -> f32x8 {
    f32x8::from_fn(|i| column[slots[i] as usize])
}

#[inline]
pub(super) fn gather3(columns: &Column3, slots: &[u32; LANES]) -> Vec3x8 {
    let [x, y, z] = columns;
    vector3(gather(x, slots), gather(y, slots), gather(z, slots))
}

#[inline]
pub(super) fn scatter(column: &mut [f32], at: &[u32; LANES], lanes: u32, value: f32x8) {
    let values = value.to_array();
    let mut left = lanes;
    while left != 0 {
        let i = left.trailing_zeros() as usize;
        left &= left - 1;
        column[at[i] as usize] = values[i];
    }
}

#[inline]
pub(super) fn scatter3(columns: &mut Column3, at: &[u32; LANES], lanes: u32, value: Vec3x8) {
    let [x, y, z] = columns;
    scatter(x, at, lanes, value.x);
    scatter(y, at, lanes, value.y);
    scatter(z, at, lanes, value.z);
}

/// Eight neighbours from a multiple of eight on.
#[inline]
pub(super) fn load(column: &[f32], first: usize) -> f32x8 {
    column[first..].first_chunk().map_or_else(f32x8::zero, |lanes| f32x8::new(*lanes))
}

#[inline]
pub(super) fn load3(columns: &Column3, first: usize) -> Vec3x8 {
    vector3(load(&columns[0], first), load(&columns[1], first), load(&columns[2], first))
}

/// Rays.
pub(super) struct RayColumns<'a> {
    pub(super) org: Column3<'a>,
    pub(super) dir: Column3<'a>,
    pub(super) t_far: Column<'a>,
}

impl<'a> RayColumns<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self { org: column3(arena), dir: column3(arena), t_far: BumpVec::new_in(arena) }
    }

    fn columns(&mut self) -> impl Iterator<Item = &mut Column<'a>> {
        self.org.iter_mut().chain(&mut self.dir).chain([&mut self.t_far])
    }

    pub(super) fn resize(&mut self, len: usize) {
        self.columns().for_each(|column| column.resize(len, 0.0));
    }

    /// Appends the `lanes` of a packet.
    pub(super) fn push(&mut self, lanes: u32, (org, dir, t_far): (Vec3x8, Vec3x8, f32x8)) {
        let values = [org.x, org.y, org.z, dir.x, dir.y, dir.z, t_far].map(f32x8::to_array);
        for (column, values) in self.columns().zip(values) {
            column.extend((0..LANES).filter(|i| lanes >> i & 1 != 0).map(|i| values[i]));
        }
    }

    /// The packet that starts at a slot.
    #[inline]
    pub(super) fn packet(&self, first: usize) -> RayLanes<f32x8> {
        RayLanes::new(
            load3(&self.org, first),
            load3(&self.dir, first),
            f32x8::zero(),
            load(&self.t_far, first),
        )
    }
}

/// Paths in flight: a ray each, and what it is worth.
pub(super) struct PathColumns<'a> {
    pub(super) rays: RayColumns<'a>,
    beta: Column3<'a>,
    pdf: Column<'a>,
    eta2: Column<'a>,
    pub(super) key: IntColumn<'a>,
    /// Place of the pixel in the tile.
    pub(super) pixel: IntColumn<'a>,
    /// Slots in use; columns are padded beyond it.
    pub(super) len: usize,
}

impl<'a> PathColumns<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self {
            rays: RayColumns::new(arena),
            beta: column3(arena),
            pdf: BumpVec::new_in(arena),
            eta2: BumpVec::new_in(arena),
            key: BumpVec::new_in(arena),
            pixel: BumpVec::new_in(arena),
            len: 0,
        }
    }

    /// Makes room for `len` paths and the padding of the last packet.
    pub(super) fn resize(&mut self, len: usize) {
        self.len = len;
        let padded = len.next_multiple_of(LANES);
        self.rays.resize(padded);
        self.beta.iter_mut().chain([&mut self.pdf, &mut self.eta2]).for_each(|c| c.resize(padded, 0.0));
        self.key.resize(padded, 0);
        self.pixel.resize(padded, 0);
    }

    /// Writes the `lanes` of a packet to the slots `at`.
    pub(super) fn store(
        &mut self,
        at: &[u32; LANES],
        lanes: u32,
        (org, dir, t_far): (Vec3x8, Vec3x8, f32x8),
        path: &Path<f32x8>,
    ) {
        scatter3(&mut self.rays.org, at, lanes, org);
        scatter3(&mut self.rays.dir, at, lanes, dir);
        scatter(&mut self.rays.t_far, at, lanes, t_far);
        scatter3(&mut self.beta, at, lanes, path.beta);
        scatter(&mut self.pdf, at, lanes, path.pdf);
        scatter(&mut self.eta2, at, lanes, path.eta2);
        for i in (0..LANES).filter(|i| lanes >> i & 1 != 0) {
            self.key[at[i] as usize] = path.key.lane(i);
        }
    }

    /// The paths in some slots.
    #[inline]
    pub(super) fn path(&self, slots: &[u32; LANES], depth: u32, sample: u32) -> Path<f32x8> {
        Path {
            beta: gather3(&self.beta, slots),
            pdf: gather(&self.pdf, slots),
            eta2: gather(&self.eta2, slots),
            key: u32x8::from_fn(|i| self.key[slots[i] as usize]),
            depth,
            sample,
        }
    }

    /// Moves the paths that are alive to the front, in order. `kept` is scratch.
    pub(super) fn compact(&mut self, alive: &[bool], kept: &mut IntColumn) {
        kept.clear();
        kept.extend((0..self.len as u32).filter(|&slot| alive[slot as usize]));
        if kept.len() < self.len {
            // Column by column: each is read and written in order.
            let Self { rays: RayColumns { org, dir, t_far }, beta, pdf, eta2, key, pixel, .. } = self;
            for column in org.iter_mut().chain(dir).chain([t_far]).chain(beta).chain([pdf, eta2]) {
                pull(column, kept);
            }
            pull(key, kept);
            pull(pixel, kept);
        }
        self.resize(kept.len());
    }
}

/// Element i becomes what was at `from[i]`, which ascends.
fn pull<T: Copy>(column: &mut [T], from: &[u32]) {
    for (to, &from) in from.iter().enumerate() {
        column[to] = column[from as usize];
    }
}

/// The lanes of a mask as bits, of the first `count` only.
#[inline]
pub(super) fn lane_bits(mask: Mask8, count: usize) -> u32 {
    mask.to_bitmask() & ((1 << count) - 1)
}

/// Slots for a packet from fewer than eight: the last is repeated, so that every lane holds a real path.
#[inline]
pub(super) fn fill(slots: &[u32]) -> [u32; LANES] {
    std::array::from_fn(|i| slots[i.min(slots.len() - 1)])
}
