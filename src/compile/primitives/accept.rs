//! Which of two hits stays.

use crate::bvh::HitLanes;
use crate::geometry::{Hit, PrimitiveId};
use crate::simd::{Bits, Mask, Real};

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
