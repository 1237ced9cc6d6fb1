//! Which of many lights is sampled at a point.
//!
//! A few lights are weighed by the irradiance that each would bring if it shone from its middle in all
//! directions alike, E ≈ Φ/(4π d²), d not below the light's radius; what comes from infinity brings the
//! same everywhere. Many lights are chosen by power alone. Either is only half of the choice, the other
//! half is uniform: a light that the estimate overlooks is never forgotten, and the variance is at most
//! twice that of a uniform choice. The estimate knows the point and no normal, since light that is found
//! by chance must be weighed from the other end.

use glam::Vec3;

use super::distribution::{find, push_sums};
use crate::simd::{Bits, Real, Vector3};

/// Up to so many lights are weighed at each point.
const FEW: usize = 16;
/// Estimates stay below this, so that their sum is finite.
const MOST: f32 = 1e30;

/// What is known of a light from afar.
#[derive(Clone, Copy, Debug, Default)]
pub struct Glimpse {
    /// Irradiance that does not depend on the place, W/m².
    pub steady: f32,
    /// Radiant intensity, W/sr.
    pub intensity: f32,
    /// From here; world space.
    pub middle: Vec3,
    /// Of a ball that holds the light; world units.
    pub radius: f32,
}

impl Glimpse {
    #[inline]
    fn irradiance<R: Real>(&self, at: Vector3<R>) -> R {
        let to = Vector3::splat(self.middle) - at;
        let squared = to.dot(to).max(R::splat(self.radius * self.radius));
        let falling = R::splat(self.intensity) / squared;
        let falling = R::select(squared.gt(R::zero()), falling, R::splat(MOST));
        (R::splat(self.steady) + falling).min(R::splat(MOST))
    }
}

/// Lights, and the probability of each.
#[derive(Clone, Debug, Default)]
pub struct LightChoice {
    lights: Vec<Glimpse>,
    /// Running sums by power, where there are many.
    sums: Vec<f32>,
}

impl LightChoice {
    /// The glimpse and the power of each light; powers in any unit, finite, not negative.
    pub fn new(lights: Vec<Glimpse>, powers: &[f32]) -> Self {
        let (total, count) = (powers.iter().map(|&power| f64::from(power)).sum::<f64>(), powers.len() as f64);
        let share = |&power: &f32| {
            let by_power = if total > 0.0 { f64::from(power) / total } else { 1.0 / count };
            0.5 * by_power + 0.5 / count
        };
        let mut sums = Vec::new();
        if lights.len() > FEW {
            push_sums(&powers.iter().map(share).collect::<Vec<_>>(), &mut sums);
        }
        Self { lights, sums }
    }

    /// Probability = uniform + factor · estimate.
    #[inline]
    fn shares<R: Real>(&self, at: Vector3<R>) -> (R, R) {
        let total = self.lights.iter().fold(R::zero(), |sum, light| sum + light.irradiance(at));
        let (equal, dark) = (R::splat(0.5 / self.lights.len() as f32), total.le(R::zero()));
        (R::select(dark, equal + equal, equal), (R::splat(0.5) / total).only(!dark))
    }

    /// The probability with which a light is chosen at a point.
    #[inline]
    pub fn probability<R: Real>(&self, light: usize, at: Vector3<R>) -> R {
        match self.lights.len() {
            1 => R::one(),
            few if few <= FEW => {
                let (equal, factor) = self.shares(at);
                equal + factor * self.lights[light].irradiance(at)
            }
            _ => R::splat(self.sums[light + 1] - self.sums[light]),
        }
    }

    /// The light that `u` chooses at a point, and what is left of `u`: a new uniform number. There must be
    /// a light.
    #[inline]
    pub fn choose<R: Real>(&self, u: R, at: Vector3<R>) -> (R::Bits, R) {
        let count = self.lights.len();
        if count == 1 {
            return (R::Bits::splat(0), u);
        }
        if count > FEW {
            return find(&self.sums, R::Bits::splat(0), count, u);
        }
        let (equal, factor) = self.shares(at);
        let (mut chosen, mut rest, mut below) = (R::Bits::splat(0), R::zero(), R::zero());
        for (i, light) in self.lights.iter().enumerate() {
            let probability = equal + factor * light.irradiance(at);
            // The last that begins at or below u: rounding of the sum leaves no gap at its end.
            let begun = below.le(u);
            chosen = R::Bits::select(begun, R::Bits::splat(i as u32), chosen);
            rest = R::select(begun, (u - below) / probability, rest);
            below = below + probability;
        }
        (chosen, rest.clamp(0.0, 1.0 - f32::EPSILON / 2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn lamp(x: f32, intensity: f32) -> Glimpse {
        Glimpse { intensity, middle: Vec3::new(x, 0.0, 0.0), radius: 0.1, ..Glimpse::default() }
    }

    fn at(x: f32) -> Vector3<f32> {
        Vec3::new(x, 0.0, 0.0).into()
    }

    #[test]
    fn half_of_a_choice_is_uniform() {
        let powers = [0.0, 3.0, 1.0, 0.0];
        // Three quarters and a quarter of the irradiance at 0.
        let choice = LightChoice::new(powers.iter().map(|&p| lamp(2.0, p)).collect(), &powers);
        let share: Vec<f32> = (0..4).map(|i| choice.probability(i, at(0.0))).collect();
        assert_eq!(share, [0.125, 0.5, 0.25, 0.125]);
        assert_eq!(choice.choose(0.375, at(0.0)), (1, 0.5));
        let dark = LightChoice::new(vec![lamp(0.0, 0.0); 2], &[0.0, 0.0]);
        assert_eq!(dark.probability(1, at(0.0)), 0.5);
    }

    #[test]
    fn what_is_near_is_chosen_more() {
        let choice = LightChoice::new(vec![lamp(0.0, 1.0), lamp(10.0, 50.0)], &[1.0, 50.0]);
        assert!(choice.probability(0, at(0.5)) > 0.68 && choice.probability(1, at(8.0)) > 0.74);
        // At the very middle of a lamp without size the estimate has no end, and the choice still has.
        let point = Glimpse { radius: 0.0, ..lamp(0.0, 1.0) };
        let choice = LightChoice::new(vec![point, lamp(1.0, 1.0)], &[1.0, 1.0]);
        let sum = choice.probability(0, at(0.0)) + choice.probability(1, at(0.0));
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn lights_are_chosen_with_their_probability_in_lanes_and_alone() {
        for count in [1, 2, 5, FEW, FEW + 1, 100] {
            let powers: Vec<f32> = (0..count).map(|i| (i % 7) as f32).collect();
            let lights = powers.iter().enumerate().map(|(i, &p)| lamp(i as f32, p)).collect();
            let choice = LightChoice::new(lights, &powers);
            let (n, place) = (1 << 14, at(3.3));
            let mut seen = vec![0; count];
            for i in 0..n / 8 {
                let u = f32x8::from_fn(|k| ((i * 8 + k) as f32 + 0.5) / n as f32);
                let (chosen, rest) = choice.choose(u, Vector3::splat(place.into()));
                for k in 0..8 {
                    let one = choice.choose(u.lane(k), place);
                    assert_eq!((chosen.lane(k), rest.lane(k).to_bits()), (one.0, one.1.to_bits()));
                    seen[one.0 as usize] += 1;
                }
            }
            for (light, &seen) in seen.iter().enumerate() {
                let expected = choice.probability(light, place) * n as f32;
                assert!((seen as f32 - expected).abs() <= 2.0, "{light} of {count}: {seen}, not {expected}");
            }
        }
    }
}
