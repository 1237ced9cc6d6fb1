//! What must not change where two directions are exchanged, or turned together about the normal.

use glam::{Quat, Vec3};

use super::{Random, Reflector};
use crate::simd::{Mask, Real, Vector3};

/// Differences are relative to the greater of both values, and to this where both are small, per steradian.
const DIM: f32 = 1e-3;
/// Nearer to the horizon than this, a cosine has no digits left to divide by.
const LOWEST: f32 = 1e-3;
/// Degrees by which pairs are turned.
const TURNS: [f32; 7] = [1.0, 3.0, 10.0, 30.0, 45.0, 60.0, 90.0];

/// The greatest relative difference found, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// Of the greater value.
    pub difference: f32,
    /// One direction.
    pub a: Vec3,
    /// The other.
    pub b: Vec3,
    /// Pairs that reflect more than next to nothing.
    pub lit: u64,
    /// Those of them whose values differ by more than the tolerance. Rounding makes a few: near total
    /// reflection and in the tails of narrow lobes, single precision keeps two digits.
    pub broken: u64,
}

impl Worst {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let worse = if other.difference > self.difference { other } else { self };
        Self { lit: self.lit + other.lit, broken: self.broken + other.broken, ..worse }
    }
}

/// The greatest difference of f(a, b) and f(b, a), over random pairs; through a surface, of f over the
/// square of the index on the viewer's side, since that is what radiance is proportional to.
pub fn reciprocity<R: Real>(model: &impl Reflector<R>, pairs: usize, tolerance: f32, seed: u64) -> Worst {
    let mut random = Random::new(seed);
    let eta = index_below(model);
    let both = model.transmits();
    let mut worst = Worst::default();
    for _ in 0..pairs / R::LANES {
        let (a, b) = (directions::<R>(&mut random, both), directions::<R>(&mut random, both));
        let f = |wo: Vector3<R>, wi: Vector3<R>| {
            let n2 = R::select(wo.z.gt(R::zero()), R::one(), eta * eta);
            model.eval_pdf(wo, wi).0.scale(R::one() / (wi.z.abs() * n2))
        };
        worst = worst.or((f(a, b), f(b, a)), (a, b), tolerance);
    }
    worst
}

/// n(below)/n(above), as samples tell it.
fn index_below<R: Real>(model: &impl Reflector<R>) -> R {
    let mut random = Random::new(1);
    let mut eta = 1.0;
    for _ in 0..64 {
        let [lobe, u, v] = random.triple();
        let sample = model.sample(Vector3::splat(super::at(20.0)), lobe, (u, v));
        let valid = sample.valid.to_bitmask();
        if let Some(i) = (0..R::LANES).find(|i| valid >> i & 1 != 0 && sample.eta.lane(*i) != 1.0) {
            eta = sample.eta.lane(i);
        }
    }
    R::splat(eta)
}

/// How f changes where both directions turn about the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// Degrees of the turn.
    pub degrees: f32,
    /// The greatest relative difference.
    pub difference: f32,
}

/// The least of some turns that changes f by more than `tolerance`; `None` if the model is isotropic.
pub fn isotropy<R: Real>(
    model: &impl Reflector<R>,
    pairs: usize,
    tolerance: f32,
    seed: u64,
) -> Option<Turned> {
    TURNS.into_iter().find_map(|degrees| {
        let mut random = Random::new(seed);
        let turn = Quat::from_rotation_z(degrees.to_radians());
        let turned = |w: Vector3<R>| Vector3::<R>::from_fn(|i| turn * w.lane(i));
        let mut worst = Worst::default();
        for _ in 0..pairs / R::LANES {
            let (a, b) = (directions::<R>(&mut random, false), directions::<R>(&mut random, false));
            let f = |wo: Vector3<R>, wi: Vector3<R>| model.eval_pdf(wo, wi).0.scale(R::one() / wi.z);
            worst = worst.or((f(a, b), f(turned(a), turned(b))), (a, b), tolerance);
        }
        let difference = worst.difference;
        (difference > tolerance).then_some(Turned { degrees, difference })
    })
}

fn directions<R: Real>(random: &mut Random, both: bool) -> Vector3<R> {
    Vector3::from_fn(|_| {
        loop {
            let w = random.direction(both);
            if w.z.abs() > LOWEST {
                return w;
            }
        }
    })
}

impl Worst {
    /// The worse of this and of as many more pairs as there are lanes.
    fn or<R: Real>(
        mut self,
        (there, back): (Vector3<R>, Vector3<R>),
        (a, b): (Vector3<R>, Vector3<R>),
        tolerance: f32,
    ) -> Self {
        let most = there.max_element().max(back.max_element());
        let lit = most.gt(R::splat(DIM));
        let difference = (there - back).map(R::abs).max_element() / most.max(R::splat(DIM));
        // What is no number is worse than any.
        let difference = R::select(difference.lt(R::splat(f32::MAX)), difference, R::splat(f32::MAX));
        self.lit += u64::from(lit.count());
        self.broken += u64::from((lit & difference.gt(R::splat(tolerance))).count());
        if difference.gt(R::splat(self.difference)).any() {
            for i in 0..R::LANES {
                if difference.lane(i) > self.difference {
                    self = Self { difference: difference.lane(i), a: a.lane(i), b: b.lane(i), ..self };
                }
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Sample;
    use crate::math::INV_PI;
    use crate::simd::f32x8;

    /// Diffuse, times a power of the viewer's cosine.
    struct Leaning(bool);

    impl Reflector<f32x8> for Leaning {
        fn eval_pdf(&self, wo: Vector3<f32x8>, wi: Vector3<f32x8>) -> (Vector3<f32x8>, f32x8) {
            let pdf = wi.z * f32x8::splat(INV_PI);
            let value = if self.0 { pdf * wo.z } else { pdf };
            (wi.map(|_| value), pdf)
        }

        fn sample(&self, wo: Vector3<f32x8>, _: f32x8, _: (f32x8, f32x8)) -> Sample<f32x8> {
            let (one, none) = (f32x8::one(), Mask::splat(false));
            Sample { wi: wo, weight: wo, pdf: one, eta: one, delta: none, valid: none }
        }

        fn transmits(&self) -> bool {
            false
        }
    }

    #[test]
    fn every_pair_is_looked_at() {
        let fair = reciprocity(&Leaning(false), 4000, 1e-4, 3);
        assert_eq!((fair.lit, fair.broken), (4000, 0), "{fair:?}");
        assert!(fair.difference < 1e-5, "{fair:?}");
        // cos θ_o and cos θ_i are rarely the same; their relative difference is nearly 1 somewhere.
        let leaning = reciprocity(&Leaning(true), 4000, 1e-4, 3);
        assert!(leaning.lit > 3900 && leaning.broken > 3900, "{leaning:?}");
        assert!(leaning.difference > 0.9 && leaning.difference <= 1.0, "{leaning:?}");
        assert!(leaning.a.z != leaning.b.z);
    }
}
