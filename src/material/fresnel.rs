//! Fresnel's equations for unpolarised light.

use crate::simd::{Real, Vector3};

/// Reflectance of a dielectric interface, and the refracted cosine.
///
/// `cos_i` is the signed cosine of the incident direction, `eta` = n_int/n_ext; the interior is on the
/// side of negative cosines. With η the relative index of the far side,
///
/// ```text
/// cos²θ_t = 1 − (1 − cos²θ_i)/η²        total internal reflection where that is negative
/// r_s = (cos θ_i − η cos θ_t)/(cos θ_i + η cos θ_t)     r_p = (η cos θ_i − cos θ_t)/(η cos θ_i + cos θ_t)
/// F = (r_s² + r_p²)/2
/// ```
///
/// Returns (F, cos θ_t, η): cos θ_t ≥ 0, and 0 under total internal reflection.
#[inline]
pub fn dielectric<R: Real>(cos_i: R, eta: R) -> (R, R, R) {
    let outside = cos_i.ge(R::zero());
    let eta = R::select(outside, eta, R::one() / eta);
    let cos_i = cos_i.abs();
    let cos2_t = R::one() - (R::one() - cos_i * cos_i) / (eta * eta);
    let total = cos2_t.le(R::zero());
    let cos_t = cos2_t.max(R::zero()).sqrt();
    let rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let reflectance = R::splat(0.5) * (rs * rs + rp * rp);
    // An index-matched interface at grazing incidence is 0/0.
    let matched = eta.equal(R::one());
    let reflectance = R::select(total & !matched, R::one(), R::select(matched, R::zero(), reflectance));
    (reflectance, cos_t, eta)
}

/// Reflectance of a conductor with index of refraction η + ik, seen from vacuum; `cos_i` ≥ 0.
///
/// ```text
/// a² + b² = √((η² − k² − sin²θ)² + 4η²k²)      a = √((a² + b² + η² − k² − sin²θ)/2)
/// R_s = (a² + b² + cos²θ − 2a cos θ)/(a² + b² + cos²θ + 2a cos θ)
/// R_p = R_s (cos²θ (a² + b²) + sin⁴θ − 2a cos θ sin²θ)/(cos²θ (a² + b²) + sin⁴θ + 2a cos θ sin²θ)
/// F = (R_s + R_p)/2
/// ```
#[inline]
pub fn conductor<R: Real>(cos_i: R, eta: R, k: R) -> R {
    let two = R::splat(2.0);
    let cos2 = cos_i * cos_i;
    let sin2 = R::one() - cos2;
    let base = eta * eta - k * k - sin2;
    let a2b2 = (base * base + R::splat(4.0) * eta * eta * k * k).sqrt();
    let a = (R::splat(0.5) * (a2b2 + base)).max(R::zero()).sqrt();
    let (sum, product) = (a2b2 + cos2, two * a * cos_i);
    let rs = (sum - product) / (sum + product);
    let (sum, product) = (cos2 * a2b2 + sin2 * sin2, product * sin2);
    let ratio = (sum - product) / (sum + product);
    // k = 0 and grazing: 0/0 in the limit of total reflection.
    let rp = R::select(sum.gt(R::zero()), rs * ratio, rs);
    R::splat(0.5) * (rs + rp)
}

/// [`conductor`], channel by channel.
#[inline]
pub fn conductor_rgb<R: Real>(cos_i: R, eta: Vector3<R>, k: Vector3<R>) -> Vector3<R> {
    Vector3 {
        x: conductor(cos_i, eta.x, k.x),
        y: conductor(cos_i, eta.y, k.y),
        z: conductor(cos_i, eta.z, k.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_has_its_textbook_reflectances() {
        for (degrees, want) in [(0.0f64, 0.04), (45.0, 0.050_240), (60.0, 0.089_187), (80.0, 0.387_704)] {
            let (got, _, eta) = dielectric(degrees.to_radians().cos() as f32, 1.5f32);
            assert!((f64::from(got) - want).abs() < 2e-6, "{degrees}: {got}");
            assert_eq!(eta, 1.5);
        }
    }

    #[test]
    fn brewster_and_critical_angles() {
        // At Brewster's angle only s-polarised light is left: F = r_s²/2.
        let cos = 56.3099f64.to_radians().cos();
        let rs = ((1.0 - 1.5f64.powi(2)) / (1.0 + 1.5f64.powi(2))).powi(2);
        assert!((f64::from(dielectric(cos as f32, 1.5f32).0) - rs / 2.0).abs() < 1e-6);
        let inside = |degrees: f64| dielectric(-(degrees.to_radians().cos() as f32), 1.5f32);
        assert!(inside(41.80).0 < 1.0 && inside(41.80).1 > 0.0);
        assert_eq!((inside(41.82).0, inside(41.82).1), (1.0, 0.0));
    }

    #[test]
    fn an_index_matched_interface_is_not_there() {
        for cos in [1.0f32, 0.3, 0.0, -0.0, -0.5] {
            assert_eq!(dielectric(cos, 1.0).0, 0.0, "{cos}");
        }
    }

    #[test]
    fn aluminium_at_normal_incidence() {
        assert!((conductor(1.0f32, 0.96, 6.69) - 0.92098).abs() < 1e-5);
        // η = 0, k = 1: a perfect mirror from every direction.
        for cos in [0.0f32, 0.1, 0.7, 1.0] {
            assert!((conductor(cos, 0.0, 1.0) - 1.0).abs() < 1e-6, "{cos}");
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cos in [0.05f32, 0.3, 0.8, 1.0] {
            assert!((conductor(cos, 1.5, 0.0) - dielectric(cos, 1.5).0).abs() < 1e-6, "{cos}");
        }
    }
}
