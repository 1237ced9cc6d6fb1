//! How much light a coat lets through, smooth or rough: tables made once a material.

use super::{
    fresnel,
    microfacet::{Distribution, Microfacet},
    rough_conductor::reflect,
    rough_dielectric::refract,
};
use crate::simd::{Bits, LANES, Real, f32x8, vector3};

/// Cosines of the table, from 0 to 1.
const COSINES: usize = 64;
/// Points of the golden lattice that stand for random numbers.
const POINTS: usize = 4096;
/// 1 over the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The transmittance of a rough dielectric coat.
#[derive(Clone, Debug, PartialEq)]
pub struct Coat {
    transmittance: [f32; COSINES],
    /// Reflectance for diffuse light from below.
    pub internal: f32,
}

impl Coat {
    /// The coat of microfacets with roughness `alpha` and `eta` = n_int/n_ext.
    pub fn new(distribution: Distribution, alpha: f32, eta: f32) -> Self {
        let cos = |i: usize| i as f32 / (COSINES - 1) as f32;
        let scattered = |i: usize, eta: f32| scattered(distribution, alpha, eta, cos(i).max(1e-6));
        // The mean over the table's cosines is what Mitsuba's `roughplastic` means by it.
        let below: f32 = (0..COSINES).map(|i| scattered(i, 1.0 / eta).0 * cos(i)).sum();
        Self {
            transmittance: std::array::from_fn(|i| scattered(i, eta).1),
            internal: 2.0 * below / COSINES as f32,
        }
    }

    /// T at a cosine in [0, 1], linear between the table's.
    #[inline]
    pub fn transmittance<R: Real>(&self, cos: R) -> R {
        let x = cos.clamp(0.0, 1.0) * R::splat((COSINES - 1) as f32);
        let cell = x.floor().min(R::splat((COSINES - 2) as f32));
        let (place, t) = (cell.to_int(), x - cell);
        let low = R::from_fn(|i| self.transmittance[place.lane(i) as usize % COSINES]);
        let high = R::from_fn(|i| self.transmittance[(place.lane(i) as usize + 1) % COSINES]);
        low + (high - low) * t
    }
}

/// The coats of a material: one, or several over α where that is a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct CoatRange(Vec<Coat>);

/// Roughnesses of a range, at the squares of equal steps from 0 to 1: coats change fastest when smooth.
const RANGE: usize = 17;

impl From<Coat> for CoatRange {
    /// The same roughness everywhere.
    fn from(coat: Coat) -> Self {
        Self(vec![coat])
    }
}

impl CoatRange {
    /// For α in [0, 1]; rougher ones are as the roughest.
    pub fn of_any_roughness(distribution: Distribution, eta: f32) -> Self {
        let root = |i: usize| i as f32 / (RANGE - 1) as f32;
        Self((0..RANGE).map(|i| Coat::new(distribution, (root(i) * root(i)).max(1e-4), eta)).collect())
    }

    /// The coats of each lane's α.
    #[inline]
    pub fn at<R: Real>(&self, alpha: R) -> CoatAt<'_, R> {
        let place = match &self.0[..] {
            [_] => R::zero(),
            coats => alpha.clamp(0.0, 1.0).sqrt() * R::splat((coats.len() - 1) as f32),
        };
        CoatAt { coats: &self.0, place }
    }
}

/// The coat of each lane, linear between those of a range.
#[derive(Clone, Copy, Debug)]
pub struct CoatAt<'t, R> {
    coats: &'t [Coat],
    place: R,
}

impl<R: Real> CoatAt<'_, R> {
    /// T at a cosine in [0, 1].
    #[inline]
    pub fn transmittance(&self, cos: R) -> R {
        match self.coats {
            [coat] => coat.transmittance(cos),
            coats => self.between(coats, |coat, i| coat.transmittance(cos.lane(i))),
        }
    }

    /// Reflectance for diffuse light from below.
    #[inline]
    pub fn internal(&self) -> R {
        match self.coats {
            [coat] => R::splat(coat.internal),
            coats => self.between(coats, |coat, _| coat.internal),
        }
    }

    #[inline]
    fn between(&self, coats: &[Coat], value: impl Fn(&Coat, usize) -> f32) -> R {
        R::from_fn(|i| {
            let place = self.place.lane(i);
            let cell = (place as usize).min(coats.len() - 2);
            let (low, high) = (value(&coats[cell], i), value(&coats[cell + 1], i));
            low + (high - low) * (place - cell as f32)
        })
    }
}

/// What single scattering reflects and what it lets through: visible normals, weighted by F G1(wi) and by
/// (1 − F) G1(wi). What is left of 1 is masked.
fn scattered(distribution: Distribution, alpha: f32, eta: f32, cos: f32) -> (f32, f32) {
    let (splat, zero) = (f32x8::splat, f32x8::zero());
    let surface = Microfacet::new(distribution, splat(alpha), splat(alpha));
    let wo = vector3(splat((1.0 - cos * cos).max(0.0).sqrt()), zero, splat(cos));
    let lattice = |i: usize| ((i as f32 + 0.5) / POINTS as f32, (i as f64 * GOLDEN).fract() as f32);
    let mut sums = (zero, zero);
    for first in (0..POINTS).step_by(LANES) {
        let u = (f32x8::from_fn(|i| lattice(first + i).0), f32x8::from_fn(|i| lattice(first + i).1));
        let m = surface.sample_visible(wo, u);
        let (reflectance, refracted, _) = refract(wo, m, splat(eta));
        let reflected = reflect(wo, m);
        let back = reflectance * surface.g1(reflected, m);
        sums.0 = sums.0 + back.only(reflected.z.gt(zero));
        let through = (f32x8::one() - reflectance) * surface.g1(refracted, m);
        sums.1 = sums.1 + through.only(refracted.z.lt(zero) & reflectance.lt(f32x8::one()));
    }
    let mean = |sum: f32x8| (0..LANES).map(|i| sum.lane(i)).sum::<f32>() / POINTS as f32;
    (mean(sums.0), mean(sums.1))
}

/// Reflectance for diffuse light of a smooth interface, 2 ∫ F(cos θ) cos θ d(cos θ), seen from the side
/// whose relative index to the other is `eta`.
pub fn diffuse_reflectance(eta: f32) -> f32 {
    let steps = 4096;
    let cos = |i: u32| (i as f32 + 0.5) / steps as f32;
    let terms = (0..steps).map(|i| f64::from(fresnel::dielectric(cos(i), eta).0 * cos(i)));
    (2.0 * terms.sum::<f64>() / f64::from(steps)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diffuse_light_in_glass_is_mostly_kept() {
        // Quadrature in double precision; the reciprocal relation 1 − F_dr(1/η) = (1 − F_dr(η))/η².
        for eta in [1.1f32, 1.33, 1.5, 2.0] {
            let (outside, inside) = (diffuse_reflectance(eta), diffuse_reflectance(1.0 / eta));
            assert!((1.0 - inside - (1.0 - outside) / (eta * eta)).abs() < 2e-4, "{eta}: {outside} {inside}");
        }
        assert!((diffuse_reflectance(1.5) - 0.0918).abs() < 2e-4, "{}", diffuse_reflectance(1.5));
        assert!((diffuse_reflectance(1.0 / 1.5) - 0.5964).abs() < 3e-4);
    }

    #[test]
    fn a_rough_coat_has_its_quadrature() {
        // 256² points in double precision, by another map of the square.
        let coat = Coat::new(Distribution::Ggx, 0.2, 1.49);
        for (degrees, want) in [(0.0f32, 0.958_302), (50.0, 0.930_963), (75.0, 0.800_048), (82.0, 0.731_241)]
        {
            let got = coat.transmittance(degrees.to_radians().cos());
            assert!((got - want).abs() < 1.5e-3, "{degrees}: {got}");
        }
        assert!((coat.internal - 0.480_16).abs() < 1e-3, "{}", coat.internal);
    }

    #[test]
    fn a_smooth_coat_lets_through_what_fresnel_says() {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            let coat = Coat::new(distribution, 1e-4, 1.5);
            for cos in [1.0f32, 0.9, 0.5, 0.25] {
                let want = 1.0 - fresnel::dielectric(cos, 1.5).0;
                assert!((coat.transmittance(cos) - want).abs() < 2e-3, "{distribution:?} {cos}");
            }
        }
    }

    #[test]
    fn lanes_equal_scalar_and_ends_are_in_range() {
        let coat = Coat::new(Distribution::Ggx, 0.3, 1.5);
        for i in 0..=1000 {
            let cos = i as f32 / 1000.0;
            let lanes = f32x8::from_fn(|k| if k == 2 { cos } else { 1.0 });
            let t = coat.transmittance(cos);
            assert_eq!(coat.transmittance(lanes).lane(2).to_bits(), t.to_bits());
            assert!((0.0..=1.0).contains(&t), "{cos}: {t}");
        }
        assert_eq!(coat.transmittance(1.5f32), coat.transmittance(1.0f32));
        assert_eq!(coat.transmittance(-0.5f32), coat.transmittance(0.0f32));
    }
}
