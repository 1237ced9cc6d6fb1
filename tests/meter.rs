//! The light meter against closed forms, within three standard errors.

#![allow(missing_docs)]

use std::{f64::consts::PI, fs};

use glam::Vec3;
use packlight::{
    compile::{Scene, compile},
    load::{LoadOptions, load},
    render::{Backend, Receiver, Settings, meter, render},
};

/// A scene of these lights and shapes, for `path`.
fn scene(body: &str) -> Scene {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    let text = format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><film type='hdrfilm'>\
         <integer name='width' value='8'/><integer name='height' value='8'/><rfilter type='box'/></film>\
         </sensor>{body}</scene>"
    );
    fs::write(&path, text).expect("the folder for temporary files can be written");
    compile(&load(&path, &LoadOptions::default()).expect(body).description).expect(body)
}

/// Irradiance at the origin, seen along +z: (mean, standard error).
fn read(body: &str) -> (f64, f64) {
    let receiver = Receiver::Point { position: Vec3::ZERO, normal: Vec3::Z };
    let reading = meter::measure(scene(body), receiver, 1 << 16, &Settings::default());
    assert_eq!((reading.samples, reading.invalid_samples), (1 << 16, 0));
    (reading.irradiance.x, reading.standard_error.x)
}

#[track_caller]
fn reads(body: &str, want: f64) {
    let (mean, error) = read(body);
    // What is known without sampling has an error of rounding only: that of a sum of 256 samples.
    assert!((mean - want).abs() <= 3.0 * error + 1e-5 * want, "{mean} ± {error}, not {want}: {body}");
    assert!(error < 0.01 * want, "{mean} ± {error}: too noisy to tell");
}

/// A shape that shines with radiance 1.
fn shining(shape: &str, inside: &str) -> String {
    format!(
        "<shape type='{shape}'>{inside}<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"
    )
}

/// Turned to look down, at this height.
fn above(height: f64, scale: f64) -> String {
    format!(
        "<transform name='to_world'><scale value='{scale}'/><rotate x='1' angle='180'/>\
         <translate z='{height}'/></transform>"
    )
}

#[test]
fn a_disk_as_wide_as_it_is_high_brings_half_a_pi() {
    reads(&shining("disk", &above(1.0, 1.0)), PI / 2.0);
    reads(&shining("disk", &above(250.0, 250.0)), PI / 2.0);
}

#[test]
fn a_sphere_at_twice_its_radius_brings_a_quarter_of_pi() {
    let sphere = "<point name='center' x='0' y='0' z='2'/><float name='radius' value='1'/>";
    reads(&shining("sphere", sphere), PI / 4.0);
}

/// E = 4 ∫∫ over a quarter of h²/(x² + y² + h²)² dA = 4 · ½ [X/√(h² + X²) atan(Y/√(h² + X²)) + …] of the
/// square's half side ½.
#[test]
fn a_unit_square_at_height_one() {
    let half: f64 = 0.5;
    let root = (1.0 + half * half).sqrt();
    let want = 4.0 * half / root * (half / root).atan();
    assert!((want - 0.752_275).abs() < 1e-6);
    reads(&shining("rectangle", &above(1.0, 0.5)), want);
}

#[test]
fn skies_bring_pi() {
    reads("<emitter type='constant'><rgb name='radiance' value='1'/></emitter>", PI);
}

#[test]
fn lights_without_extent_bring_what_is_written() {
    reads(
        "<emitter type='point'><point name='position' x='0' y='3' z='4'/>\
         <rgb name='intensity' value='50'/></emitter>",
        50.0 / 25.0 * 0.8,
    );
    reads(
        "<emitter type='directional'><vector name='direction' x='0' y='-0.6' z='-0.8'/>\
         <rgb name='irradiance' value='5'/></emitter>",
        4.0,
    );
}

/// In a room of albedo ½ that shines with 1 all around, every direction brings 1/(1 − ½) = 2.
#[test]
fn a_white_room_brings_what_its_walls_give_back() {
    let room = "<shape type='sphere'><float name='radius' value='3'/><boolean name='flip_normals' value='true'/>\
                <bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf><emitter type='area'>\
                <rgb name='radiance' value='1'/></emitter></shape>";
    reads(room, 2.0 * PI);
}

#[test]
fn many_lights_are_one() {
    // Sixteen strips are a square, whichever of the two ways of choosing among lights is taken.
    for count in [4, 32] {
        let side = 1.0 / f64::from(count);
        let strips: String = (0..count)
            .map(|i| {
                let x = (f64::from(i) + 0.5) * side - 0.5;
                let place = format!(
                    "<transform name='to_world'><scale x='{}' y='0.5'/><rotate x='1' angle='180'/>\
                     <translate x='{x}' z='1'/></transform>",
                    side / 2.0
                );
                shining("rectangle", &place)
            })
            .collect();
        reads(&strips, 0.752_275);
    }
}

#[test]
fn both_pipelines_read_the_same_bits() {
    let body =
        shining("disk", &above(1.0, 1.0)) + &shining("sphere", "<point name='center' x='1' y='0' z='2'/>");
    let receiver = Receiver::Point { position: Vec3::new(0.1, 0.2, 0.0), normal: Vec3::Z };
    let reading = |backend| {
        let settings = Settings { backend, ..Settings::default() };
        meter::measure(scene(&body), receiver, 1 << 12, &settings)
    };
    assert_eq!(reading(Backend::Packet), reading(Backend::Scalar));
}

/// The integrator measures what is seen, whatever it is made of: a black wall under a sky receives π.
#[test]
fn pictures_of_irradiance_do_not_depend_on_the_material() {
    let wall = |bsdf: &str| {
        let text = format!(
            "<shape type='rectangle'><transform name='to_world'><scale value='50'/><rotate y='1' angle='180'/>\
             <translate z='3'/></transform>{bsdf}</shape>\
             <emitter type='constant'><rgb name='radiance' value='1'/></emitter>"
        );
        let mut scene = scene(&text);
        scene.integrator = packlight::scene::Integrator::Irradiance { max_depth: None, rr_depth: 5 };
        scene.sampler.sample_count = 256;
        render(&scene, &Settings::default(), &|_| {}).picture
    };
    let black = wall("<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>");
    let mirror = wall("<bsdf type='conductor'/>");
    assert_eq!(black, mirror);
    for &sample in &black.channels[0].samples {
        assert!((f64::from(sample) - PI).abs() < 0.02 * PI, "{sample}");
    }
}

/// A scene seen by a meter on a shape, and what it reads by `measure` and as a picture of one pixel.
fn on_surface(shape: &str, inside: &str, others: &str) -> [(f64, f64); 2] {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    let text = format!(
        "<scene version='3.0.0'><integrator type='path'/><shape type='{shape}'>{inside}\
         <bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf><sensor type='irradiancemeter'>\
         <sampler type='independent'><integer name='sample_count' value='65536'/></sampler>\
         <film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>\
         <rfilter type='box'/></film></sensor></shape>{others}</scene>"
    );
    fs::write(&path, text).expect("the folder for temporary files can be written");
    let loaded = load(&path, &LoadOptions::default()).expect(others);
    assert!(loaded.warnings.is_empty(), "{}", loaded.warnings[0]);
    let scene = compile(&loaded.description).expect(others);
    assert!(scene.has_meter());
    let picture = render(&scene, &Settings::default(), &|_| {}).picture;
    assert_eq!((picture.width, picture.height), (1, 1));
    let reading = meter::measure(scene, Receiver::Sensor, 1 << 16, &Settings::default());
    let (mean, error) = (reading.irradiance.x, reading.standard_error.x);
    // As many stratified samples have no more error than independent ones.
    [(mean, error), (f64::from(picture.channels[0].samples[0]), error)]
}

#[track_caller]
fn surface_reads(readings: [(f64, f64); 2], want: f64) {
    for (mean, error) in readings {
        assert!((mean - want).abs() <= 3.0 * error + 1e-5 * want, "{mean} ± {error}, not {want}");
        assert!(error < 0.01 * want, "{mean} ± {error}: too noisy to tell");
    }
}

#[test]
fn surfaces_under_a_sky_receive_pi_wherever_they_do_not_see_themselves() {
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    let turned =
        "<transform name='to_world'><scale x='2' y='0.5'/><rotate x='1' y='1' angle='33'/></transform>";
    for shape in ["rectangle", "sphere", "cube", "disk"] {
        let inside = if shape == "rectangle" { turned } else { "" };
        surface_reads(on_surface(shape, inside, sky), PI);
    }
}

/// The share F of a square's light that reaches the opposite side of a cube: with s = √2, the corner of four logarithms
/// and arcs that is 2/π (ln(2/√3) + 2s atan(1/s) − 2 atan 1) = 0.19982.
#[test]
fn a_square_receives_from_the_one_opposite_what_its_form_factor_says() {
    let s = 2f64.sqrt();
    let share = 2.0 / PI * ((2.0 / 3f64.sqrt()).ln() + 2.0 * s * (1.0 / s).atan() - 2.0 * 1f64.atan());
    assert!((share - 0.19982).abs() < 1e-5, "{share}");
    surface_reads(on_surface("rectangle", "", &shining("rectangle", &above(2.0, 1.0))), share * PI);
}

/// A meter's other side, and what stands before it, count as they should: a plate hides the lamp.
#[test]
fn what_is_behind_a_meter_does_not_reach_it() {
    let lamp = shining("sphere", "<point name='center' x='0' y='0' z='-5'/>");
    for (mean, _) in on_surface("rectangle", "", &lamp) {
        assert_eq!(mean, 0.0);
    }
}

/// A meter is no vertex: `max_depth` 1 is what emitters send, as it is where a camera looks.
#[test]
fn depth_counts_from_what_a_meter_sees() {
    let room = "<shape type='sphere'><float name='radius' value='9'/><boolean name='flip_normals' value='true'/>\
                <bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf><emitter type='area'>\
                <rgb name='radiance' value='1'/></emitter></shape>";
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    for (depth, want) in [(1, PI), (2, 1.5 * PI), (3, 1.75 * PI)] {
        let text = format!(
            "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='{depth}'/>\
             <integer name='rr_depth' value='9'/></integrator><shape type='rectangle'>\
             <transform name='to_world'><scale value='0.01'/></transform><sensor type='irradiancemeter'>\
             <film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/></film>\
             </sensor></shape>{room}</scene>"
        );
        fs::write(&path, text).expect("the folder for temporary files can be written");
        let scene = compile(&load(&path, &LoadOptions::default()).expect(room).description).expect(room);
        let reading = meter::measure(scene, Receiver::Sensor, 1 << 16, &Settings::default());
        let (mean, error) = (reading.irradiance.x, reading.standard_error.x);
        assert!((mean - want).abs() <= 3.0 * error + 1e-3 * want, "{depth}: {mean} ± {error}, not {want}");
    }
}
