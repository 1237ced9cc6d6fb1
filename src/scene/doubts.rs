//! What is legal in a scene and probably not meant.

use glam::{DVec3, Vec3};

use super::{Emitter, Geometry, Material, Mesh, Projection, Rgb, SceneDescription, Shape};

/// Something that is probably not meant. Numbers are places in the description's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The shape shines, without power.
    DarkShape(usize),
    /// The emitter has no power.
    DarkEmitter(usize),
    /// The camera is inside of the shape, and no light passes its wall.
    AroundCamera(usize),
}

/// How far from a whole number the winding number of a closed mesh may be: single-precision positions, added
/// up in double precision.
const CLOSED: f64 = 1e-3;

impl SceneDescription {
    /// What is probably not meant.
    pub fn doubts(&self) -> Vec<Doubt> {
        let dark = (0..self.shapes.len()).filter(|&i| self.shapes[i].radiance == Some(Rgb::ZERO));
        let powerless = (0..self.emitters.len()).filter(|&i| has_no_power(&self.emitters[i]));
        let eye = self.sensor.to_world.translation;
        let sees = !matches!(self.sensor.projection, Projection::IrradianceMeter { .. });
        let around = (0..self.shapes.len()).filter(|&i| sees && self.encloses(&self.shapes[i], eye));
        let (dark, powerless) = (dark.map(Doubt::DarkShape), powerless.map(Doubt::DarkEmitter));
        dark.chain(powerless).chain(around.map(Doubt::AroundCamera)).collect()
    }

    /// Is the point inside of a closed, opaque shape in which it is dark?
    fn encloses(&self, shape: &Shape, point: DVec3) -> bool {
        let is_opaque = |material: &Material| !material.transmits();
        let material = self.materials.get(shape.material.0 as usize).filter(|&material| is_opaque(material));
        let Some(material) = material else { return false };
        if shape.radiance.is_some() || shape.flip_normals || !shape.contains(point) {
            return false;
        }
        // A shape that others are in is a room, and so is one with a lamp and an inner side to shine on.
        let others = || self.shapes.iter().filter(|other| !std::ptr::eq(*other, shape));
        let holds_another = || others().any(|other| shape.contains(other.middle()));
        let is_lit = || self.emitters.iter().filter_map(place).any(|lamp| shape.contains(lamp));
        !(holds_another() || material.has_two_sides() && is_lit())
    }
}

/// Where an emitter stands, if it stands anywhere.
fn place(emitter: &Emitter) -> Option<DVec3> {
    match emitter {
        Emitter::Point { position, .. } | Emitter::Spot { position, .. } => Some(*position),
        Emitter::Directional { .. }
        | Emitter::Constant { .. }
        | Emitter::Envmap { .. }
        | Emitter::Sh { .. } => None,
    }
}

impl Shape {
    /// Is the point behind all of the surface, and that closed? A box is looked at before triangles are.
    fn contains(&self, point: DVec3) -> bool {
        let local = self.to_world.inverse().transform_point3(point);
        match &self.geometry {
            Geometry::Sphere { center, radius } => (local - *center).length() < *radius,
            Geometry::Cube => local.abs().max_element() < 1.0,
            Geometry::Mesh { mesh, .. } => {
                let winding = if mesh.box_contains(local) { mesh.winding(local) } else { 0.0 };
                let turned = winding * self.to_world.matrix3.determinant().signum();
                turned > 0.5 && (turned - turned.round()).abs() < CLOSED
            }
            Geometry::Rectangle | Geometry::Disk | Geometry::Cylinder { .. } => false,
        }
    }

    /// A point in its middle, in the world.
    fn middle(&self) -> DVec3 {
        self.to_world.transform_point3(match &self.geometry {
            Geometry::Sphere { center, .. } => *center,
            Geometry::Cylinder { p0, p1, .. } => 0.5 * (*p0 + *p1),
            Geometry::Mesh { mesh, .. } => {
                let [min, max] = mesh.bounds();
                0.5 * (min.as_dvec3() + max.as_dvec3())
            }
            Geometry::Rectangle | Geometry::Disk | Geometry::Cube => DVec3::ZERO,
        })
    }
}

impl Mesh {
    fn bounds(&self) -> [Vec3; 2] {
        let first = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        self.positions.iter().fold(first, |[min, max], p| [min.min(*p), max.max(*p)])
    }

    fn box_contains(&self, point: DVec3) -> bool {
        let [min, max] = self.bounds();
        point.cmpgt(min.as_dvec3()).all() && point.cmplt(max.as_dvec3()).all()
    }

    /// How often the surface goes round the point, counted where its normals look away from it: the solid
    /// angles of its triangles \[VS83\] over 4π.
    fn winding(&self, point: DVec3) -> f64 {
        let solid_angle = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|i| self.positions[i as usize].as_dvec3() - point);
            let [x, y, z] = [a.length(), b.length(), c.length()];
            let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
            2.0 * a.dot(b.cross(c)).atan2(below)
        };
        self.triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
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
    use std::sync::Arc;

    use super::*;
    use crate::scene::{MaterialIndex, Texture};

    fn shape(geometry: Geometry, at: f64) -> Shape {
        Shape {
            name: "shape".into(),
            geometry,
            to_world: glam::DAffine3::from_translation(DVec3::new(0.0, 0.0, at)),
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        }
    }

    fn ball(at: f64, radius: f64) -> Shape {
        shape(Geometry::Sphere { center: DVec3::ZERO, radius }, at)
    }

    /// Around the origin, with normals that look outwards.
    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![
                Vec3::new(1.0, 1.0, 1.0),
                Vec3::new(1.0, -1.0, -1.0),
                Vec3::new(-1.0, 1.0, -1.0),
                Vec3::new(-1.0, -1.0, 1.0),
            ],
            triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
            ..Mesh::default()
        }
    }

    fn solid(mesh: Mesh) -> Shape {
        shape(Geometry::Mesh { mesh: Arc::new(mesh), face_normals: false }, 0.0)
    }

    fn scene(shapes: Vec<Shape>) -> SceneDescription {
        SceneDescription { shapes, materials: vec![Material::default()], ..SceneDescription::default() }
    }

    #[test]
    fn a_camera_in_a_ball_sees_nothing() {
        assert_eq!(scene(vec![ball(5.0, 1.0), ball(0.0, 1.0)]).doubts(), [Doubt::AroundCamera(1)]);
        assert!(scene(vec![ball(5.0, 1.0)]).doubts().is_empty());
        // A ball with something in it is a room, and one of glass is a drop.
        assert!(scene(vec![ball(0.0, 9.0), ball(5.0, 1.0)]).doubts().is_empty());
        let mut drop = scene(vec![ball(0.0, 1.0)]);
        let white = Texture::Constant(Rgb::ONE);
        drop.materials[0] = Material::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white.clone(),
            specular_transmittance: white,
        };
        assert!(drop.doubts().is_empty());
    }

    #[test]
    fn a_camera_in_a_closed_mesh_sees_nothing() {
        assert_eq!(scene(vec![solid(tetrahedron())]).doubts(), [Doubt::AroundCamera(0)]);
        // Beside it, though in its box.
        let mut beside = scene(vec![solid(tetrahedron())]);
        beside.sensor.to_world.translation = DVec3::new(0.9, 0.9, -0.9);
        assert!(beside.doubts().is_empty());
        // A mesh with a hole has no inside, and one whose faces look inwards is a room.
        let mut open = tetrahedron();
        open.triangles.pop();
        assert!(scene(vec![solid(open)]).doubts().is_empty());
        let mut room = tetrahedron();
        room.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        assert!(scene(vec![solid(room)]).doubts().is_empty());
        // A lamp shines on walls that have an inner side, and on no others.
        let mut lit = scene(vec![solid(tetrahedron())]);
        lit.emitters = vec![Emitter::Point { position: DVec3::splat(0.1), intensity: Rgb::ONE }];
        assert_eq!(lit.doubts().len(), 1);
        lit.materials[0] = Material::TwoSided { front: Box::new(Material::default()), back: None };
        assert!(lit.doubts().is_empty());
    }

    #[test]
    fn lights_without_power_are_told() {
        let mut lamp = ball(5.0, 1.0);
        lamp.radiance = Some(Rgb::ZERO);
        let mut scene = scene(vec![lamp]);
        scene.emitters =
            vec![Emitter::Constant { radiance: Rgb::ONE }, Emitter::Constant { radiance: Rgb::ZERO }];
        assert_eq!(scene.doubts(), [Doubt::DarkShape(0), Doubt::DarkEmitter(1)]);
    }
}
