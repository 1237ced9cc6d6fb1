//! Paths of a wavefront: rows of eight numbers in an arena, read and written by slot.
//!
//! Eight paths of one material stand in eight places. A row is half a cache line, and one transposition makes eight
//! registers of eight rows; column by column, each number would be a load of its own.

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::{integrator::Path, sort::Sorter};
use crate::geometry::{Hit, PrimitiveId, RayLanes};
use crate::simd::{
    Bits, Eights, LANES, MOST, Mask, Real, Vector3, compress, f32x8, transpose, u32x8, vector3,
};

/// Eight numbers a slot. Lengths are padded to whole packets.
pub(super) type Rows<'a> = BumpVec<'a, f32x8>;

/// Makes room for so many slots; what is in them stays.
pub(super) fn reserve<T: Clone>(slots: &mut BumpVec<T>, len: usize, fresh: T) {
    let padded = len.next_multiple_of(LANES);
    if slots.len() < padded {
        slots.resize(padded, fresh);
    }
}

/// Number k of each of these slots in register k.
#[inline]
pub(super) fn gather<R: Real>(rows: &[f32x8], slots: &[u32]) -> [R; 8] {
    R::from_rows(|i| rows[slots[i] as usize].to_array())
}

/// The other way round, for as many slots as there are.
#[inline]
fn scatter<R: Eights>(rows: &mut [f32x8], at: &[u32], numbers: &[R; 8]) {
    for (i, at) in at.chunks(LANES).enumerate() {
        let eight = transpose(std::array::from_fn(|k| numbers[k].eight(i)));
        for (row, &at) in eight.iter().zip(at) {
            rows[at as usize] = *row;
        }
    }
}

/// Slots for a group from fewer than its lanes: the last is repeated, so that every lane holds a real path.
#[inline]
pub(super) fn fill(slots: &[u32]) -> [u32; MOST] {
    std::array::from_fn(|i| slots[i.min(slots.len() - 1)])
}

/// Paths in lanes: their rays, what they are worth, and the places of their pixels in the tile.
#[derive(Clone, Copy)]
pub(super) struct Packet<R: Real> {
    pub(super) org: Vector3<R>,
    pub(super) dir: Vector3<R>,
    pub(super) t_far: R,
    pub(super) path: Path<R>,
    pub(super) pixel: R::Bits,
}

/// Paths in flight. A path that ends leaves its rows where they are: those that go on keep theirs, and are named
/// in order by their places.
pub(super) struct Paths<'a> {
    /// Origin, direction, end; key.
    rays: Rows<'a>,
    /// β, density, η²; pixel, sample.
    worth: Rows<'a>,
    /// For each slot the place of its rows.
    places: BumpVec<'a, u32>,
    octants: Octants<'a>,
    /// What was in `places`, while they are ordered.
    before: BumpVec<'a, u32>,
    /// Slots in use.
    pub(super) len: usize,
}

impl<'a> Paths<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        let rows = || BumpVec::new_in(arena);
        let (places, before) = (BumpVec::new_in(arena), BumpVec::new_in(arena));
        Self { rays: rows(), worth: rows(), places, octants: Octants::new(arena), before, len: 0 }
    }

    /// Makes room for so many paths.
    pub(super) fn reserve(&mut self, len: usize) {
        reserve(&mut self.rays, len, f32x8::zero());
        reserve(&mut self.worth, len, f32x8::zero());
    }

    /// Writes the first lanes of a packet to the places `at`.
    #[inline]
    pub(super) fn store<R: Eights>(&mut self, at: &[u32], packet: &Packet<R>) {
        let Packet { org, dir, t_far, path, pixel } = packet;
        let key = R::from_bits(path.key);
        scatter(&mut self.rays, at, &[org.x, org.y, org.z, dir.x, dir.y, dir.z, *t_far, key]);
        let (beta, pixel, sample) = (path.beta, R::from_bits(*pixel), R::from_bits(path.sample));
        scatter(&mut self.worth, at, &[beta.x, beta.y, beta.z, path.pdf, path.eta2, pixel, sample, sample]);
    }

    /// The paths in some slots.
    #[inline]
    pub(super) fn packet<R: Real>(&self, slots: &[u32; MOST], depth: u32) -> Packet<R> {
        let mut places = [0; MOST];
        for (place, &slot) in places[..R::LANES].iter_mut().zip(slots) {
            *place = self.places[slot as usize];
        }
        let [ox, oy, oz, dx, dy, dz, t_far, key] = gather(&self.rays, &places);
        let [r, g, b, pdf, eta2, pixel, sample, _] = gather(&self.worth, &places);
        Packet {
            org: vector3(ox, oy, oz),
            dir: vector3(dx, dy, dz),
            t_far,
            path: Path {
                beta: vector3(r, g, b),
                pdf,
                eta2,
                key: key.to_bits(),
                depth,
                sample: sample.to_bits(),
            },
            pixel: pixel.to_bits(),
        }
    }

    /// The rays of the packet that starts at a slot.
    #[inline]
    pub(super) fn rays(&self, first: usize) -> RayLanes<f32x8> {
        let places: [u32; LANES] = self.places[first..].first_chunk().copied().unwrap_or_default();
        let [ox, oy, oz, dx, dy, dz, t_far, _] = gather(&self.rays, &places);
        RayLanes::new(vector3(ox, oy, oz), vector3(dx, dy, dz), f32x8::zero(), t_far)
    }

    /// The place of a path's pixel.
    #[inline]
    pub(super) fn pixel(&self, slot: usize) -> usize {
        self.worth[self.places[slot] as usize].lane(5).to_bits() as usize
    }

    /// The paths at the places where `alive` says so are in flight, in order. It has whole packets.
    pub(super) fn keep(&mut self, alive: &[bool]) {
        // A packet is written whole, wherever it begins, and the last one is filled up.
        reserve(&mut self.places, alive.len() + LANES, 0);
        self.len = 0;
        let mut places = u32x8::from_fn(|i| i as u32);
        for alive in alive.as_chunks::<LANES>().0 {
            let lanes = bits(alive);
            let kept = compress(places, lanes);
            self.places[self.len..self.len + LANES].copy_from_slice(&kept.to_array());
            self.len += lanes.count_ones() as usize;
            places = places.wrapping_add(u32x8::splat(LANES as u32));
        }
        self.fill_up();
    }

    /// Slots behind the last name its place.
    fn fill_up(&mut self) {
        let last = self.len.checked_sub(1).map_or(0, |last| self.places[last]);
        self.places[self.len..self.len + LANES].fill(last);
    }

    /// Gives neighbouring slots to paths that point into the same octant, in order within each.
    pub(super) fn order_by_octant(&mut self) {
        let Self { rays, places, octants, before, len, .. } = self;
        before.clear();
        before.extend_from_slice(&places[..*len]);
        octants.sort(before.iter().map(|&place| &rays[place as usize]));
        for (place, &slot) in places[..*len].iter_mut().zip(octants.order()) {
            *place = before[slot as usize];
        }
        self.fill_up();
    }
}

/// Rays by the octant that they point into: packets of one octant meet less of a scene, and each box of it with
/// fewer operations.
pub(super) struct Octants<'a> {
    keys: BumpVec<'a, u32>,
    sorter: Sorter<'a>,
}

impl<'a> Octants<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self { keys: BumpVec::new_in(arena), sorter: Sorter::new(arena, 8) }
    }

    /// Orders rays. One is a row: origin, direction, and what else there is.
    pub(super) fn sort<'r>(&mut self, rays: impl Iterator<Item = &'r f32x8>) {
        let Self { keys, sorter } = self;
        keys.clear();
        keys.extend(rays.map(|row| row.lt(f32x8::zero()).to_bitmask() >> 3 & 7));
        sorter.sort(keys);
    }

    /// The numbers of the rays that were sorted last, by octant and within each as they came; a packet of the last of
    /// them, and perhaps more behind that.
    #[inline]
    pub(super) fn order(&self) -> &[u32] {
        self.sorter.order()
    }
}

/// Truth values as bits: the first is bit 0.
#[inline]
fn bits(values: &[bool; LANES]) -> u8 {
    // Each byte is moved to the bit of its number in the highest byte, and no two meet on the way.
    let bytes = u64::from_le_bytes(values.map(u8::from));
    (bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
}

/// What the paths have hit: t, u, v and the primitive, a row a slot.
pub(super) struct Hits<'a>(BumpVec<'a, [f32; 4]>);

impl<'a> Hits<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self(BumpVec::new_in(arena))
    }

    pub(super) fn resize(&mut self, len: usize) {
        reserve(&mut self.0, len, [0.0; 4]);
    }

    #[inline]
    pub(super) fn set(&mut self, slot: usize, hit: &Hit) {
        self.0[slot] = [hit.t, hit.u, hit.v, f32::from_bits(hit.primitive.0)];
    }

    /// (primitive, u).
    #[inline]
    pub(super) fn primitive(&self, slot: usize) -> (PrimitiveId, f32) {
        let [_, u, _, primitive] = self.0[slot];
        (PrimitiveId(primitive.to_bits()), u)
    }

    /// ((t, u, v), primitives) of some slots.
    #[inline]
    pub(super) fn packet<R: Real>(&self, slots: &[u32; MOST]) -> ((R, R, R), R::Bits) {
        let [t, u, v, primitive, ..] = R::from_rows(|i| {
            let [t, u, v, primitive] = self.0[slots[i] as usize];
            [t, u, v, primitive, 0.0, 0.0, 0.0, 0.0]
        });
        ((t, u, v), primitive.to_bits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{ONE_REGISTER, f32x16};

    /// Numbers that say whose they are.
    fn packet<R: Real>(from: u32) -> Packet<R> {
        let number = |k: u32| R::from_fn(|i| (100 * (from + i as u32) + k) as f32);
        let path = Path {
            beta: vector3(number(7), number(8), number(9)),
            pdf: number(10),
            eta2: number(11),
            key: R::Bits::from_fn(|i| 0xff80_0001 + from + i as u32),
            depth: 3,
            sample: R::Bits::from_fn(|i| 0x7fa0_0001 + from + i as u32),
        };
        Packet {
            org: vector3(number(0), number(1), number(2)),
            dir: vector3(number(3), number(4), number(5)),
            t_far: number(6),
            path,
            pixel: R::Bits::from_fn(|i| 0x7f80_0001 + from + i as u32),
        }
    }

    #[test]
    fn paths_come_back_from_where_they_were_put() {
        let arena = Bump::new();
        let mut paths = Paths::new(&arena);
        paths.reserve(21);
        let slots = [20, 3, 7, 0, 11, 12, 5, 1];
        let stored = packet::<f32x8>(1);
        paths.store(&slots, &stored);
        paths.store(&[2, 4], &packet::<f32x8>(50));
        paths.keep(&[true; 24]);
        let same = paths.packet::<f32x8>(&fill(&slots), 3);
        assert_eq!(format!("{:?}", same.path), format!("{:?}", stored.path));
        assert_eq!(same.org.lane(1), stored.org.lane(1));
        assert_eq!((same.dir.lane(7), same.t_far.lane(7)), (stored.dir.lane(7), 806.0));
        // Integers that are NaNs as floats keep their bits.
        assert_eq!((paths.pixel(20), paths.pixel(2)), (0x7f80_0002, 0x7f80_0033));
        let rays = paths.rays(0);
        assert_eq!(rays.org.lane(2), packet::<f32x8>(50).org.lane(0));
        assert_eq!(rays.t_far.lane(7), 306.0);
    }

    #[test]
    fn sixteen_paths_are_twice_eight() {
        if !ONE_REGISTER {
            return;
        }
        let arena = Bump::new();
        let mut paths = Paths::new(&arena);
        paths.reserve(24);
        let slots = [20, 3, 7, 0, 11, 12, 5, 1, 2, 4, 6, 8, 9, 23, 22, 21];
        // The last of sixteen stays out.
        paths.store(&slots[..15], &packet::<f32x16>(1));
        paths.keep(&[true; 24]);
        for half in [0, 8] {
            let eight = paths.packet::<f32x8>(&fill(&slots[half..15.min(half + 8)]), 3);
            let whole = paths.packet::<f32x16>(&fill(&slots[..15]), 3);
            for lane in 0..8 {
                let number = half + lane;
                assert_eq!(eight.org.lane(lane), whole.org.lane(number), "{number}");
                assert_eq!(eight.path.key.lane(lane), whole.path.key.lane(number), "{number}");
                let stored = packet::<f32x16>(1).path.beta.lane(number.min(14));
                assert_eq!(
                    [eight.path.beta.lane(lane), whole.path.beta.lane(number)],
                    [stored; 2],
                    "{number}"
                );
            }
        }
        assert_eq!(paths.pixel(21), 0, "nothing was put there");
    }

    #[test]
    fn paths_that_are_alive_move_up_in_order() {
        let arena = Bump::new();
        let mut paths = Paths::new(&arena);
        paths.reserve(20);
        for first in [0, 8] {
            paths.store(&std::array::from_fn::<u32, 8, _>(|i| first + i as u32), &packet::<f32x8>(first));
        }
        paths.store(&[16, 17, 18, 19], &packet::<f32x8>(16));
        let mut alive = [false; 24];
        for slot in [1, 6, 17, 19] {
            alive[slot] = true;
        }
        paths.keep(&alive);
        assert_eq!(paths.len, 4);
        let places: Vec<usize> = (0..4).map(|slot| paths.pixel(slot) - 0x7f80_0001).collect();
        assert_eq!(places, [1, 6, 17, 19]);
        // Lanes behind the last hold it, too.
        let org = [1.0, 6.0, 17.0, 19.0, 19.0, 19.0, 19.0, 19.0].map(|slot| 100.0 * slot);
        assert_eq!(paths.rays(0).org.x.to_array(), org);
        paths.keep(&[false; 24]);
        assert_eq!(paths.len, 0);
    }

    #[test]
    fn paths_are_ordered_by_octant_and_stay_in_order_within_each() {
        let arena = Bump::new();
        let mut paths = Paths::new(&arena);
        paths.reserve(24);
        let sign = |lane: usize, bit: usize| if (lane * 5 % 8) >> bit & 1 != 0 { -1.0 } else { 1.0 };
        for first in [0, 8, 16] {
            let dir = vector3(
                f32x8::from_fn(|i| sign(i, 0)),
                f32x8::from_fn(|i| sign(i, 1)),
                f32x8::from_fn(|i| sign(i, 2)),
            );
            let at = std::array::from_fn::<_, LANES, _>(|i| first + i as u32);
            paths.store(&at, &Packet { dir, pixel: u32x8::from_fn(|i| at[i]), ..packet::<f32x8>(0) });
        }
        let alive: Vec<bool> = (0..24).map(|slot| slot < 21 && slot % 7 != 2).collect();
        paths.keep(&alive);
        paths.order_by_octant();
        let found: Vec<usize> = (0..paths.len).map(|slot| paths.pixel(slot)).collect();
        let mut expected: Vec<usize> = (0..24).filter(|&slot| alive[slot]).collect();
        expected.sort_by_key(|slot| slot % 8 * 5 % 8);
        assert_eq!(found, expected);
        // Lanes behind the last hold it, too.
        let last = paths.rays(paths.len.next_multiple_of(LANES) - LANES);
        assert_eq!(last.dir.lane(7), last.dir.lane((paths.len - 1) % LANES));
    }

    #[test]
    fn truth_values_are_bits_in_order() {
        for expected in 0..=u8::MAX {
            assert_eq!(bits(&std::array::from_fn(|i| expected >> i & 1 != 0)), expected);
        }
    }

    #[test]
    fn hits_are_read_as_they_were_set() {
        let arena = Bump::new();
        let mut hits = Hits::new(&arena);
        hits.resize(9);
        let hit = |slot: usize| Hit { t: slot as f32, u: 0.25, v: 0.5, primitive: PrimitiveId(slot as u32) };
        (0..9).for_each(|slot| hits.set(slot, &hit(slot)));
        hits.set(4, &Hit::MISS);
        assert_eq!((hits.primitive(8), hits.primitive(4).0), ((PrimitiveId(8), 0.25), PrimitiveId::NONE));
        let ((t, u, v), primitive) = hits.packet::<f32x8>(&fill(&[2, 8, 4]));
        assert_eq!((t.lane(1), u.lane(0), v.lane(7)), (8.0, 0.25, Hit::MISS.v));
        assert_eq!((primitive.lane(1), primitive.lane(2)), (8, PrimitiveId::NONE.0));
    }
}
