//! What a scene file says: plain public data, no behaviour beyond defaults and a digest.
//!
//! `load/` fills a [`SceneDescription`], `compile/` turns it into columns and a tree. Units are SI,
//! radiometric quantities are linear sRGB triples, angles are radians, world space is right-handed.
//! Everything in here has passed the door: numbers are finite, indices are in range, files were read.

mod doubts;
mod emitter;
mod fingerprint;
mod integrator;
mod material;
mod resources;
mod sensor;
mod shape;
mod texture;

pub use doubts::Doubt;
pub use emitter::Emitter;
pub use integrator::{Aov, AovChannel, Integrator};
pub use material::{Distribution, Material, MerlTable, Metal, Principled, Ramp, Relief, Roughness, Stop};
pub use resources::Resources;
pub use sensor::{Crop, Film, PixelFormat, Projection, ReconstructionFilter, Sampler, Sensor};
pub use shape::{Attribute, Geometry, GroupIndex, Instance, Mesh, Per, Shape, ShapeGroup};
pub use texture::{Filter, Texture, Wrap};

/// A linear sRGB triple: reflectance, radiance, or any other spectral quantity in three bands.
pub type Rgb = glam::Vec3;

/// Place of a [`Material`] in [`SceneDescription::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialIndex(pub u32);

/// A whole scene as its file describes it, with every mesh and image read.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// How light is transported.
    pub integrator: Integrator,
    /// The camera, its film and its sampler.
    pub sensor: Sensor,
    /// Everything that can be hit, in file order: the order decides ties (lowest primitive id).
    pub shapes: Vec<Shape>,
    /// Shapes that are only where instances place them.
    pub groups: Vec<ShapeGroup>,
    /// Groups in the world, after all shapes where the order decides.
    pub instances: Vec<Instance>,
    /// The reflection models that shapes refer to.
    pub materials: Vec<Material>,
    /// Lights that are not shapes.
    pub emitters: Vec<Emitter>,
    /// What the camera sees besides, as layers of the picture.
    pub aovs: Vec<AovChannel>,
}
