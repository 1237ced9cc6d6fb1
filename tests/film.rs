//! Lenses, filters and crops, seen in pictures.

#![allow(missing_docs)]

use packlight::{
    compile::compile,
    picture::Picture,
    render::{Settings, render},
    scene::{
        Crop, Emitter, Film, Geometry, Integrator, Material, MaterialIndex, Projection, ReconstructionFilter,
        Rgb, SceneDescription, Shape, Texture,
    },
};

/// A lamp of radiance 1 that fills the middle of the picture, before nothing.
fn lamp(projection: Projection) -> SceneDescription {
    let integrator = Integrator::Path { max_depth: Some(2), rr_depth: 5, hide_emitters: false };
    let mut scene = SceneDescription { integrator, ..SceneDescription::default() };
    scene.sensor.projection = projection;
    scene.sensor.film = Film::new(48, 32);
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

/// A grey square alone under a sky of radiance 1 sends its albedo, whether the sky is chosen as a light or found by
/// a ray that leaves the square; hidden, it is black where the camera sees it.
#[test]
fn a_hidden_sky_still_lights() {
    for integrator in [
        Integrator::Path { max_depth: Some(3), rr_depth: 5, hide_emitters: true },
        Integrator::Direct { hide_emitters: true },
    ] {
        let mut scene = lamp(Projection::Perspective { x_fov: 0.9 });
        scene.integrator = integrator;
        scene.shapes[0].radiance = None;
        scene.materials = vec![Material::Diffuse { reflectance: Texture::Constant(Rgb::splat(0.5)) }];
        scene.emitters = vec![Emitter::Constant { radiance: Rgb::ONE }];
        let picture = rendered(&scene);
        assert!(row(&picture, 1).iter().all(|&x| x == 0.0), "{:?}: {:?}", scene.integrator, row(&picture, 1));
        let square: Vec<f32> = (12..20).flat_map(|y| row(&picture, y)[20..28].to_vec()).collect();
        let mean = square.iter().sum::<f32>() / square.len() as f32;
        assert!((mean - 0.5).abs() < 0.01, "{:?}: {mean}", scene.integrator);
    }
}

type Curve = Box<dyn Fn(f64) -> f64>;

/// Every filter with other parameters than its own, how far it reaches, and f at x ≥ 0.
fn filters() -> Vec<(ReconstructionFilter, f64, Curve)> {
    let cubic = |b: f64, c: f64| {
        move |x: f64| match x < 1.0 {
            true => {
                ((12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x * x + 6.0
                    - 2.0 * b)
                    / 6.0
            }
            false => {
                ((-b - 6.0 * c) * x.powi(3) + (6.0 * b + 30.0 * c) * x * x - (12.0 * b + 48.0 * c) * x
                    + 8.0 * b
                    + 24.0 * c)
                    / 6.0
            }
        }
    };
    let sinc =
        |x: f64| if x == 0.0 { 1.0 } else { (x * std::f64::consts::PI).sin() / (x * std::f64::consts::PI) };
    vec![
        (ReconstructionFilter::Box, 0.5, Box::new(|_| 1.0)),
        (ReconstructionFilter::Tent { radius: 1.5 }, 1.5, Box::new(|x| 1.5 - x)),
        (
            ReconstructionFilter::Gaussian { stddev: 0.6 },
            2.4,
            Box::new(|x| (-x * x / 0.72).exp() - (-8.0f64).exp()),
        ),
        (ReconstructionFilter::Mitchell { b: 0.2, c: 0.4 }, 2.0, Box::new(cubic(0.2, 0.4))),
        (ReconstructionFilter::CatmullRom, 2.0, Box::new(cubic(0.0, 0.5))),
        (ReconstructionFilter::Lanczos { lobes: 3 }, 3.0, Box::new(move |x| sinc(x) * sinc(x / 3.0))),
    ]
}

/// ∫f from −`radius` to `end` over ∫f.
fn share_below(end: f64, radius: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 * radius - radius;
    let sum = |most: f64| (0..n).map(at).filter(|&x| x < most).map(|x| f(x.abs())).sum::<f64>();
    sum(end) / sum(radius)
}

#[test]
fn an_edge_is_the_integral_of_the_filter() {
    // The lamp covers camera x < 0.0125 of [-1, 1], which is on the right: an edge at pixel 15.8 of 32.
    let mut scene = lamp(Projection::Orthographic);
    scene.sensor.film = Film::new(32, 1);
    scene.sensor.sampler.sample_count = 1 << 15;
    scene.shapes[0].to_world = glam::DAffine3::from_translation(glam::DVec3::new(0.0125 - 8.0, 0.0, 6.0))
        * glam::DAffine3::from_scale(glam::DVec3::new(8.0, 8.0, 1.0))
        * glam::DAffine3::from_rotation_y(std::f64::consts::PI);
    for (filter, radius, f) in filters() {
        scene.sensor.film.filter = filter;
        let picture = rendered(&scene);
        for (x, &value) in row(&picture, 0).iter().enumerate() {
            // The part of the filter that lies right of the edge.
            let edge = x as f64 + 0.5 - 15.8;
            let want = share_below(edge, radius, &*f);
            assert!((f64::from(value) - want).abs() < 1e-3, "{filter:?}, pixel {x}: {value}, not {want}");
        }
    }
}

#[test]
fn what_is_the_same_everywhere_stays_the_same() {
    let mut scene = lamp(Projection::Orthographic);
    scene.shapes.clear();
    scene.emitters = vec![Emitter::Constant { radiance: Rgb::new(0.7, 1.0, 3.0) }];
    for spp in [1, 2, 3, 64] {
        scene.sensor.sampler.sample_count = spp;
        for (filter, ..) in filters().into_iter().take(3) {
            scene.sensor.film.filter = filter;
            let picture = rendered(&scene);
            let close = |x: f32, want: f32| (x - want).abs() < 1e-5;
            assert!(picture.channels[0].samples.iter().all(|&x| close(x, 0.7)), "{filter:?}, {spp}");
            assert!(picture.channels[2].samples.iter().all(|&x| close(x, 3.0)), "{filter:?}, {spp}");
        }
    }
    // With negative lobes too, once samples are many enough to weigh something.
    for (filter, ..) in filters() {
        scene.sensor.film.filter = filter;
        assert!(rendered(&scene).channels[1].samples.iter().all(|&x| x == 1.0), "{filter:?}");
    }
}

#[test]
fn a_crop_is_a_part_of_the_whole_to_the_bit() {
    let mut scene = lamp(Projection::ThinLens { x_fov: 0.9, aperture_radius: 0.4, focus_distance: 3.0 });
    scene.sensor.film = Film { filter: ReconstructionFilter::Gaussian { stddev: 0.5 }, ..Film::new(80, 48) };
    let whole = rendered(&scene);
    let crop = Crop { x: 13, y: 7, width: 41, height: 35 };
    scene.sensor.film.crop = Some(crop);
    let part = rendered(&scene);
    assert_eq!((part.width, part.height), (41, 35));
    for y in 0..crop.height {
        let bits = |row: &[f32]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(
            bits(row(&part, y)),
            bits(&row(&whole, y + crop.y)[crop.x as usize..][..crop.width as usize])
        );
    }
    assert!(part.channels[0].samples.iter().any(|&x| x > 0.0 && x < 1.0), "nothing is to be seen");
}
