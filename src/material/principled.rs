//! The principled model \[Bur12\] \[Bur15\], with Mitsuba's parameters and their meaning.
//!
//! Five lobes of one surface, blended by m (`metallic`) and t (`spec_trans`):
//!
//! ```text
//! f = F_p D G/(4 cos cos)                            main reflection, GGX
//!   + (1 − m) t √c (1 − F) D G …                     main refraction, as of rough glass
//!   + ¼ clearcoat F_c D_GTR1 G_c                     clear coat
//!   + (1 − m)(1 − t) c/π lerp(f_d + f_retro, f_ss, flatness)
//!   + (1 − m) sheen F_h lerp(1, c/lum c, sheen_tint)
//! ```
//!
//! F_p blends the dielectric's F, Schlick's approximation from the base colour c for metal, and from a
//! tint of it. α = roughness², divided and multiplied by √(1 − 0.9 anisotropic). From below there is main
//! reflection and refraction only, and those only where t > 0.

use super::{
    Sample, clearcoat, fresnel,
    microfacet::{Distribution, Microfacet},
    rough_conductor::reflect,
    rough_dielectric::{Half, refract, upward},
};
use crate::math::{INV_PI, warp};
use crate::simd::{Real, Vector3, vector3};

/// Parameters in [0, 1], but for η.
#[derive(Clone, Copy, Debug)]
pub struct Principled<R> {
    /// c.
    pub base_color: Vector3<R>,
    /// √α of the main lobe.
    pub roughness: R,
    /// Stretches the main lobe along the first tangent.
    pub anisotropic: R,
    /// m.
    pub metallic: R,
    /// t.
    pub spec_trans: R,
    /// n_int/n_ext.
    pub eta: R,
    /// Tints the dielectric's reflection.
    pub spec_tint: R,
    /// Light at grazing angles, as of cloth.
    pub sheen: R,
    /// Tints it.
    pub sheen_tint: R,
    /// Towards the look of subsurface scattering.
    pub flatness: R,
    /// The second reflection.
    pub clearcoat: R,
    /// Its smoothness.
    pub clearcoat_gloss: R,
}

impl<R: Real> Principled<R> {
    /// f |cos θ_i|.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let (zero, one) = (R::zero(), R::one());
        let h = Half::new(wo, wi, self.eta);
        let front = wo.z.gt(zero);
        let (dielectric, ..) = fresnel::dielectric(h.wo_m, self.eta);
        let surface = self.surface();
        let shape = surface.d(h.m) * surface.g(wo, wi, h.m) / wo.z.abs();

        let fresnel =
            Vector3::select(front, self.fresnel(dielectric, h.wo_m), splat(self.refracting() * dielectric));
        let reflected = fresnel.scale(shape * R::splat(0.25)).only(h.reflects & h.possible);

        let through = (one - dielectric) * shape * (h.wo_m * h.wi_m).abs() / h.denominator;
        let tint = self.base_color.map(R::sqrt);
        let refracted = tint.scale(self.refracting() * through).only(!h.reflects & h.possible);

        let coat = self.clearcoat * clearcoat::eval(wo, wi, h.m, self.eta, self.clearcoat_gloss);
        let coat = splat(coat.only(h.reflects & h.possible & front));
        let diffuse = self.diffuse(wo, wi, h.wi_m).only(h.reflects & front);
        reflected + refracted + coat + diffuse
    }

    /// The mixture of the lobes' densities.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let (zero, one) = (R::zero(), R::one());
        let h = Half::new(wo, wi, self.eta);
        let front = wo.z.gt(zero);
        let shares = self.shares(wo);
        let (dielectric, ..) = fresnel::dielectric(h.wo_m, self.eta);
        let normal = self.surface().pdf_visible(upward(wo), h.m);
        let reflects = self.reflects(dielectric, front);
        let mirrored = reflects / (R::splat(4.0) * h.wi_m.abs());
        let refracted = (one - reflects) * h.eta * h.eta * h.wi_m.abs() / h.denominator;
        let main = shares.main * normal * R::select(h.reflects, mirrored, refracted);
        let coat = clearcoat::normal_pdf(h.m, self.clearcoat_gloss) / (R::splat(4.0) * h.wi_m.abs());
        let coat = (shares.coat * coat).only(h.reflects & front);
        let pdf = (main + coat).only(h.possible)
            + (shares.diffuse * warp::cosine_hemisphere_pdf(wi.z)).only(h.reflects & front);
        pdf.only(front | self.refracting().gt(zero))
    }

    /// A direction of one of the lobes.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        let (zero, one) = (R::zero(), R::one());
        let front = wo.z.gt(zero);
        let shares = self.shares(wo);
        let m = self.surface().sample_visible(upward(wo), u);
        let (dielectric, refracted, eta) = refract(wo, m, self.eta);
        // One number decides: diffuse, coat, then refraction, then reflection.
        let diffuses = lobe.lt(shares.diffuse);
        let coats = !diffuses & lobe.lt(shares.diffuse + shares.coat);
        let rest = (lobe - shares.diffuse - shares.coat) / shares.main;
        let refracts = !diffuses & !coats & rest.lt(one - self.reflects(dielectric, front));

        let coat = reflect(wo, clearcoat::sample_normal(self.clearcoat_gloss, u));
        let mut wi = Vector3::select(refracts, refracted, reflect(wo, m));
        wi = Vector3::select(coats, coat, wi);
        wi = Vector3::select(diffuses, warp::cosine_hemisphere(u.0, u.1), wi);
        let stays = (wi.z * wo.z).gt(zero);
        let right = (stays & !refracts) | ((wi.z * wo.z).lt(zero) & refracts);
        let sample = Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), right);
        Sample { eta: R::select(refracts, eta, one), ..sample }
    }

    #[inline]
    fn surface(&self) -> Microfacet<R> {
        let alpha = self.roughness * self.roughness;
        let aspect = (R::one() - R::splat(0.9) * self.anisotropic).max(R::splat(0.1)).sqrt();
        let least = R::splat(1e-3);
        Microfacet::new(Distribution::Ggx, (alpha / aspect).max(least), (alpha * aspect).max(least))
    }

    /// (1 − m) t.
    #[inline]
    fn refracting(&self) -> R {
        (R::one() - self.metallic) * self.spec_trans
    }

    /// (1 − m)(1 − t).
    #[inline]
    fn diffusing(&self) -> R {
        (R::one() - self.metallic) * (R::one() - self.spec_trans)
    }

    /// Probability that the main lobe reflects at a normal.
    #[inline]
    fn reflects(&self, dielectric: R, front: R::Mask) -> R {
        let above = R::one() - self.refracting() * (R::one() - dielectric);
        R::select(front, above, dielectric)
    }

    #[inline]
    fn shares(&self, wo: Vector3<R>) -> Shares<R> {
        let front = wo.z.gt(R::zero());
        let (diffuse, coat) = (self.diffusing(), R::splat(0.25) * self.clearcoat);
        let scale = R::one() / (R::one() + diffuse + coat);
        Shares {
            diffuse: (diffuse * scale).only(front),
            coat: (coat * scale).only(front),
            main: R::select(front, scale, R::one()),
        }
    }

    /// Reflectance of the main lobe from above.
    #[inline]
    fn fresnel(&self, dielectric: R, cos: R) -> Vector3<R> {
        let dielectric_share = R::one() - self.metallic;
        let metal = clearcoat::schlick(self.base_color, cos, self.eta).scale(self.metallic);
        let root = (self.eta - R::one()) / (self.eta + R::one());
        let tinted = clearcoat::schlick(self.hue().scale(root * root), cos, self.eta);
        let tinted = tinted.scale(dielectric_share * self.spec_tint);
        splat(dielectric_share * (R::one() - self.spec_tint) * dielectric) + metal + tinted
    }

    /// The base colour at luminance 1; white for black.
    #[inline]
    fn hue(&self) -> Vector3<R> {
        let c = self.base_color;
        let luminance = R::splat(0.212_671) * c.x + R::splat(0.715_160) * c.y + R::splat(0.072_169) * c.z;
        let lit = luminance.gt(R::zero());
        let scale = R::one() / R::select(lit, luminance, R::one());
        Vector3::select(lit, c.scale(scale), splat(R::one()))
    }

    /// Diffuse, retroreflection, the flat look and sheen; times cos θ_i.
    #[inline]
    fn diffuse(&self, wo: Vector3<R>, wi: Vector3<R>, wi_m: R) -> Vector3<R> {
        let (half, one) = (R::splat(0.5), R::one());
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let (at_o, at_i) = (clearcoat::schlick_weight(cos_o), clearcoat::schlick_weight(cos_i));
        let lambert = (one - half * at_i) * (one - half * at_o);
        let rough = (self.roughness + self.roughness) * wi_m * wi_m;
        let retro = rough * (at_o + at_i + at_o * at_i * (rough - one));
        let grazing = half * rough;
        let bent = (one + (grazing - one) * at_o) * (one + (grazing - one) * at_i);
        let flat = R::splat(1.25) * (bent * (one / (cos_o + cos_i) - half) + half);
        let shape = (one - self.flatness) * (lambert + retro) + self.flatness * flat;
        let body = self.base_color.scale(self.diffusing() * R::splat(INV_PI) * shape);

        let tint = splat(one - self.sheen_tint) + self.hue().scale(self.sheen_tint);
        let sheen = self.sheen * (one - self.metallic) * clearcoat::schlick_weight(wi_m.abs());
        // Sheen belongs to the diffuse part: without it there is none.
        let sheen = sheen.only(self.diffusing().gt(R::zero()));
        (body + tint.scale(sheen)).scale(cos_i)
    }
}

/// Probabilities of the lobes.
struct Shares<R> {
    diffuse: R,
    coat: R,
    main: R,
}

#[inline]
fn splat<R: Real>(x: R) -> Vector3<R> {
    vector3(x, x, x)
}

#[cfg(test)]
mod tests;
