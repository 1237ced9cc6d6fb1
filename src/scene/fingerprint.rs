//! Which scene is it?

use std::fmt::Write;

use super::{SceneDescription, Sensor};
use crate::math::Digest;

impl SceneDescription {
    /// A digest of all that can be seen: shapes, materials, lights and the camera; not of how it is
    /// rendered, which is the integrator, the film and the sampler.
    ///
    /// Taken from the text by which a description shows itself for debugging: it names every field that
    /// there is, so none can be forgotten here. Meshes, pictures and tables show digests of their own.
    pub fn fingerprint(&self) -> u64 {
        let Self { sensor, shapes, groups, instances, materials, emitters, .. } = self;
        let Sensor { to_world, projection, near_clip, far_clip, .. } = sensor;
        let mut digest = Digest::default();
        let written = write!(
            digest,
            "{:?}{:?}",
            (to_world, projection, near_clip, far_clip),
            (shapes, groups, instances, materials, emitters)
        );
        debug_assert!(written.is_ok(), "a digest takes any text");
        digest.value()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;
    use crate::{
        picture::{Channel, Picture},
        scene::{Emitter, Film, Geometry, Integrator, MaterialIndex, Mesh, Shape},
    };

    fn scene() -> SceneDescription {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), samples: vec![1.0] });
        let picture = Picture { width: 1, height: 1, channels: channels.into(), place: None };
        SceneDescription {
            shapes: vec![Shape {
                name: "triangle".into(),
                geometry: Geometry::Mesh { mesh: Arc::new(mesh), face_normals: false },
                to_world: glam::DAffine3::IDENTITY,
                flip_normals: false,
                material: MaterialIndex(0),
                radiance: None,
            }],
            emitters: vec![Emitter::Envmap {
                picture: Arc::new(picture),
                scale: 1.0,
                to_world: glam::DMat3::IDENTITY,
            }],
            ..SceneDescription::default()
        }
    }

    #[test]
    fn the_last_bit_of_bulk_data_is_seen() {
        let (mut moved, mut tinted) = (scene(), scene());
        let Geometry::Mesh { mesh, .. } = &mut moved.shapes[0].geometry else { panic!("no mesh") };
        let x = &mut Arc::make_mut(mesh).positions[1].x;
        *x = x.next_up();
        let Emitter::Envmap { picture, .. } = &mut tinted.emitters[0] else { panic!("no sky") };
        let sample = &mut Arc::make_mut(picture).channels[2].samples[0];
        *sample = sample.next_down();
        let prints = [scene(), moved, tinted].map(|scene| scene.fingerprint());
        assert!(prints[0] != prints[1] && prints[0] != prints[2], "{prints:x?}");
        assert_eq!(scene().fingerprint(), prints[0]);
    }

    #[test]
    fn how_it_is_rendered_does_not_matter() {
        let mut other = scene();
        other.sensor.film = Film::new(5, 5);
        other.sensor.sampler.seed = 9;
        other.integrator = Integrator::Whitted { max_depth: 2 };
        assert_eq!(other.fingerprint(), scene().fingerprint());
        other.sensor.near_clip += 1.0;
        assert_ne!(other.fingerprint(), scene().fingerprint());
    }
}
