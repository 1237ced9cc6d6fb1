//! Vertices in world space, in two columns: those without texture coordinates have no room for them.

use glam::{Vec2, Vec3};

use super::surfaces::Interpolate;

/// A vertex without texture coordinates: 24 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Vertex {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// A vertex with texture coordinates: 32 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Mapped {
    pub(super) vertex: Vertex,
    pub(super) uv: Vec2,
}

/// Both columns. Corners of a triangle are places in one of them: in `mapped` if its (u, v) are its vertices'.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) plain: Vec<Vertex>,
    pub(super) mapped: Vec<Mapped>,
}

impl Vertices {
    /// Positions of a triangle's corners.
    #[inline]
    pub(super) fn positions(&self, uv: Interpolate, corners: [u32; 3]) -> [Vec3; 3] {
        corners.map(|i| match uv {
            Interpolate::Vertices => self.mapped[i as usize].vertex.position,
            Interpolate::Face => self.plain[i as usize].position,
        })
    }

    /// Position, normal and, in the mapped column, (u, v).
    #[inline]
    pub(super) fn row(&self, mapped: bool, place: u32) -> [f32; 8] {
        let (Vertex { position: p, normal: n }, uv) = match mapped {
            true => {
                let Mapped { vertex, uv } = self.mapped[place as usize];
                (vertex, uv)
            }
            false => (self.plain[place as usize], Vec2::ZERO),
        };
        [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y]
    }
}

impl AsRef<Vertex> for Vertex {
    fn as_ref(&self) -> &Vertex {
        self
    }
}

impl AsMut<Vertex> for Vertex {
    fn as_mut(&mut self) -> &mut Vertex {
        self
    }
}

impl AsRef<Vertex> for Mapped {
    fn as_ref(&self) -> &Vertex {
        &self.vertex
    }
}

impl AsMut<Vertex> for Mapped {
    fn as_mut(&mut self) -> &mut Vertex {
        &mut self.vertex
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec3};

    use crate::compile::{Asked, Scene, compile};
    use crate::scene::{Geometry, Material, MaterialIndex, Mesh, SceneDescription, Shape};
    use crate::simd::{Bits, Real, Vector3, f32x8, u32x8};

    fn shape(geometry: Geometry) -> Shape {
        Shape {
            name: "shape".into(),
            geometry,
            to_world: DAffine3::from_translation(DVec3::new(0.5, 0.25, 2.0)),
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        }
    }

    /// Corners 0, 1 and 2 of either column, then 0, 2 and 3 of one, then a sphere.
    fn description() -> SceneDescription {
        let mesh = Mesh {
            positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let mesh = Geometry::Mesh { mesh: Arc::new(mesh), face_normals: false };
        let sphere = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0 };
        SceneDescription {
            shapes: [mesh, Geometry::Rectangle, sphere].map(shape).into(),
            materials: vec![Material::default()],
            ..SceneDescription::default()
        }
    }

    /// Position, normal and (u, v) in a lane, as bits.
    fn surface<R: Real>(scene: &Scene, primitives: R::Bits, lane: usize) -> [u32; 8] {
        let (along, uv) = (R::splat(1.0), (R::splat(0.25), R::splat(0.5)));
        let ray =
            (Vector3::splat(glam::Vec3::new(0.3, 0.2, 0.0)), Vector3::splat(glam::Vec3::new(0.6, 0.0, 0.8)));
        let asked = Asked { mapped: true, oriented: false };
        let at = scene.surface::<R>(ray, (along, uv.0, uv.1), primitives, asked);
        let (p, n) = (at.position, at.frame.n);
        [p.x, p.y, p.z, n.x, n.y, n.z, at.uv.u, at.uv.v].map(|value| value.lane(lane).to_bits())
    }

    #[test]
    fn lanes_of_both_columns_are_what_each_is_alone() {
        let scene = compile(&description()).expect("it compiles");
        // All pairs of what may stand in a lane and in the others: a plain triangle, two mapped ones, a sphere.
        for (one, other) in (0..4).flat_map(|one| [0, 1, 2, 3].map(|other| (one, other))) {
            for place in 0..8 {
                let id = |lane: usize| if lane == place { one } else { other };
                let mixed = u32x8::from_fn(id);
                for lane in 0..8 {
                    let alone = surface::<f32>(&scene, id(lane), 0);
                    assert_eq!(
                        surface::<f32x8>(&scene, mixed, lane),
                        alone,
                        "{one} at {place} among {other}"
                    );
                }
            }
        }
    }
}
