//! One sphere under a lamp and a sky: `cargo run --release --example one_sphere [OUT]`.

use packlight::{compile::compile, picture, render, scene::*};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args().nth(1).unwrap_or_else(|| "one_sphere.png".into());
    let sphere = Shape {
        name: "sphere".into(),
        geometry: Geometry::Sphere { center: glam::DVec3::ZERO, radius: 1.0 },
        to_world: glam::DAffine3::IDENTITY,
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: None,
    };
    let description = SceneDescription {
        // It looks along +z, with +y upwards and +x to the left.
        sensor: Sensor {
            to_world: glam::DAffine3::from_translation(glam::dvec3(0.0, 0.0, -4.0)),
            film: Film::new(320, 240),
            sampler: Sampler { sample_count: 64, seed: 0 },
            ..Sensor::default()
        },
        shapes: vec![sphere],
        materials: vec![Material::Diffuse { reflectance: Texture::Constant(Rgb::new(0.8, 0.3, 0.1)) }],
        emitters: vec![
            Emitter::Constant { radiance: Rgb::splat(0.2) },
            Emitter::Point { position: glam::dvec3(3.0, 4.0, -4.0), intensity: Rgb::splat(40.0) },
        ],
        ..SceneDescription::default()
    };
    let scene = compile(&description)?;
    let rendered = render::render(&scene, &render::Settings::default(), &|_| {});
    picture::save(&rendered.picture, out.as_ref(), picture::Preview::default())?;
    println!("{out}: {} rays from the camera", rendered.statistics.camera_rays);
    Ok(())
}
