//! The same material, rougher or smoother.

use crate::scene::{Material, Rgb, Roughness, Texture};

/// The roughnesses that a certificate tries.
pub(super) const ROUGHNESSES: [f32; 6] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];

/// The material with this roughness everywhere: α of microfacets and of Ward's model, the root of α of the
/// principled one, and for Phong the exponent 2/α² − 2 of the lobe that is as wide. `None` if it has none.
pub(super) fn with_roughness(material: &Material, alpha: f32) -> Option<Material> {
    let everywhere = || Texture::Constant(Rgb::splat(alpha));
    let all = |roughness: &mut Roughness| {
        (roughness.alpha_u, roughness.alpha_v) = (everywhere(), everywhere());
    };
    let mut material = material.clone();
    match &mut material {
        Material::RoughConductor { roughness, .. } | Material::RoughDielectric { roughness, .. } => {
            all(roughness);
        }
        Material::Plastic { roughness: Some((_, coat)), .. } => *coat = everywhere(),
        Material::Ward { alpha_u, alpha_v, .. } => (*alpha_u, *alpha_v) = (everywhere(), everywhere()),
        Material::Principled(principled) => principled.roughness = everywhere(),
        Material::Phong { exponent, .. } => {
            *exponent = Texture::Constant(Rgb::splat(2.0 / (alpha * alpha) - 2.0));
        }
        _ => return None,
    }
    Some(material)
}
