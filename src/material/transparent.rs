//! Nothing: light goes straight through, as where a mask is open.

use super::{Branch, Sample};
use crate::simd::{Mask, Real, Vector3, vector3};

/// The delta direction −wo.
#[inline]
pub(super) fn pass<R: Real>(wo: Vector3<R>) -> Branch<R> {
    let one = R::one();
    Branch { wi: -wo, weight: vector3(one, one, one), valid: R::Mask::splat(true) }
}

/// The delta direction, always.
#[inline]
pub(super) fn sample<R: Real>(wo: Vector3<R>) -> Sample<R> {
    let Branch { wi, weight, valid } = pass(wo);
    Sample { wi, weight, pdf: R::one(), eta: R::one(), delta: R::Mask::splat(true), valid }
}
