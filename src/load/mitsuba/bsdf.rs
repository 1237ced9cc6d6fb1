//! Reflection models.

mod optics;
mod ramp;
mod wrappers;

use std::sync::Arc;

use super::{
    colour,
    files::Files,
    properties::Object,
    texture::{self, Range},
};
use crate::{
    load::LoadError,
    scene::{Distribution, Material, Principled, Roughness},
};
use optics::{ior, metal};

pub(super) fn build(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut reflectance = |name, default| texture::colour(object, name, default, Range::Unit, files);
    let material = match object.plugin() {
        "diffuse" => Material::Diffuse { reflectance: reflectance("reflectance", 0.5)? },
        "conductor" => Material::Conductor {
            specular_reflectance: reflectance("specular_reflectance", 1.0)?,
            metal: metal(object, files)?,
        },
        "roughconductor" => Material::RoughConductor {
            specular_reflectance: reflectance("specular_reflectance", 1.0)?,
            metal: metal(object, files)?,
            roughness: roughness(object, files)?,
        },
        "dielectric" => Material::Dielectric {
            specular_reflectance: reflectance("specular_reflectance", 1.0)?,
            specular_transmittance: reflectance("specular_transmittance", 1.0)?,
            int_ior: ior(object, "int_ior", "bk7")?,
            ext_ior: ior(object, "ext_ior", "air")?,
        },
        "roughdielectric" => rough_dielectric(object, files)?,
        "plastic" | "roughplastic" => plastic(object, files)?,
        "principled" => Material::Principled(Box::new(principled(object, files)?)),
        "phong" => Material::Phong {
            diffuse_reflectance: reflectance("diffuse_reflectance", 0.5)?,
            specular_reflectance: reflectance("specular_reflectance", 0.2)?,
            exponent: texture::number(object, "exponent", 30.0, Range::Positive, files)?,
        },
        "merl" => Material::Measured { table: files.table(object)? },
        "ward" => {
            let diffuse_reflectance = reflectance("diffuse_reflectance", 0.5)?;
            let specular_reflectance = reflectance("specular_reflectance", 0.2)?;
            let (alpha_u, alpha_v) = alphas(object, files)?;
            Material::Ward { diffuse_reflectance, specular_reflectance, alpha_u, alpha_v }
        }
        "toon" => Material::Toon {
            reflectance: reflectance("reflectance", 0.5)?,
            ramp: Arc::new(ramp::ramp(object, files)?),
        },
        "twosided" => wrappers::two_sided(object, files)?,
        "mask" => wrappers::mask(object, files)?,
        "blendbsdf" => wrappers::blend(object, files)?,
        "bumpmap" => wrappers::bump_map(object, files)?,
        "normalmap" => wrappers::normal_map(object, files)?,
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(material)
}

const DISTRIBUTIONS: [(&str, Distribution); 2] =
    [("beckmann", Distribution::Beckmann), ("ggx", Distribution::Ggx)];

fn distribution(object: Object) -> Result<Distribution, LoadError> {
    // Normals are always sampled as they are seen; both ways give the same picture.
    object.boolean("sample_visible", true)?;
    object.choice("distribution", &DISTRIBUTIONS, Distribution::Beckmann)
}

fn roughness(object: Object, files: &mut Files) -> Result<Roughness, LoadError> {
    let distribution = distribution(object)?;
    let (alpha_u, alpha_v) = alphas(object, files)?;
    Ok(Roughness { distribution, alpha_u, alpha_v })
}

/// `alpha`, or `alpha_u` and `alpha_v`.
fn alphas(object: Object, files: &mut Files) -> Result<(texture::Texture, texture::Texture), LoadError> {
    object.exclude("alpha", "alpha_u")?;
    object.exclude("alpha", "alpha_v")?;
    let mut alpha = |name| texture::number(object, name, 0.1, Range::Positive, files);
    if object.has("alpha_u") || object.has("alpha_v") {
        for (given, other) in [("alpha_u", "alpha_v"), ("alpha_v", "alpha_u")] {
            if object.has(given) && !object.has(other) {
                return Err(object
                    .error_at(given, format!("`{given}` stands alone"))
                    .help(format!("give `{other}` too, or `alpha` for both")));
            }
        }
        return Ok((alpha("alpha_u")?, alpha("alpha_v")?));
    }
    let both = alpha("alpha")?;
    Ok((both.clone(), both))
}

fn rough_dielectric(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut factor = |name| texture::colour(object, name, 1.0, Range::Unit, files);
    let specular_reflectance = factor("specular_reflectance")?;
    let specular_transmittance = factor("specular_transmittance")?;
    let (int_ior, ext_ior) = (ior(object, "int_ior", "bk7")?, ior(object, "ext_ior", "air")?);
    if int_ior / ext_ior == 1.0 {
        return Err(object
            .error_at("int_ior", "`int_ior` and `ext_ior` of a `roughdielectric` are the same")
            .help("a surface between equal indices bends no light: leave it out"));
    }
    let roughness = roughness(object, files)?;
    Ok(Material::RoughDielectric {
        roughness,
        int_ior,
        ext_ior,
        specular_reflectance,
        specular_transmittance,
    })
}

fn plastic(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut reflectance = |name, default| texture::colour(object, name, default, Range::Unit, files);
    let diffuse_reflectance = reflectance("diffuse_reflectance", 0.5)?;
    let specular_reflectance = reflectance("specular_reflectance", 1.0)?;
    let roughness = match object.plugin() {
        "roughplastic" => {
            Some((distribution(object)?, texture::number(object, "alpha", 0.1, Range::Positive, files)?))
        }
        _ => None,
    };
    let (int_ior, ext_ior) = (ior(object, "int_ior", "polypropylene")?, ior(object, "ext_ior", "air")?);
    let nonlinear = object.boolean("nonlinear", false)?;
    Ok(Material::Plastic {
        roughness,
        int_ior,
        ext_ior,
        diffuse_reflectance,
        specular_reflectance,
        nonlinear,
    })
}

fn principled(object: Object, files: &mut Files) -> Result<Principled, LoadError> {
    // How often each lobe is sampled is Mitsuba's business; the picture does not depend on it.
    for rate in
        ["main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate"]
    {
        object.float(rate)?;
    }
    let base_color = texture::colour(object, "base_color", 0.5, Range::Unit, files)?;
    let mut number = |name, default| texture::number(object, name, default, Range::Unit, files);
    let roughness = number("roughness", 0.5)?;
    let mut share = |name| number(name, 0.0);
    Ok(Principled {
        base_color,
        roughness,
        anisotropic: share("anisotropic")?,
        metallic: share("metallic")?,
        spec_trans: share("spec_trans")?,
        spec_tint: share("spec_tint")?,
        sheen: share("sheen")?,
        sheen_tint: share("sheen_tint")?,
        flatness: share("flatness")?,
        clearcoat: share("clearcoat")?,
        clearcoat_gloss: share("clearcoat_gloss")?,
        eta: principled_eta(object)?,
    })
}

/// From `eta`, or from `specular`: the reflectance at normal incidence over 0.08. Where light passes, an
/// interface that is not there is made barely there.
fn principled_eta(object: Object) -> Result<f32, LoadError> {
    object.exclude("eta", "specular")?;
    let transmits = object.has("spec_trans");
    if object.has("eta") {
        let eta = object.positive("eta", 1.5)? as f32;
        return Ok(if transmits && eta == 1.0 { 1.001 } else { eta });
    }
    let specular = colour::unit(object, "specular", 0.5)?;
    let specular = if transmits { specular.max(1e-3) } else { specular };
    Ok((2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0) as f32)
}
