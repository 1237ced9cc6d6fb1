//! Reflection models, one a file: equation, source, and the three verbs.
//!
//! Directions are unit vectors in the shading frame: z is the normal, x the first tangent; `wo` points
//! towards the viewer and `wi` towards the light, both **away from the surface**.
//!
//! - `eval(wo, wi)` = f(wo, wi) |cos θ_i|, per steradian; 0 for the delta part of a model.
//! - `sample(wo, lobe, u)` draws `wi` and gives the weight f |cos θ_i| / pdf.
//! - `pdf(wo, wi)` is the density of `sample` per solid angle, without the delta part.
//!
//! A [`Bsdf`] is one model. An [`Appearance`] is what a material looks like at a point: one model or
//! several, each weighted, turned to the side seen, in a frame of its own.

mod appearance;
mod bsdf;
mod clearcoat;
mod coat;
mod conductor;
mod dielectric;
pub mod fresnel;
mod lambert;
mod merl;
mod microfacet;
mod model;
mod phong;
mod plastic;
mod principled;
pub mod proof;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod table;
mod toon;
mod transparent;
mod ward;

pub use appearance::{Appearance, Point};
pub use bsdf::{Branch, Bsdf, Sample};
pub use coat::{Coat, CoatRange, diffuse_reflectance};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use lambert::Lambert;
pub use merl::{MERL_CELLS, Measured, MerlError, MerlTable};
pub use microfacet::{Distribution, Microfacet};
pub use model::Model;
pub use phong::Phong;
pub use plastic::{Base, Plastic};
pub use principled::Principled;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use table::{Factor, Layer, MaterialId, MaterialRow, MaterialTable, Relief, Step, Tables};
pub use toon::{Ramp, Stop, Toon};
pub use ward::Ward;
