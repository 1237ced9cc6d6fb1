//! Pictures with known variance: is every pixel as near as chance allows?
//!
//! Beside a reference R stands the variance V of one sample of each pixel. The mean C of n independent samples has
//!
//! ```text
//! z = |C − R| / √(V/n)
//! ```
//!
//! and p = erfc(z/√2) is the chance of being as far off or farther. A pixel is rejected below the level of
//! Šidák's correction for the number of pixels, 1 − 0.99^(1/pixels); of a right picture hardly any is. Our samples are
//! stratified, and nearer than independent ones; a bias that hides below them is seen in the mean.
//!
//! The references were estimated in XYZ, and both the means and the variances were turned into linear sRGB by the same
//! matrix, which makes some variances negative. So everything is turned back first.

use std::path::{Path, PathBuf};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    picture::{Encoding, Picture, decode},
    render::{Settings, render},
};

use super::{
    scenes::{files, refusal},
    shared,
};

const SAMPLES: u32 = 1024;
/// As black pixels have no variance of their own.
const LEAST_VARIANCE: f64 = 1e-4;
/// Share of the pixels that may not be rejected.
const ACCEPTED: f64 = 0.9975;
/// How far the mean of the picture may be off.
const MEAN: f64 = 0.005;

/// `…/test_name_integrator.xml` and its reference `…/refs/test_name_ref_rgbSUFFIX.exr`.
fn reference(scene: &Path, suffix: &str) -> Picture {
    let stem = scene.file_stem().expect("a name").to_string_lossy().into_owned();
    let (name, _integrator) = stem.rsplit_once('_').expect("name_integrator");
    let path = scene.with_file_name("refs").join(format!("{name}_ref_rgb{suffix}.exr"));
    decode(&path, Encoding::Raw).expect("a reference can be read")
}

fn rendered(scene: &Path) -> Picture {
    let mut description = load(scene, &LoadOptions::default()).expect("the scene loads").description;
    description.sensor.sampler.sample_count = SAMPLES;
    let scene = compile(&description).expect("the scene compiles");
    render(&scene, &Settings::default(), &|_| {}).picture
}

/// Linear sRGB to XYZ.
const TO_XYZ: [[f64; 3]; 3] =
    [[0.412_453, 0.357_58, 0.180_423], [0.212_671, 0.715_16, 0.072_169], [0.019_334, 0.119_193, 0.950_227]];

/// X, Y and Z of all pixels.
fn values(picture: &Picture) -> impl Iterator<Item = f64> {
    let pixels = 0..picture.channels[0].samples.len();
    pixels.flat_map(|i| {
        let rgb = [0, 1, 2].map(|c| f64::from(picture.channels[c].samples[i]));
        TO_XYZ.map(|row| row.iter().zip(rgb).map(|(factor, band)| factor * band).sum::<f64>())
    })
}

struct Verdict {
    accepted: f64,
    worst: f64,
    /// Our mean over theirs.
    ratio: f64,
}

fn verdict(ours: &Picture, reference: &Picture, variance: &Picture) -> Verdict {
    assert_eq!((ours.width, ours.height), (reference.width, reference.height));
    let pixels = f64::from(ours.width) * f64::from(ours.height);
    let level = 1.0 - 0.99f64.powf(1.0 / pixels);
    let z: Vec<f64> = values(ours)
        .zip(values(reference))
        .zip(values(variance))
        .map(|((c, r), v)| (c - r).abs() / (v.max(LEAST_VARIANCE) / f64::from(SAMPLES)).sqrt())
        .collect();
    let accepted = z.iter().filter(|&&z| libm::erfc(z / 2f64.sqrt()) > level).count();
    Verdict {
        accepted: accepted as f64 / z.len() as f64,
        worst: z.iter().fold(0.0, |worst, &z| worst.max(z)),
        ratio: values(ours).sum::<f64>() / values(reference).sum::<f64>(),
    }
}

fn all() -> Vec<PathBuf> {
    let Some(shared) = shared("scenes/mitsuba/reference/tests/scenes") else { return Vec::new() };
    ["bsdf_spheres", "floating_sphere", "instancing"]
        .iter()
        .flat_map(|folder| files(&shared.join(folder)))
        .collect()
}

#[test]
fn references_with_variance_are_matched() {
    let mut wrong = Vec::new();
    println!("{:<36} {:>9} {:>8} {:>8}", "scene", "accepted", "worst z", "mean");
    for scene in all() {
        let name = scene.file_stem().expect("a name").to_string_lossy().into_owned();
        if refusal(&scene).is_some() {
            println!("{name:<36} is refused");
            continue;
        }
        let Verdict { accepted, worst, ratio } =
            verdict(&rendered(&scene), &reference(&scene, ""), &reference(&scene, "_var"));
        println!("{name:<36} {:>8.2}% {worst:>8.2} {ratio:>8.4}", accepted * 100.0);
        if accepted < ACCEPTED || (ratio - 1.0).abs() > MEAN {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "not matched: {}", wrong.join(", "));
}

#[test]
fn a_picture_that_is_wrong_is_rejected() {
    let Some(scene) = all().into_iter().find(|scene| scene.ends_with("test_constant_path.xml")) else {
        return;
    };
    let (theirs, variance) = (reference(&scene, ""), reference(&scene, "_var"));
    let right = verdict(&theirs, &theirs, &variance);
    assert_eq!((right.accepted, right.worst, right.ratio), (1.0, 0.0, 1.0));
    let mut brighter = theirs.clone();
    for sample in brighter.channels.iter_mut().flat_map(|channel| &mut channel.samples) {
        *sample *= 1.02;
    }
    assert!((verdict(&brighter, &theirs, &variance).ratio - 1.0).abs() > MEAN);
    let mut shifted = theirs.clone();
    for channel in &mut shifted.channels {
        channel.samples.rotate_right(3);
    }
    assert!(verdict(&shifted, &theirs, &variance).accepted < ACCEPTED);
}
