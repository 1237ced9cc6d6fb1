//! Samples that are not finite, or too great for a sum: counted, kept out of the picture, and shown by themselves.

#![allow(missing_docs)]

use glam::DVec3;
use packlight::{
    compile::compile,
    film::GREATEST,
    render::{Backend, Settings, render, replay},
    scene::{
        Emitter, Film, Geometry, Integrator, Material, MaterialIndex, Rgb, SceneDescription, Shape, Texture,
    },
};

/// A wall, and before it a point so bright that no sum could hold what reaches the middle.
fn dazzling(integrator: Integrator) -> SceneDescription {
    let mut scene = SceneDescription { integrator, ..SceneDescription::default() };
    scene.sensor.film = Film::new(40, 24);
    scene.sensor.sampler.sample_count = 5;
    scene.materials = vec![Material::Diffuse { reflectance: Texture::Constant(Rgb::splat(0.5)) }];
    scene.shapes = vec![Shape {
        name: "wall".into(),
        geometry: Geometry::Rectangle,
        to_world: glam::DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0))
            * glam::DAffine3::from_rotation_y(std::f64::consts::PI)
            * glam::DAffine3::from_scale(DVec3::splat(3.0)),
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: None,
    }];
    let (position, intensity) = (DVec3::new(0.3, 0.2, 4.7), Rgb::new(1e29, 5e28, 1.0));
    scene.emitters = vec![Emitter::Point { position, intensity }];
    scene
}

fn integrators() -> [Integrator; 4] {
    [
        Integrator::Path { max_depth: Some(4), rr_depth: 5, hide_emitters: false },
        Integrator::Direct { hide_emitters: false },
        Integrator::Whitted { max_depth: 4 },
        Integrator::Irradiance { max_depth: Some(4), rr_depth: 5 },
    ]
}

#[test]
fn every_integrator_keeps_them_out_and_finds_them_again() {
    for integrator in integrators() {
        let scene = compile(&dazzling(integrator.clone())).expect("the scene compiles");
        for backend in [Backend::Packet, Backend::Scalar] {
            let settings = Settings { backend, ..Settings::default() };
            let rendered = render(&scene, &settings, &|_| {});
            let statistics = rendered.statistics;
            assert!((100..4000).contains(&statistics.invalid_samples), "{integrator:?} {statistics:?}");
            for channel in &rendered.picture.channels {
                assert!(channel.samples.iter().all(|sample| sample.is_finite()), "{integrator:?}");
            }
            let (x, y, sample) = statistics.first_invalid.expect("one is the first");
            let replayed = replay(&scene, &settings, (x, y), sample);
            assert!(replayed.iter().any(|(_, value)| *value > GREATEST), "{integrator:?} {replayed:?}");
        }
    }
}
