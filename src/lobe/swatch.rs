//! A material at a point.

use crate::{
    compile::{CompileError, Scene, compile},
    material::{Appearance, MaterialId, Point, Sample, proof::Reflector},
    scene::{Material, SceneDescription},
    simd::{Real, Vector3, vector3},
};

/// A material at uv = (½, ½) of a surface with ∂p/∂u along x and ∂p/∂v along y, ready to be evaluated.
#[derive(Debug)]
pub struct Swatch {
    material: Material,
    /// Nothing to be hit, one material.
    scene: Scene,
}

impl Swatch {
    /// Compiles the material.
    ///
    /// # Errors
    /// [`CompileError`], as for a scene.
    pub fn new(material: Material) -> Result<Self, CompileError> {
        let description = SceneDescription { materials: vec![material.clone()], ..Default::default() };
        Ok(Self { material, scene: compile(&description)? })
    }

    /// What it was made of.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Does light pass through it?
    pub fn transmits(&self) -> bool {
        self.material.transmits()
    }

    /// The material seen from `wo`, in the frame of the surface.
    #[inline]
    pub fn seen_from<R: Real>(&self, wo: Vector3<R>) -> Appearance<'_, R> {
        let (zero, one) = (R::zero(), R::one());
        let uv = (R::splat(0.5), R::splat(0.5)).into();
        let tangents = [vector3(one, zero, zero), vector3(zero, one, zero)];
        self.scene.materials.appearance(MaterialId(0), &self.scene.textures, &Point { wo, uv, tangents })
    }
}

impl<R: Real> Reflector<R> for Swatch {
    #[inline]
    fn eval_pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> (Vector3<R>, R) {
        self.seen_from(wo).eval(wi)
    }

    #[inline]
    fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        self.seen_from(wo).sample(lobe, u)
    }

    fn transmits(&self) -> bool {
        self.transmits()
    }
}
