//! A mesh without a scene around it: coloured by its own materials, framed and lit.

use std::{f64::consts::FRAC_PI_2, path::Path, sync::Arc};

use glam::{DAffine3, DMat3, DVec3, Vec2};

use super::{LoadError, Warning, is_obj, obj, obj_materials::Library, ply};
use crate::scene::{
    Emitter, Film, Geometry, Integrator, Material, MaterialIndex, Mesh, Projection, Rgb, Sampler,
    SceneDescription, Sensor, Shape, Texture,
};

/// A scene that shows the mesh of an `.obj` or `.ply` file.
pub(super) fn describe(path: &Path, warnings: &mut Vec<Warning>) -> Result<SceneDescription, LoadError> {
    if is_obj(path) {
        let mut scene = unlit();
        describe_obj(path, &mut scene, warnings)?;
        Ok(shown(scene))
    } else {
        let mesh = ply::read_mesh(path, warnings)?;
        Ok(describe_mesh(path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), mesh))
    }
}

/// A scene that shows a mesh.
pub(super) fn describe_mesh(name: String, mesh: Mesh) -> SceneDescription {
    let mut scene = unlit();
    scene.materials.push(neutral());
    scene.shapes.push(shape(name, mesh, MaterialIndex(0), None));
    shown(scene)
}

fn unlit() -> SceneDescription {
    SceneDescription { integrator: Integrator::Direct { hide_emitters: false }, ..Default::default() }
}

/// With a camera that sees all of it, and light.
fn shown(mut scene: SceneDescription) -> SceneDescription {
    scene.sensor = frame(Ball::around(&scene.shapes));
    scene.emitters = light(&scene.sensor);
    scene
}

/// One shape a material. Textures of OBJ files count v upwards, the pictures' rows run downwards.
fn describe_obj(
    path: &Path,
    scene: &mut SceneDescription,
    warnings: &mut Vec<Warning>,
) -> Result<(), LoadError> {
    let (parts, names) = obj::read_parts(path, warnings)?;
    let mut library = Library::read(path, &names, warnings)?;
    for obj::Part { material, mut mesh } in parts {
        for Vec2 { y: v, .. } in &mut mesh.uvs {
            *v = 1.0 - *v;
        }
        let name = material.unwrap_or_default();
        let (reflection, radiance) = match library.material(&name, warnings) {
            Some((material, radiance)) => (two_sided(material), radiance),
            None => (neutral(), None),
        };
        let index = MaterialIndex(scene.materials.len() as u32);
        scene.materials.push(reflection);
        scene.shapes.push(shape(name, mesh, index, radiance));
    }
    Ok(())
}

/// Meshes from the wild are open, or turned inside out.
fn two_sided(front: Material) -> Material {
    Material::TwoSided { front: Box::new(front), back: None }
}

fn neutral() -> Material {
    two_sided(Material::Diffuse { reflectance: Texture::Constant(Rgb::splat(0.6)) })
}

fn shape(name: String, mesh: Mesh, material: MaterialIndex, radiance: Option<Rgb>) -> Shape {
    Shape {
        name,
        geometry: Geometry::Mesh { mesh: Arc::new(mesh), face_normals: false },
        to_world: DAffine3::IDENTITY,
        flip_normals: false,
        material,
        radiance,
    }
}

/// A sphere about everything, not the smallest: its centre is that of the bounding box.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn around(shapes: &[Shape]) -> Self {
        // Vertices that no triangle uses are not seen and must not push the camera away.
        let corners = || {
            let meshes = shapes.iter().filter_map(|shape| match &shape.geometry {
                Geometry::Mesh { mesh, .. } => Some(mesh),
                _ => None,
            });
            meshes.flat_map(|mesh| {
                mesh.triangles.iter().flatten().map(|&index| mesh.positions[index as usize].as_dvec3())
            })
        };
        let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = corners().fold(infinite, |(low, high), p| (low.min(p), high.max(p)));
        let center = (low + high) / 2.0;
        let radius = corners().map(|p| p.distance(center)).fold(0.0, f64::max);
        // A mesh that is a single point still gets a camera.
        Self { center, radius: if radius > 0.0 { radius } else { 1.0 } }
    }
}

/// From the front, the right and slightly above; the ball just fits the height of the picture.
fn frame(Ball { center, radius }: Ball) -> Sensor {
    const X_FOV: f64 = 40.0 / 90.0 * FRAC_PI_2;
    let film = Film::new(800, 600);
    let half_height = (X_FOV / 2.0).tan() * f64::from(film.height) / f64::from(film.width);
    let distance = 1.02 * radius / half_height.atan().sin();

    let dir = -DVec3::new(0.55, 0.4, 1.0).normalize();
    let left = DVec3::Y.cross(dir).normalize();
    let axes = DMat3::from_cols(left, dir.cross(left), dir);
    Sensor {
        to_world: DAffine3::from_mat3_translation(axes, center - distance * dir),
        projection: Projection::Perspective { x_fov: X_FOV },
        near_clip: (distance - radius) / 2.0,
        far_clip: (distance + radius) * 2.0,
        film,
        sampler: Sampler { sample_count: 16, seed: 0 },
    }
}

/// A soft white sky, and a key light over the left shoulder of whoever looks.
fn light(sensor: &Sensor) -> Vec<Emitter> {
    let from = DVec3::new(0.6, 0.8, -0.7);
    let direction = -sensor.to_world.transform_vector3(from).normalize();
    vec![
        Emitter::Constant { radiance: Rgb::splat(0.4) },
        Emitter::Directional { direction, irradiance: Rgb::splat(2.5) },
    ]
}

#[cfg(test)]
mod tests {
    use std::{fs, path::PathBuf};

    use super::*;

    const TRIANGLES: &str = "v 10 0 0\nv 14 0 0\nv 10 3 1\nv 99 99 99\nvt 0.25 0.125\n";

    fn scene(files: &[(&str, &str)]) -> (SceneDescription, Vec<Warning>) {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let mut warnings = Vec::new();
        let path: PathBuf = folder.path().join(files[0].0);
        (describe(&path, &mut warnings).unwrap(), warnings)
    }

    fn front(material: &Material) -> &Material {
        match material {
            Material::TwoSided { front, back: None } => front,
            other => panic!("{other:?} is not two-sided"),
        }
    }

    #[test]
    fn everything_seen_is_in_the_picture() {
        let (scene, _) = scene(&[("a.obj", &format!("{TRIANGLES}f 1 2 3\n"))]);
        let sensor = &scene.sensor;
        let Projection::Perspective { x_fov } = sensor.projection else { panic!("no perspective") };
        let to_camera = sensor.to_world.inverse();
        let ball = Ball::around(&scene.shapes);
        assert_eq!(ball.center, DVec3::new(12.0, 1.5, 0.5));
        let half = DVec3::new((x_fov / 2.0).tan(), (x_fov / 2.0).tan() * 0.75, 1.0);
        for offset in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z] {
            let p = to_camera.transform_point3(ball.center) + offset * ball.radius;
            assert!(p.z > sensor.near_clip && p.z < sensor.far_clip, "{p}");
            assert!(p.x.abs() < half.x * p.z && p.y.abs() < half.y * p.z, "{p}");
        }
    }

    #[test]
    fn the_camera_stands_upright_and_in_front() {
        let sensor = frame(Ball { center: DVec3::ZERO, radius: 1.0 });
        let axes = sensor.to_world.matrix3;
        assert!((axes.determinant() - 1.0).abs() < 1e-12);
        assert!(axes.x_axis.y.abs() < 1e-12 && axes.y_axis.y > 0.8);
        assert!(sensor.to_world.translation.normalize().dot(axes.z_axis) < -0.999);
        // +X is left: seen from +z, that is world -x.
        assert!(axes.x_axis.x < 0.0 && sensor.to_world.translation.z > 0.0);
        let Emitter::Directional { direction, .. } = light(&sensor)[1] else { panic!("no key light") };
        let seen = axes.transpose() * direction;
        assert!(seen.x < 0.0 && seen.y < 0.0 && seen.z > 0.0, "not from the upper left: {seen}");
    }

    #[test]
    fn scale_changes_nothing_but_distances() {
        for scale in [1e-4, 1e6] {
            let (one, other) = (
                frame(Ball { center: DVec3::ONE, radius: 1.0 }),
                frame(Ball { center: DVec3::ONE, radius: scale }),
            );
            assert!((other.near_clip / one.near_clip / scale - 1.0).abs() < 1e-9);
            assert!((other.far_clip / one.far_clip / scale - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_mesh_without_materials_is_grey() {
        let (scene, warnings) = scene(&[("a.obj", &format!("{TRIANGLES}f 1/1 2/1 3/1\n"))]);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(scene.materials, [neutral()]);
        let Geometry::Mesh { mesh, .. } = &scene.shapes[0].geometry else { panic!("no mesh") };
        assert_eq!(mesh.uvs[0], Vec2::new(0.25, 0.875));
    }

    #[test]
    fn materials_become_shapes() {
        let faces = "mtllib a.mtl\nusemtl matt\nf 1 2 3\nusemtl shiny\nf 1 2 3\nusemtl lamp\nf 1 2 3\n";
        let library = "newmtl shiny\nKd .8 .1 .1\nKs .8 .4 .4\nNs 30\nnewmtl lamp\nKe 5 4 3\n\
                       newmtl matt\nKd 0 1 0\nKs 1 1 1\nNs 1\nmap_Kd missing.png\n";
        let (scene, warnings) = scene(&[("a.obj", &format!("{TRIANGLES}{faces}")), ("a.mtl", library)]);
        let green = Texture::Constant(Rgb::new(0.0, 1.0, 0.0));
        assert_eq!(front(&scene.materials[0]), &Material::Diffuse { reflectance: green });
        let Material::Phong {
            diffuse_reflectance,
            specular_reflectance,
            exponent: Texture::Constant(Rgb { x: 30.0, .. }),
        } = front(&scene.materials[1])
        else {
            panic!("{:?} is not Phong", scene.materials[1])
        };
        assert_eq!(diffuse_reflectance, &Texture::Constant(Rgb::new(0.8, 0.1, 0.1) / 1.6));
        assert_eq!(specular_reflectance, &Texture::Constant(Rgb::new(0.8, 0.4, 0.4) / 1.6));
        assert_eq!(scene.shapes[2].radiance, Some(Rgb::new(5.0, 4.0, 3.0)));
        assert_eq!(scene.shapes[0].radiance, None);
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].to_string().contains("missing.png"), "{warnings:?}");
    }

    #[test]
    fn a_missing_library_or_material_is_a_warning() {
        let text = format!("mtllib no.mtl\n{TRIANGLES}usemtl red\nf 1 2 3\n");
        let (scene, warnings) = scene(&[("a.obj", &text)]);
        assert_eq!(scene.materials, [neutral()]);
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].message().contains("no.mtl") && warnings[1].message().contains("`red`"));
    }
}
