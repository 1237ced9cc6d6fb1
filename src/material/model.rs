//! Which model a layer has, and where its parameters come from.

use super::{
    Base, Bsdf, Conductor, Dielectric, Distribution, Lambert, Measured, Microfacet, Phong, Plastic,
    Principled, RoughConductor, RoughDielectric, RoughPlastic, Toon, Ward, table::Tables,
};
use crate::simd::{Real, Vector3};
use crate::texture::{Coordinates, TextureId, TextureTable};

/// A model with a texture, or a number, for each parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each parameter is that of the model it is named for")]
pub enum Model {
    /// [`Lambert`].
    Lambert { reflectance: TextureId },
    /// [`Phong`].
    Phong { diffuse: TextureId, specular: TextureId, exponent: TextureId },
    /// [`Ward`].
    Ward { diffuse: TextureId, specular: TextureId, alpha_u: TextureId, alpha_v: TextureId },
    /// [`Toon`]; `ramp` is a place in the table's ramps.
    Toon { reflectance: TextureId, ramp: u32 },
    /// [`RoughConductor`].
    RoughConductor {
        distribution: Distribution,
        alpha_u: TextureId,
        alpha_v: TextureId,
        eta: TextureId,
        k: TextureId,
        reflectance: TextureId,
    },
    /// [`RoughPlastic`]; `coat` is a place in the table's coats.
    RoughPlastic {
        distribution: Distribution,
        alpha: TextureId,
        coat: u32,
        eta: f32,
        diffuse: TextureId,
        specular: TextureId,
        nonlinear: bool,
    },
    /// [`RoughDielectric`].
    RoughDielectric {
        distribution: Distribution,
        alpha_u: TextureId,
        alpha_v: TextureId,
        eta: f32,
        reflectance: TextureId,
        transmittance: TextureId,
    },
    /// [`Principled`].
    Principled {
        base_color: TextureId,
        roughness: TextureId,
        anisotropic: TextureId,
        metallic: TextureId,
        spec_trans: TextureId,
        eta: f32,
        spec_tint: TextureId,
        sheen: TextureId,
        sheen_tint: TextureId,
        flatness: TextureId,
        clearcoat: TextureId,
        clearcoat_gloss: TextureId,
    },
    /// [`Measured`]; `table` is a place in the scene's tables.
    Measured { table: u32 },
    /// [`Plastic`].
    Plastic { diffuse: TextureId, specular: TextureId, eta: f32, internal: f32, nonlinear: bool },
    /// [`Conductor`].
    Conductor { eta: TextureId, k: TextureId, reflectance: TextureId },
    /// [`Dielectric`].
    Dielectric { eta: f32, reflectance: TextureId, transmittance: TextureId },
    /// [`Bsdf::Transparent`].
    Transparent,
}

impl Model {
    /// The order of kinds among ids.
    pub(super) fn kind(&self) -> u32 {
        match self {
            Self::Lambert { .. } => 0,
            Self::Phong { .. } => 1,
            Self::Ward { .. } => 2,
            Self::Toon { .. } => 3,
            Self::RoughConductor { .. } => 4,
            Self::RoughPlastic { .. } => 5,
            Self::RoughDielectric { .. } => 6,
            Self::Principled { .. } => 7,
            Self::Measured { .. } => 8,
            Self::Plastic { .. } => 9,
            Self::Conductor { .. } => 10,
            Self::Dielectric { .. } => 11,
            Self::Transparent => 12,
        }
    }

    /// Does the model tell one tangent from another?
    pub(super) fn is_oriented(&self) -> bool {
        match self {
            Self::RoughConductor { alpha_u, alpha_v, .. }
            | Self::RoughDielectric { alpha_u, alpha_v, .. }
            | Self::Ward { alpha_u, alpha_v, .. } => alpha_u != alpha_v,
            Self::Principled { .. } => true,
            _ => false,
        }
    }

    /// The model with its parameters at each lane's (u, v).
    #[inline]
    pub(super) fn fetch<'t, R: Real>(
        &self,
        tables: &'t Tables,
        textures: &TextureTable,
        uv: Coordinates<R>,
    ) -> Bsdf<'t, R> {
        let color = |id: TextureId| -> Vector3<R> { textures.fetch(id, uv) };
        let number = |id: TextureId| -> R { textures.fetch_number(id, uv) };
        let microfacets = |kind, u: TextureId, v: TextureId| {
            let along = number(u);
            Microfacet::new(kind, along, if u == v { along } else { number(v) })
        };
        match *self {
            Self::Lambert { reflectance } => Bsdf::Lambert(Lambert { reflectance: color(reflectance) }),
            Self::Phong { diffuse, specular, exponent } => Bsdf::Phong(Phong {
                diffuse: color(diffuse),
                specular: color(specular),
                exponent: number(exponent),
            }),
            Self::Ward { diffuse, specular, alpha_u, alpha_v } => {
                Bsdf::Ward(Ward::new(color(diffuse), color(specular), number(alpha_u), number(alpha_v)))
            }
            Self::Toon { reflectance, ramp } => {
                Bsdf::Toon(Toon { reflectance: color(reflectance), ramp: &tables.ramps[ramp as usize] })
            }
            Self::RoughConductor { distribution, alpha_u, alpha_v, eta, k, reflectance } => {
                Bsdf::RoughConductor(RoughConductor {
                    surface: microfacets(distribution, alpha_u, alpha_v),
                    eta: color(eta),
                    k: color(k),
                    reflectance: color(reflectance),
                })
            }
            Self::RoughPlastic { distribution, alpha, coat, eta, diffuse, specular, nonlinear } => {
                let alpha = number(alpha);
                let coat = tables.coats[coat as usize].at(alpha);
                Bsdf::RoughPlastic(RoughPlastic {
                    surface: Microfacet::new(distribution, alpha, alpha),
                    coat,
                    base: Base {
                        diffuse: color(diffuse),
                        eta: R::splat(eta),
                        internal: coat.internal(),
                        nonlinear,
                    },
                    specular: color(specular),
                })
            }
            Self::RoughDielectric { distribution, alpha_u, alpha_v, eta, reflectance, transmittance } => {
                Bsdf::RoughDielectric(RoughDielectric {
                    surface: microfacets(distribution, alpha_u, alpha_v),
                    eta: R::splat(eta),
                    reflectance: color(reflectance),
                    transmittance: color(transmittance),
                })
            }
            Self::Principled {
                base_color,
                roughness,
                anisotropic,
                metallic,
                spec_trans,
                eta,
                spec_tint,
                sheen,
                sheen_tint,
                flatness,
                clearcoat,
                clearcoat_gloss,
            } => Bsdf::Principled(Principled {
                base_color: color(base_color),
                roughness: number(roughness),
                anisotropic: number(anisotropic),
                metallic: number(metallic),
                spec_trans: number(spec_trans),
                eta: R::splat(eta),
                spec_tint: number(spec_tint),
                sheen: number(sheen),
                sheen_tint: number(sheen_tint),
                flatness: number(flatness),
                clearcoat: number(clearcoat),
                clearcoat_gloss: number(clearcoat_gloss),
            }),
            Self::Measured { table } => Bsdf::Measured(Measured { table: &tables.measured[table as usize] }),
            Self::Plastic { diffuse, specular, eta, internal, nonlinear } => Bsdf::Plastic(Plastic {
                base: Base {
                    diffuse: color(diffuse),
                    eta: R::splat(eta),
                    internal: R::splat(internal),
                    nonlinear,
                },
                specular: color(specular),
            }),
            Self::Conductor { eta, k, reflectance } => {
                Bsdf::Conductor(Conductor { eta: color(eta), k: color(k), reflectance: color(reflectance) })
            }
            Self::Dielectric { eta, reflectance, transmittance } => Bsdf::Dielectric(Dielectric {
                eta: R::splat(eta),
                reflectance: color(reflectance),
                transmittance: color(transmittance),
            }),
            Self::Transparent => Bsdf::Transparent,
        }
    }
}
