//! What is legal in a scene and probably not meant.

use glam::DVec3;

use super::{Emitter, Geometry, Rgb, SceneDescription, Shape};

impl SceneDescription {
    /// A sentence each.
    pub fn doubts(&self) -> Vec<String> {
        let dark = self.shapes.iter().filter(|shape| shape.radiance == Some(Rgb::ZERO));
        let dark = dark.map(|shape| format!("shape `{}` is a light without power", shape.name));
        let powerless = self.emitters.iter().filter(|emitter| has_no_power(emitter)).map(|emitter| {
            let text = format!("{emitter:?}");
            let kind = text.split([' ', '{']).next().unwrap_or_default().to_lowercase();
            format!("a `{kind}` emitter has no power")
        });
        let eye = self.sensor.to_world.translation;
        let around =
            self.shapes.iter().filter(|shape| self.encloses(shape, eye)).map(|shape| {
                format!("the camera is inside of shape `{}`, which no light passes", shape.name)
            });
        dark.chain(powerless).chain(around).collect()
    }

    /// Is the point inside of a small closed shape that is opaque and does not light its inside?
    fn encloses(&self, shape: &Shape, point: DVec3) -> bool {
        let inside = match shape.geometry {
            Geometry::Sphere { center, radius } => {
                (shape.to_world.inverse().transform_point3(point) - center).length() < radius
            }
            Geometry::Cube => shape.to_world.inverse().transform_point3(point).abs().max_element() < 1.0,
            _ => false,
        };
        // A room is a shape that others are in, and its walls look inwards.
        let is_room = shape.flip_normals || self.shapes.len() > 1 && self.holds_another(shape);
        let transmits = self.materials.get(shape.material.0 as usize).is_none_or(super::Material::transmits);
        inside && !is_room && !transmits
    }

    fn holds_another(&self, room: &Shape) -> bool {
        self.shapes.iter().filter(|shape| !std::ptr::eq(*shape, room)).any(|shape| {
            let center = match shape.geometry {
                Geometry::Sphere { center, .. } => center,
                _ => DVec3::ZERO,
            };
            let there = room.to_world.inverse().transform_point3(shape.to_world.transform_point3(center));
            match room.geometry {
                Geometry::Sphere { center, radius } => (there - center).length() < radius,
                _ => there.abs().max_element() < 1.0,
            }
        })
    }
}

fn has_no_power(emitter: &Emitter) -> bool {
    match emitter {
        Emitter::Point { intensity, .. } | Emitter::Spot { intensity, .. } => *intensity == Rgb::ZERO,
        Emitter::Directional { irradiance, .. } => *irradiance == Rgb::ZERO,
        Emitter::Constant { radiance } => *radiance == Rgb::ZERO,
        Emitter::Envmap { scale, .. } => *scale == 0.0,
        Emitter::Sh { coefficients, .. } => coefficients.iter().all(|c| *c == Rgb::ZERO),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, MaterialIndex};

    fn ball(at: f64, radius: f64) -> Shape {
        Shape {
            name: format!("ball {radius}"),
            geometry: Geometry::Sphere { center: DVec3::ZERO, radius },
            to_world: glam::DAffine3::from_translation(DVec3::new(0.0, 0.0, at)),
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        }
    }

    fn scene(shapes: Vec<Shape>) -> SceneDescription {
        SceneDescription { shapes, materials: vec![Material::default()], ..SceneDescription::default() }
    }

    #[test]
    fn a_camera_in_a_ball_sees_nothing() {
        assert_eq!(scene(vec![ball(0.0, 1.0)]).doubts().len(), 1);
        assert!(scene(vec![ball(5.0, 1.0)]).doubts().is_empty());
        // A ball with something in it is a room, and one of glass is a drop.
        assert!(scene(vec![ball(0.0, 9.0), ball(5.0, 1.0)]).doubts().is_empty());
        let mut drop = scene(vec![ball(0.0, 1.0)]);
        let white = super::super::Texture::Constant(Rgb::ONE);
        drop.materials[0] = Material::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white.clone(),
            specular_transmittance: white,
        };
        assert!(drop.doubts().is_empty());
    }

    #[test]
    fn lights_without_power_are_told() {
        let mut lamp = ball(5.0, 1.0);
        lamp.radiance = Some(Rgb::ZERO);
        let mut scene = scene(vec![lamp]);
        scene.emitters =
            vec![Emitter::Constant { radiance: Rgb::ZERO }, Emitter::Constant { radiance: Rgb::ONE }];
        let doubts = scene.doubts();
        assert_eq!(doubts.len(), 2, "{doubts:?}");
        assert!(doubts[1].contains("`constant` emitter"), "{doubts:?}");
    }
}
