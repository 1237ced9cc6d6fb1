//! The channels that films ask for.

#![allow(missing_docs)]

use std::fs;

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    picture::{Format, Picture, Preview, encode},
    render::{Backend, Rendered, Settings, render},
};

/// A square that fills the middle of the picture, ten by ten of its forty by twenty pixels.
fn rendered(format: &str, integrator: &str, others: &str, backend: Backend) -> Rendered {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    let text = format!(
        "<scene version='3.0.0'><integrator type='{integrator}'/><sensor type='orthographic'>\
         <transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>\
         <sampler type='independent'><integer name='sample_count' value='64'/></sampler>\
         <film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='20'/>\
         <string name='pixel_format' value='{format}'/><rfilter type='box'/></film></sensor>\
         <shape type='rectangle'><transform name='to_world'><scale value='0.25'/></transform>\
         <bsdf type='diffuse'><rgb name='reflectance' value='0.2, 0.4, 0.8'/></bsdf></shape>{others}</scene>"
    );
    fs::write(&path, text).expect("the folder for temporary files can be written");
    let loaded = load(&path, &LoadOptions::default()).expect(format);
    assert!(loaded.warnings.is_empty(), "{}", loaded.warnings[0]);
    let scene = compile(&loaded.description).expect(format);
    render(&scene, &Settings { backend, ..Settings::default() }, &|_| {})
}

fn picture(format: &str, integrator: &str, others: &str, backend: Backend) -> Picture {
    rendered(format, integrator, others, backend).picture
}

const LAMP: &str = "<emitter type='directional'><vector name='direction' x='0.1' y='0.2' z='-1'/></emitter>";
const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='0.5'/></emitter>";

fn names(picture: &Picture) -> Vec<&str> {
    picture.channels.iter().map(|channel| channel.name.as_str()).collect()
}

fn plane<'p>(picture: &'p Picture, name: &str) -> &'p [f32] {
    picture.plane(name).expect(name)
}

#[test]
fn luminance_is_the_y_of_what_rgb_shows() {
    let rgb = picture("rgb", "path", LAMP, Backend::Packet);
    let grey = picture("luminance", "path", LAMP, Backend::Packet);
    assert_eq!((names(&rgb), names(&grey)), (vec!["R", "G", "B"], vec!["Y"]));
    let [r, g, b] = ["R", "G", "B"].map(|name| plane(&rgb, name));
    assert!(r.iter().any(|&x| x > 0.0));
    for (i, y) in plane(&grey, "Y").iter().enumerate() {
        assert!((0.212_671 * r[i] + 0.715_16 * g[i] + 0.072_169 * b[i] - y).abs() < 1e-6);
    }
    // A file of three colours shows it grey.
    for format in [Format::Hdr, Format::Png, Format::Exr] {
        encode(&grey, format, Preview::default()).expect("grey can be written");
    }
}

#[test]
fn alpha_is_the_share_that_is_covered() {
    for (format, others) in [("rgba", vec!["R", "G", "B", "A"]), ("luminance_alpha", vec!["Y", "A"])] {
        let seen = picture(format, "path", LAMP, Backend::Packet);
        assert_eq!(names(&seen), others);
        let alpha = plane(&seen, "A");
        assert!(alpha.iter().all(|&a| a == 0.0 || a == 1.0), "edges are those of pixels");
        assert_eq!(alpha.iter().sum::<f32>(), 100.0);
        assert_eq!(alpha[10 * 40 + 20], 1.0);
        let scalar = picture(format, "path", LAMP, Backend::Scalar);
        assert_eq!(seen, scalar);
    }
}

/// As in Mitsuba: paths see the sky, `direct` sees what it lights.
#[test]
fn a_sky_is_opaque_where_paths_show_it() {
    assert!(plane(&picture("rgba", "path", SKY, Backend::Packet), "A").iter().all(|&a| a == 1.0));
    let direct = picture("rgba", "direct", SKY, Backend::Packet);
    assert_eq!(plane(&direct, "A").iter().sum::<f32>(), 100.0);
}

#[test]
fn colours_are_the_same_with_alpha_and_without() {
    let with = picture("rgba", "path", SKY, Backend::Packet);
    let without = picture("rgb", "path", SKY, Backend::Packet);
    for name in ["R", "G", "B"] {
        assert_eq!(plane(&with, name), plane(&without, name));
    }
}

#[test]
fn rays_for_alpha_are_counted() {
    let rays = |format: &str| rendered(format, "path", SKY, Backend::Packet).statistics.camera_rays;
    assert_eq!((rays("rgb"), rays("rgba")), (40 * 20 * 64, 2 * 40 * 20 * 64));
}
