//! Lenses, filters and crops, seen in pictures.

#![allow(missing_docs)]

use packlight::{
    compile::compile,
    picture::Picture,
    render::{Settings, render},
    scene::{
        Film, Geometry, Integrator, Material, MaterialIndex, Projection, Rgb, SceneDescription, Shape,
        Texture,
    },
};

/// A lamp of radiance 1 that fills the middle of the picture, before nothing.
fn lamp(projection: Projection) -> SceneDescription {
    let mut scene = SceneDescription::default();
    scene.integrator = Integrator::Path { max_depth: Some(2), rr_depth: 5, hide_emitters: false };
    scene.sensor.projection = projection;
    scene.sensor.film = Film { width: 48, height: 32 };
    scene.sensor.sampler.sample_count = 64;
    scene.materials = vec![Material::Diffuse { reflectance: Texture::Constant(Rgb::ZERO) }];
    let towards_camera = glam::DAffine3::from_translation(glam::DVec3::new(0.0, 0.0, 6.0))
        * glam::DAffine3::from_rotation_y(std::f64::consts::PI);
    scene.shapes = vec![Shape {
        name: "lamp".into(),
        geometry: Geometry::Rectangle,
        to_world: towards_camera,
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: Some(Rgb::ONE),
    }];
    scene
}

fn rendered(scene: &SceneDescription) -> Picture {
    let scene = compile(scene).expect("the scene compiles");
    render(&scene, &Settings::default(), &|_| {}).picture
}

/// Of the first channel.
fn row(picture: &Picture, y: u32) -> &[f32] {
    let width = picture.width as usize;
    &picture.channels[0].samples[y as usize * width..][..width]
}

#[test]
fn a_lens_blurs_and_never_raises_radiance() {
    let x_fov = 0.9;
    let pinhole = rendered(&lamp(Projection::Perspective { x_fov }));
    let lens = Projection::ThinLens { x_fov, aperture_radius: 0.4, focus_distance: 3.0 };
    let blurred = rendered(&lamp(lens));
    let partly = |picture: &Picture| row(picture, 16).iter().filter(|&&x| x > 0.0 && x < 1.0).count();
    assert!(partly(&pinhole) <= 2, "{:?}", row(&pinhole, 16));
    assert!(partly(&blurred) >= 6, "{:?}", row(&blurred, 16));
    assert!(blurred.channels[0].samples.iter().all(|&x| (0.0..=1.0).contains(&x)));
    // In the middle the whole aperture sees the lamp: its radiance to the bit.
    assert_eq!(row(&blurred, 16)[24], 1.0);
    // A lamp in focus is as sharp as through a pinhole, and no brighter.
    let lens = Projection::ThinLens { x_fov, aperture_radius: 0.4, focus_distance: 6.0 };
    let sharp = rendered(&lamp(lens));
    assert!(partly(&sharp) <= 2, "{:?}", row(&sharp, 16));
    let sum = |picture: &Picture| picture.channels[0].samples.iter().map(|&x| f64::from(x)).sum::<f64>();
    assert!((sum(&sharp) / sum(&pinhole) - 1.0).abs() < 5e-3, "{} {}", sum(&sharp), sum(&pinhole));
}
