//! Reflection models, as a file names them.

use std::sync::Arc;

use super::{Rgb, Texture};
pub use crate::material::{Distribution, MerlTable, Ramp, Relief, Stop};

/// A reflection model and its parameters. Reflectances are in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// Lambert: f = ρ/π on the side of the normal, black from behind.
    Diffuse {
        /// ρ.
        reflectance: Texture,
    },
    /// Ideal mirror with the exact Fresnel reflectance of a conductor, on the side of the normal.
    Conductor {
        /// Index of refraction and absorption.
        metal: Metal,
        /// Factor on the reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
    },
    /// Microfacets of a conductor, on the side of the normal.
    RoughConductor {
        /// How rough.
        roughness: Roughness,
        /// Index of refraction and absorption.
        metal: Metal,
        /// Factor on the reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
    },
    /// Ideal glass: the side that the normal points to is the exterior.
    Dielectric {
        /// Index of refraction inside.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Factor on reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
        /// Factor on refracted light; 1 for physical surfaces.
        specular_transmittance: Texture,
    },
    /// Rough glass: the side that the normal points to is the exterior.
    RoughDielectric {
        /// How rough.
        roughness: Roughness,
        /// Index of refraction inside.
        int_ior: f32,
        /// Index of refraction outside; another one.
        ext_ior: f32,
        /// Factor on reflected light; 1 for physical surfaces.
        specular_reflectance: Texture,
        /// Factor on refracted light; 1 for physical surfaces.
        specular_transmittance: Texture,
    },
    /// A dielectric coat, smooth or rough, over a diffuse base, on the side of the normal.
    Plastic {
        /// The coat's distribution of normals and its α; `None` is smooth.
        roughness: Option<(Distribution, Texture)>,
        /// Index of refraction of the coat.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// ρ of the base.
        diffuse_reflectance: Texture,
        /// Factor on what the coat reflects; 1 for physical surfaces.
        specular_reflectance: Texture,
        /// Do colours saturate with each bounce below the coat?
        nonlinear: bool,
    },
    /// Burley's model, on the side of the normal; from behind, where it refracts.
    Principled(Box<Principled>),
    /// A measured table, on the side of the normal.
    Measured {
        /// Shared by all materials of the same file.
        table: Arc<MerlTable>,
    },
    /// Energy-normalised modified Phong: ρ_d/π + ρ_s (n+2)/2π cosⁿα, on the side of the normal.
    Phong {
        /// ρ_d.
        diffuse_reflectance: Texture,
        /// ρ_s; ρ_d + ρ_s ≤ 1 conserves energy.
        specular_reflectance: Texture,
        /// n.
        exponent: Texture,
    },
    /// Ward's anisotropic reflection, bounded, on the side of the normal.
    Ward {
        /// ρ_d.
        diffuse_reflectance: Texture,
        /// ρ_s; ρ_d + ρ_s ≤ 1 conserves energy.
        specular_reflectance: Texture,
        /// Roughness along ∂p/∂u.
        alpha_u: Texture,
        /// Roughness across.
        alpha_v: Texture,
    },
    /// Bands of light, on the side of the normal.
    Toon {
        /// ρ.
        reflectance: Texture,
        /// What stands in place of the cosine.
        ramp: Arc<Ramp>,
    },
    /// An opaque material that is shaded on both sides, as if the side seen were the front.
    TwoSided {
        /// The side of the normal.
        front: Box<Material>,
        /// The other side; `None` is the same as the front.
        back: Option<Box<Material>>,
    },
    /// A material with holes, through which light passes unbent.
    Mask {
        /// How much of it is there, in [0, 1].
        opacity: Texture,
        /// What is there.
        nested: Box<Material>,
    },
    /// A mixture of two.
    Blend {
        /// Share of the second, in [0, 1].
        weight: Texture,
        /// At weight 0, and at weight 1.
        nested: Box<[Material; 2]>,
    },
    /// Normals leaning by the slope of a height.
    BumpMap {
        /// Height over uv.
        height: Texture,
        /// Factor on it, in units of the scene.
        scale: f32,
        /// What is done where they lean far.
        relief: Relief,
        /// What leans.
        nested: Box<Material>,
    },
    /// Normals given in the surface's frame.
    NormalMap {
        /// (n + 1)/2, with x along ∂p/∂u.
        normals: Texture,
        /// What is done where they lean far.
        relief: Relief,
        /// What leans.
        nested: Box<Material>,
    },
}

/// The optical constants of a conductor, relative to vacuum.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// Real part of the index of refraction, per channel.
    pub eta: Texture,
    /// Imaginary part (absorption), per channel.
    pub k: Texture,
}

/// A distribution of microfacets. α is the slope parameter itself, not its root; below 10⁻⁴ it is taken
/// as 10⁻⁴.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    /// Which distribution.
    pub distribution: Distribution,
    /// α along ∂p/∂u.
    pub alpha_u: Texture,
    /// α across.
    pub alpha_v: Texture,
}

/// Parameters of [`Material::Principled`]; in [0, 1] but for `eta`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "they are explained at the model, material::Principled")]
pub struct Principled {
    pub base_color: Texture,
    pub roughness: Texture,
    pub anisotropic: Texture,
    pub metallic: Texture,
    pub spec_trans: Texture,
    pub eta: f32,
    pub spec_tint: Texture,
    pub sheen: Texture,
    pub sheen_tint: Texture,
    pub flatness: Texture,
    pub clearcoat: Texture,
    pub clearcoat_gloss: Texture,
}

impl Default for Material {
    fn default() -> Self {
        Self::Diffuse { reflectance: Texture::Constant(Rgb::splat(0.5)) }
    }
}

impl Material {
    /// Does light pass through it?
    pub fn transmits(&self) -> bool {
        match self {
            Self::Dielectric { .. } | Self::RoughDielectric { .. } | Self::Mask { .. } => true,
            Self::Principled(principled) => principled.spec_trans != Texture::Constant(Rgb::ZERO),
            Self::TwoSided { .. } => false,
            Self::Blend { nested, .. } => nested.iter().any(Self::transmits),
            Self::BumpMap { nested, .. } | Self::NormalMap { nested, .. } => nested.transmits(),
            Self::Diffuse { .. }
            | Self::Conductor { .. }
            | Self::RoughConductor { .. }
            | Self::Plastic { .. }
            | Self::Measured { .. }
            | Self::Phong { .. }
            | Self::Ward { .. }
            | Self::Toon { .. } => false,
        }
    }

    /// Does it reflect on the side that its normal looks away from?
    pub fn has_two_sides(&self) -> bool {
        match self {
            Self::TwoSided { .. } => true,
            Self::Blend { nested, .. } => nested.iter().any(Self::has_two_sides),
            Self::Mask { nested, .. } | Self::BumpMap { nested, .. } | Self::NormalMap { nested, .. } => {
                nested.has_two_sides()
            }
            _ => self.transmits(),
        }
    }
}
