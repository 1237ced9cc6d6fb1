//! Pictures of a material made by the renderer itself: a lit sphere, and its lobe as a solid.

use std::sync::Arc;

use glam::{DAffine2, DAffine3, DMat3, DVec2, DVec3, Vec3};

use super::{Swatch, curves::in_plane, solid};
use crate::{
    compile::{CompileError, compile},
    picture::{Channel, Picture},
    render::{Settings, render},
    scene::{
        Emitter, Film, Filter, Geometry, Integrator, Material, MaterialIndex, Projection, Rgb, Sampler,
        SceneDescription, Sensor, Shape, Texture, Wrap,
    },
};

/// How a portrait is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Exposure {
    /// Columns and rows.
    pub(super) side: u32,
    /// Samples a pixel.
    pub(super) samples: u32,
}

/// A sphere of the material before a chequered wall, under a soft box, a strip and a grey sky. The sphere's
/// axis leans to the viewer, so that brushed materials show which way they are brushed.
pub(super) fn sphere(material: &Material, exposure: Exposure) -> Result<Picture, CompileError> {
    let mut set = Set::default();
    let at = |x: f64, y: f64, z: f64| DAffine3::from_translation(DVec3::new(x, y, z));
    let wall = set.material(Material::Diffuse {
        reflectance: Texture::Checkerboard {
            color0: Rgb::new(0.5, 0.48, 0.45),
            color1: Rgb::new(0.3, 0.29, 0.28),
            to_uv: DAffine2::from_scale(DVec2::splat(6.0)),
        },
    });
    set.shape(Geometry::Rectangle, at(0.0, 0.0, -1.7) * DAffine3::from_scale(DVec3::splat(6.0)), wall);
    let ball = set.material(material.clone());
    let unit = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0 };
    set.shape(unit, DAffine3::from_rotation_x(-1.22), ball);
    set.lamp(DVec3::new(-6.0, 9.0, 12.0), (5.0, 3.0), Rgb::new(6.0, 5.7, 5.2));
    set.lamp(DVec3::new(12.0, 0.0, 8.0), (0.6, 6.0), Rgb::new(5.0, 5.5, 6.5));
    set.sky(Rgb::new(0.42, 0.43, 0.45));
    set.taken(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO, 16.0, exposure)
}

/// Where light from `light` degrees goes, as a solid on a disc: the distance from its middle is
/// f |cos θ_o|, by the brightest direction. Delta lobes are rods as long as their share of the light.
pub(super) fn lobe(swatch: &Swatch, light: f32, exposure: Exposure) -> Result<Picture, CompileError> {
    let mut set = Set::default();
    let to_light = in_plane(-light);
    if let Some(solid) = solid::Solid::new(swatch, to_light) {
        let reflectance = bitmap(solid.colors);
        let skin = set.material(two_sided(Material::Diffuse { reflectance }));
        let mesh = Geometry::Mesh { mesh: Arc::new(solid.mesh), face_normals: false };
        set.shape(mesh, DAffine3::IDENTITY, skin);
    }
    let rod = set.matte(Rgb::new(0.75, 0.12, 0.05));
    let branches = swatch.seen_from::<f32>(to_light.into()).branches();
    for branch in branches.into_iter().filter(|branch| branch.valid) {
        let length = Vec3::from(branch.weight).max_element();
        if length > 0.0 {
            set.rod(DVec3::ZERO, Vec3::from(branch.wi).as_dvec3() * f64::from(length), 0.014, rod);
        }
    }
    let ray = set.matte(Rgb::new(0.85, 0.55, 0.02));
    set.rod(to_light.as_dvec3() * 0.04, to_light.as_dvec3() * 1.25, 0.011, ray);
    let disc = Material::Diffuse { reflectance: bitmap(dial()) };
    let disc = match swatch.transmits() {
        true => {
            Material::Mask { opacity: Texture::Constant(Rgb::splat(0.45)), nested: Box::new(two_sided(disc)) }
        }
        false => two_sided(disc),
    };
    let disc = set.material(disc);
    set.shape(Geometry::Disk, DAffine3::from_scale(DVec3::splat(1.05)), disc);
    set.lamp(DVec3::new(-1.5, -6.0, 7.0), (1.6, 1.6), Rgb::splat(9.0));
    set.sky(Rgb::ONE);
    let target = DVec3::new(0.0, 0.0, if swatch.transmits() { 0.0 } else { 0.3 });
    set.taken(target + DVec3::new(2.0, -5.6, 2.6), target, 22.5, exposure)
}

fn two_sided(front: Material) -> Material {
    Material::TwoSided { front: Box::new(front), back: None }
}

fn bitmap(picture: Picture) -> Texture {
    Texture::Bitmap {
        picture: Arc::new(picture),
        filter: Filter::Bilinear,
        wrap: Wrap::Clamp,
        to_uv: DAffine2::IDENTITY,
    }
}

/// Rings at quarters of the radius and spokes every thirty degrees, over (radius, angle).
fn dial() -> Picture {
    let (width, height) = (256, 720);
    let near = |x: f64, width: f64| (x - x.round()).abs() < width;
    let value = |i: usize| {
        let (radius, turn) = ((i % width) as f64 / width as f64, (i / width) as f64 / height as f64);
        let on_ring = near(radius * 4.2, 0.02);
        let on_spoke = near(turn * 12.0, 0.016 / radius.max(0.05));
        if on_ring || on_spoke { 0.2 } else { 0.42 }
    };
    let samples: Vec<f32> = (0..width * height).map(value).collect();
    let channel = |name: &str| Channel { name: name.into(), samples: samples.clone() };
    Picture {
        width: width as u32,
        height: height as u32,
        channels: ["R", "G", "B"].map(channel).into(),
        place: None,
    }
}

/// A scene in the making.
#[derive(Default)]
struct Set(SceneDescription);

impl Set {
    fn material(&mut self, material: Material) -> MaterialIndex {
        self.0.materials.push(material);
        MaterialIndex(self.0.materials.len() as u32 - 1)
    }

    fn matte(&mut self, reflectance: Rgb) -> MaterialIndex {
        self.material(two_sided(Material::Diffuse { reflectance: Texture::Constant(reflectance) }))
    }

    fn shape(&mut self, geometry: Geometry, to_world: DAffine3, material: MaterialIndex) {
        let name = String::new();
        self.0.shapes.push(Shape { name, geometry, to_world, flip_normals: false, material, radiance: None });
    }

    fn rod(&mut self, p0: DVec3, p1: DVec3, radius: f64, material: MaterialIndex) {
        self.shape(Geometry::Cylinder { p0, p1, radius }, DAffine3::IDENTITY, material);
        let tip = Geometry::Sphere { center: p1, radius: radius * 2.2 };
        self.shape(tip, DAffine3::IDENTITY, material);
    }

    /// A rectangle that shines on the origin.
    fn lamp(&mut self, place: DVec3, (width, height): (f64, f64), radiance: Rgb) {
        let black = self.matte(Rgb::ZERO);
        let to_world = looking(place, DVec3::ZERO) * DAffine3::from_scale(DVec3::new(width, height, 1.0));
        self.shape(Geometry::Rectangle, to_world, black);
        if let Some(lamp) = self.0.shapes.last_mut() {
            lamp.radiance = Some(radiance);
        }
    }

    fn sky(&mut self, radiance: Rgb) {
        self.0.emitters.push(Emitter::Constant { radiance });
    }

    /// The picture of it; `fov` in degrees.
    fn taken(
        mut self,
        from: DVec3,
        target: DVec3,
        fov: f64,
        exposure: Exposure,
    ) -> Result<Picture, CompileError> {
        self.0.integrator = Integrator::Path { max_depth: Some(8), rr_depth: 5, hide_emitters: false };
        self.0.sensor = Sensor {
            to_world: looking(from, target),
            projection: Projection::Perspective { x_fov: fov.to_radians() },
            film: Film::new(exposure.side, exposure.side),
            sampler: Sampler { sample_count: exposure.samples, seed: 0 },
            ..Sensor::default()
        };
        let scene = compile(&self.0)?;
        Ok(render(&scene, &Settings::default(), &|_| {}).picture)
    }
}

/// Local z towards `target`, local y as far up as it can be; up is y, or z where the view is along y.
fn looking(from: DVec3, target: DVec3) -> DAffine3 {
    let forward = (target - from).normalize();
    let up = if forward.z.abs() > forward.y.abs() { DVec3::Y } else { DVec3::Z };
    let left = up.cross(forward).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(left, forward.cross(left), forward), from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_a_rotation() {
        for from in [DVec3::new(0.0, 0.0, 9.0), DVec3::new(2.0, -5.6, 3.0), DVec3::new(0.1, -9.0, 0.0)] {
            let view = looking(from, DVec3::ZERO);
            assert!((view.matrix3.determinant() - 1.0).abs() < 1e-12);
            assert!(
                (view.matrix3 * view.matrix3.transpose() - DMat3::IDENTITY).abs_diff_eq(DMat3::ZERO, 1e-12)
            );
            assert!((view.transform_vector3(DVec3::Z) * from.length() + from).length() < 1e-12);
        }
    }
}
