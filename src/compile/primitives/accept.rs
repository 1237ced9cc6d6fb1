//! Which of two hits stays.

use crate::bvh::HitLanes;
use crate::geometry::{Hit, PrimitiveId};
use crate::simd::{Bits, Groups, Mask, Real};

/// Records hits, where they are closer or tie with a higher id: of a packet with one primitive, or of one
/// ray with several.
#[inline]
pub(in crate::compile) fn accept<const ANY: bool, R: Real>(
    hit: &mut HitLanes<R>,
    found: R::Mask,
    (t, u, v): (R, R, R),
    id: impl FnOnce() -> R::Bits,
) {
    if ANY {
        hit.t = R::select(found, R::splat(f32::NEG_INFINITY), hit.t);
        return;
    }
    let id = id();
    let mut closer = found & t.lt(hit.t);
    let tie = found & t.equal(hit.t);
    if tie.any() {
        let lower = |i: usize| u32::from(id.lane(i) < hit.primitive.lane(i)) << i;
        closer = closer | (tie & R::Mask::from_bitmask((0..R::LANES).map(lower).sum()));
    }
    hit.t = R::select(closer, t, hit.t);
    hit.u = R::select(closer, u, hit.u);
    hit.v = R::select(closer, v, hit.v);
    hit.primitive = R::Bits::select(closer, id, hit.primitive);
}

/// Records a ray's hit in the same way.
#[inline]
pub(in crate::compile) fn accept_single<const ANY: bool>(hit: &mut Hit, (t, u, v): (f32, f32, f32), id: u32) {
    let found = Hit { t, u, v, primitive: PrimitiveId(id) };
    if ANY {
        hit.t = f32::NEG_INFINITY;
    } else if found.closer_than(hit) {
        *hit = found;
    }
}

/// Records the nearest hits of rays that each have a group of lanes, none of which lies beyond its ray's `t_far`. False, and nothing has
/// been done, where numbers would have to decide between equal ones.
// Without a branch on who has hit what: a ray that finds something finds it among several as often as not.
#[inline(always)]
pub(in crate::compile) fn accept_nearest<const N: usize, R: Groups<N>>(
    hits: [&mut Hit; N],
    (found, t, u, v): (R::Mask, R, R, R),
    t_far: R,
    ids: R,
) -> bool {
    let nothing = R::splat(f32::INFINITY);
    let distances = R::select(found, t, nothing);
    let least = distances.fold(R::min);
    let nearest = distances.equal(least) & found;
    let hit = least.lt(nothing);
    let several = nearest.count() * R::WIDTH as u32 != hit.count();
    if (found & t.equal(t_far)).any() | several {
        return false;
    }
    let rows = R::side_by_side([least, u.shared(nearest), v.shared(nearest), ids.shared(nearest)]);
    let before = R::of_fours(hits.each_ref().map(|hit| hit.to_row()));
    let rows = R::select(hit, rows, before).fours();
    for (hit, row) in hits.into_iter().zip(rows) {
        *hit = Hit::of_row(row);
    }
    true
}
