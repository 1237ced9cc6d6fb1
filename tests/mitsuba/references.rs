//! Our pictures beside Mitsuba's, by the thresholds that tell bugs from noise.

use std::{env, path::Path, process::Command};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    picture::{Preview, save},
    render::{Settings, render},
    scene::Integrator,
};

use super::{scenes::refusal, shared};

/// A picture, how to make it, and what is asked of it.
struct Reference {
    image: &'static str,
    scene: &'static str,
    samples: u32,
    /// Limits on the mean of the picture and on the means of its tiles of 16 × 16.
    mean: f64,
    tile: f64,
    /// Channels that are compared together; "" is R, G and B.
    channels: &'static [&'static str],
    /// Is compared in every run of the tests.
    quick: bool,
}

/// At 256 samples, by the usual thresholds.
const fn usual(image: &'static str) -> Reference {
    Reference { image, scene: image, samples: 256, mean: 0.004, tile: 0.05, channels: &[""], quick: false }
}

const fn quick(image: &'static str, samples: u32) -> Reference {
    Reference { samples, quick: true, ..usual(image) }
}

const REFERENCES: &[Reference] = &[
    quick("furnace_conductor_gold", 16),
    quick("furnace_conductor_none", 16),
    quick("furnace_dielectric", 64),
    quick("furnace_diffuse", 64),
    usual("furnace_plastic"),
    usual("furnace_rough_aniso_gold"),
    usual("furnace_rough_beckmann_01"),
    usual("furnace_rough_beckmann_03"),
    usual("furnace_rough_ggx_01"),
    usual("furnace_rough_ggx_03"),
    usual("furnace_roughplastic"),
    usual("cbox_direct"),
    usual("cbox_path"),
    // Caustics: at 256 samples the noise of the worst tile is that of the threshold.
    Reference { samples: 1024, ..usual("cbox_spheres") },
    usual("directional_mesh"),
    Reference { samples: 1024, tile: 0.025, ..usual("dof") },
    Reference { samples: 512, ..usual("dragon_direct") },
    usual("envmap"),
    usual("instancing"),
    Reference { samples: 512, mean: 0.006, tile: 0.15, ..usual("mis") },
    usual("shapes"),
    usual("shapes_ortho"),
    usual("softshadow"),
    quick("spot", 64),
    usual("textured"),
    usual("whitted"),
    Reference { scene: "whitted", ..usual("whitted_whitted") },
    Reference {
        samples: 64,
        channels: &["nn.X,nn.Y,nn.Z", "gn.X,gn.Y,gn.Z", "uv.U,uv.V", "pp.X,pp.Y,pp.Z", "dd.T"],
        ..usual("aov")
    },
];

impl Reference {
    /// Renders the scene into a file.
    fn render(&self, scene: &Path, into: &Path) {
        let mut description =
            load(scene, &LoadOptions::default()).expect("a reference scene loads").description;
        description.sensor.sampler.sample_count = self.samples;
        if self.image.ends_with("_whitted") {
            description.integrator = Integrator::Whitted { max_depth: 10 };
        }
        let scene = compile(&description).expect("a reference scene compiles");
        let rendered = render(&scene, &Settings::default(), &|_| {});
        save(&rendered.picture, into, Preview::default()).expect("a picture can be written");
    }

    /// A line of the table for each group of channels, and whether all are accepted.
    fn compare(&self, folder: &Path, candidate: &Path, python: &str) -> bool {
        let mut accepted = true;
        for channels in self.channels {
            let mut command = Command::new(python);
            command.arg(folder.join("compare.py")).arg(candidate);
            command.arg(folder.join(format!("images/{}.exr", self.image)));
            command.args(["--mean-tol", &self.mean.to_string(), "--tile", &self.tile.to_string()]);
            if !channels.is_empty() {
                command.args(["--channels", channels, "--pixel-centre-aov"]);
            }
            let output = command.output().expect("Python can be started");
            let line = String::from_utf8_lossy(&output.stdout);
            println!("{:<28} {:>5} {:<16} {}", self.image, self.samples, channels, line.trim());
            accepted &= output.status.success();
        }
        accepted
    }
}

/// A Python that can compare pictures.
fn python() -> Option<String> {
    let python = env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let able = Command::new(&python).args(["-c", "import numpy, OpenEXR"]).output();
    if able.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    eprintln!("skipped: {python} does not have numpy and OpenEXR; name one that does in PYTHON");
    None
}

fn compare(chosen: impl Fn(&Reference) -> bool) {
    let Some(folder) = shared("references") else { return };
    let Some(python) = python() else { return };
    let pictures = tempfile::tempdir().expect("the folder for temporary files can be written");
    let mut wrong = Vec::new();
    for reference in REFERENCES.iter().filter(|reference| chosen(reference)) {
        let scene = folder.join(format!("scenes/{}.xml", reference.scene));
        if let Some(why) = refusal(&scene) {
            println!("{:<28} refused: {why}", reference.image);
            continue;
        }
        let candidate = pictures.path().join(format!("{}.exr", reference.image));
        reference.render(&scene, &candidate);
        if !reference.compare(&folder, &candidate, &python) {
            wrong.push(reference.image);
        }
    }
    assert!(wrong.is_empty(), "not accepted: {}", wrong.join(", "));
}

#[test]
fn a_few_references_are_matched() {
    compare(|reference| reference.quick);
}

#[test]
#[ignore = "minutes: every reference, as many samples as it takes"]
fn every_reference_is_matched() {
    compare(|_| true);
}

#[test]
fn every_reference_is_in_the_table() {
    let Some(images) = shared("references/images") else { return };
    for entry in std::fs::read_dir(images).expect("the references can be read") {
        let path = entry.expect("the references can be read").path();
        if path.extension().is_some_and(|extension| extension == "exr") {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            assert!(REFERENCES.iter().any(|reference| reference.image == name), "{name} is compared nowhere");
        }
    }
}
