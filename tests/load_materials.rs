//! Materials in Mitsuba XML: their defaults, their wrappers, and how bad input is refused.

#![allow(missing_docs)]

use std::{fs, path::Path};

use miette::Diagnostic;
use packlight::{
    compile::compile,
    load::{LoadError, LoadOptions, Loaded, load},
    material::MerlTable,
    render::{Settings, render},
    scene::*,
};

const HEAD: &str = "<scene version='3.0.0'>\n<sensor type='perspective'><transform name='to_world'>\
    <lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>\
    <sampler type='independent'><integer name='sample_count' value='256'/></sampler><film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/>\
    <rfilter type='box'/></film></sensor><integrator type='path'/>\n";

fn load_in(folder: &Path, bsdf: &str) -> Result<Loaded, LoadError> {
    let path = folder.join("scene.xml");
    let shape = format!("<shape type='rectangle'>{bsdf}</shape><emitter type='constant'/></scene>");
    fs::write(&path, format!("{HEAD}{shape}")).expect("the folder for temporary files can be written");
    load(&path, &LoadOptions::default())
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("the folder for temporary files can be written")
}

fn material(bsdf: &str) -> Material {
    match load_in(folder().path(), bsdf) {
        Ok(loaded) => loaded.description.materials[0].clone(),
        Err(error) => panic!("{bsdf}: {error}"),
    }
}

/// `message | help`.
fn refusal_in(folder: &Path, bsdf: &str) -> String {
    let error = load_in(folder, bsdf).expect_err(bsdf);
    let text = error.to_string();
    let message = text.split_once("scene.xml:3:").map_or(text.as_str(), |(_, rest)| rest);
    let message = message.split_once(": ").map_or(message, |(_, message)| message);
    format!("{message} | {}", Diagnostic::help(&error).map_or(String::new(), |help| help.to_string()))
}

fn grey(x: f32) -> Texture {
    Texture::Constant(Rgb::splat(x))
}

#[test]
fn defaults_are_those_of_mitsuba() {
    let roughness =
        Roughness { distribution: Distribution::Beckmann, alpha_u: grey(0.1), alpha_v: grey(0.1) };
    assert_eq!(
        material("<bsdf type='roughconductor'/>"),
        Material::RoughConductor {
            roughness: roughness.clone(),
            metal: Metal { eta: grey(0.0), k: grey(1.0) },
            specular_reflectance: grey(1.0),
        }
    );
    assert_eq!(
        material("<bsdf type='roughdielectric'/>"),
        Material::RoughDielectric {
            roughness,
            int_ior: 1.5046,
            ext_ior: 1.000_277,
            specular_reflectance: grey(1.0),
            specular_transmittance: grey(1.0),
        }
    );
    for (bsdf, roughness) in [("plastic", None), ("roughplastic", Some((Distribution::Beckmann, grey(0.1))))]
    {
        assert_eq!(
            material(&format!("<bsdf type='{bsdf}'/>")),
            Material::Plastic {
                roughness,
                int_ior: 1.49,
                ext_ior: 1.000_277,
                diffuse_reflectance: grey(0.5),
                specular_reflectance: grey(1.0),
                nonlinear: false,
            }
        );
    }
    let Material::Principled(principled) = material("<bsdf type='principled'/>") else { panic!() };
    assert_eq!((&principled.base_color, &principled.roughness), (&grey(0.5), &grey(0.5)));
    assert!((principled.eta - 1.5).abs() < 1e-6, "{}", principled.eta);
    assert!(!Material::Principled(principled).transmits());
}

#[test]
fn every_slot_takes_a_number_a_checkerboard_or_a_picture() {
    let folder = folder();
    image(folder.path(), "a.png");
    let texture = |name: &str| {
        [
            format!("<texture name='{name}' type='checkerboard'/>"),
            format!("<texture name='{name}' type='bitmap'><string name='filename' value='a.png'/></texture>"),
            format!("<float name='{name}' value='0.25'/>"),
        ]
    };
    for (bsdf, slots) in [
        ("diffuse", &["reflectance"][..]),
        ("conductor", &["eta", "k", "specular_reflectance"]),
        ("roughconductor", &["alpha", "eta", "k", "specular_reflectance"]),
        ("roughdielectric", &["alpha", "specular_reflectance", "specular_transmittance"]),
        ("plastic", &["diffuse_reflectance", "specular_reflectance"]),
        ("roughplastic", &["alpha", "diffuse_reflectance", "specular_reflectance"]),
        ("ward", &["diffuse_reflectance", "specular_reflectance", "alpha"]),
        ("phong", &["exponent", "diffuse_reflectance", "specular_reflectance"]),
        ("toon", &["reflectance"]),
        ("principled", &["base_color", "roughness", "metallic", "anisotropic", "spec_tint", "spec_trans"]),
        ("principled", &["sheen", "sheen_tint", "clearcoat", "clearcoat_gloss", "flatness"]),
    ] {
        for slot in slots {
            for value in texture(slot) {
                let xml = format!("<bsdf type='{bsdf}'>{value}</bsdf>");
                let description = load_in(folder.path(), &xml).unwrap_or_else(|e| panic!("{e}")).description;
                let scene = compile(&description).expect("one rectangle compiles");
                let rendered = render(&scene, &Settings::default(), &|_| {});
                assert_eq!(rendered.statistics.invalid_samples, 0, "{xml}");
            }
        }
    }
}

/// An 8-bit picture of 2 × 1 texels: black and white.
fn image(folder: &Path, name: &str) {
    let channel = |name: &str| packlight::picture::Channel { name: name.into(), samples: vec![0.0, 1.0] };
    let channels = ["R", "G", "B"].map(channel).into();
    let picture = packlight::picture::Picture { width: 2, height: 1, channels, place: None };
    packlight::picture::save(&picture, &folder.join(name), packlight::picture::Preview::default())
        .expect("the folder for temporary files can be written");
}

#[test]
fn wrappers_nest() {
    let Material::Mask { opacity, nested } = material(
        "<bsdf type='mask'><float name='opacity' value='0.25'/>
           <bsdf type='twosided'><bsdf type='blendbsdf'><float name='weight' value='0.75'/>
             <bsdf type='diffuse'/><bsdf type='conductor'/></bsdf></bsdf></bsdf>",
    ) else {
        panic!()
    };
    assert_eq!(opacity, grey(0.25));
    let Material::TwoSided { front, back: None } = *nested else { panic!() };
    assert!(matches!(*front, Material::Blend { weight, .. } if weight == grey(0.75)));
}

#[test]
fn bad_parameters_are_refused() {
    let folder = folder();
    for (bsdf, expected) in [
        (
            "<bsdf type='roughconductor'><float name='alpha' value='0'/></bsdf>",
            "`alpha` must be greater than 0",
        ),
        (
            "<bsdf type='roughplastic'><float name='alpha' value='-0.1'/></bsdf>",
            "`alpha` must be greater than 0",
        ),
        (
            "<bsdf type='roughconductor'><float name='alpha' value='0.1'/><float name='alpha_u' value='0.1'/></bsdf>",
            "`alpha` and `alpha_u` exclude each other",
        ),
        (
            "<bsdf type='ward'><float name='alpha_u' value='0.1'/></bsdf>",
            "`alpha_u` stands alone | give `alpha_v` too",
        ),
        ("<bsdf type='plastic'><float name='int_ior' value='0'/></bsdf>", "`int_ior` must be greater than 0"),
        (
            "<bsdf type='roughdielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1.5'/></bsdf>",
            "`int_ior` and `ext_ior` of a `roughdielectric` are the same",
        ),
        (
            "<bsdf type='principled'><float name='eta' value='1.5'/><float name='specular' value='0.5'/></bsdf>",
            "`eta` and `specular` exclude each other",
        ),
        ("<bsdf type='principled'><float name='eta' value='0'/></bsdf>", "`eta` must be greater than 0"),
        (
            "<bsdf type='principled'><float name='metallic' value='1.5'/></bsdf>",
            "`metallic` must lie between 0 and 1",
        ),
        (
            "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='1.1'/></bsdf>",
            "`diffuse_reflectance` must lie between 0 and 1 | a surface can't reflect more",
        ),
        ("<bsdf type='roughconductor'><rgb name='k' value='-1'/></bsdf>", "`k` must not be negative"),
        (
            "<bsdf type='roughconductor'><string name='distribution' value='phong'/></bsdf>",
            "`phong` is no value of `distribution`",
        ),
        (
            "<bsdf type='toon'><integer name='bands' value='1'/></bsdf>",
            "`bands` must be at least 2, but is 1",
        ),
        (
            "<bsdf type='toon'><integer name='bands' value='3'/><string name='ramp' value='0: 1'/></bsdf>",
            "`bands` and `ramp` exclude each other",
        ),
        (
            "<bsdf type='toon'><string name='ramp' value='0.5: 1 1'/></bsdf>",
            "`0.5: 1 1` is no stop of a ramp | write cosine: colour; cosine: colour",
        ),
        ("<bsdf type='toon'><string name='ramp' value='1.5: 1'/></bsdf>", "`1.5: 1` is no stop of a ramp"),
        ("<bsdf type='toon'><string name='ramp' value=' ; '/></bsdf>", "a ramp has 1 to 64 stops, not 0"),
        (
            "<bsdf type='toon'><string name='ramp' value='0.5: 1; 0.2: 0.5'/></bsdf>",
            "stops must ascend, but 0.5 stands before 0.2",
        ),
        (
            "<bsdf type='phong'><float name='exponent' value='0'/></bsdf>",
            "`exponent` must be greater than 0, but is 0",
        ),
        (
            "<bsdf type='roughdielectric'><float name='alpha' value='-1'/></bsdf>",
            "`alpha` must be greater than 0, but is -1",
        ),
        ("<bsdf type='ward'><float name='alpha' value='0'/></bsdf>", "`alpha` must be greater than 0"),
        (
            "<bsdf type='dielectric'><float name='int_ior' value='0'/></bsdf>",
            "`int_ior` must be greater than 0",
        ),
        (
            "<bsdf type='roughdielectric'><float name='ext_ior' value='0'/></bsdf>",
            "`ext_ior` must be greater than 0",
        ),
        ("<bsdf type='conductor'><rgb name='eta' value='-1'/></bsdf>", "`eta` must not be negative"),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='1.2, 0.5, 0.5'/></bsdf>",
            "`reflectance` must lie between 0 and 1 | a surface can't reflect more",
        ),
        (
            "<bsdf type='bumpmap'><texture type='bitmap'><string name='filename' value='gone.png'/></texture>\
             <bsdf type='diffuse'/></bsdf>",
            "there is no file `gone.png`",
        ),
        (
            "<bsdf type='merl'><string name='filename' value='gone.brdf'/></bsdf>",
            "there is no file `gone.brdf`",
        ),
        ("<bsdf type='mask'/>", "the bsdf `mask` needs `a bsdf`"),
        (
            "<bsdf type='blendbsdf'><float name='weight' value='0.5'/></bsdf>",
            "`blendbsdf` takes two bsdfs, but has 0",
        ),
        (
            "<bsdf type='blendbsdf'><bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>",
            "the bsdf `blendbsdf` needs `weight`",
        ),
        ("<bsdf type='bumpmap'><bsdf type='diffuse'/></bsdf>", "the bsdf `bumpmap` needs `a texture`"),
        (
            "<bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='diffuse'/></bsdf>",
            "heights that jump have no slope",
        ),
        ("<bsdf type='normalmap'><bsdf type='diffuse'/></bsdf>", "the bsdf `normalmap` needs `normalmap`"),
        (
            "<bsdf type='twosided'><bsdf type='roughdielectric'/></bsdf>",
            "`twosided` is for opaque bsdfs: a `roughdielectric` already has two sides",
        ),
        (
            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'>\
             <string name='filename' value='gone.png'/></texture></bsdf>",
            "there is no file `gone.png`",
        ),
        ("<bsdf type='merl'/>", "the bsdf `merl` needs `filename`"),
        (
            "<bsdf type='merl'><string name='filename' value='gone.binary'/></bsdf>",
            "there is no file `gone.binary`",
        ),
    ] {
        let found = refusal_in(folder.path(), bsdf);
        assert!(found.starts_with(expected), "{bsdf}\n   found {found}\nexpected {expected}");
    }
}

#[test]
fn measured_tables_are_read_and_damaged_ones_refused() {
    let folder = folder();
    let xml = "<bsdf type='merl'><string name='filename' value='a.binary'/></bsdf>";
    let mut bytes = MerlTable::tabulate(|_, _| glam::Vec3::splat(0.2)).encode();
    let written = |bytes: &[u8]| fs::write(folder.path().join("a.binary"), bytes).expect("it can be written");
    written(&bytes);
    let description = load_in(folder.path(), xml).unwrap_or_else(|e| panic!("{e}")).description;
    assert!(matches!(description.materials[0], Material::Measured { .. }));
    let scene = compile(&description).expect("one rectangle compiles");
    let picture = render(&scene, &Settings::default(), &|_| {}).picture;
    // Seen from the front under a uniform sky: π f.
    let sample = centre(&picture);
    assert!((sample - 0.2 * std::f32::consts::PI).abs() < 0.05, "{sample}");

    written(&bytes[..1000]);
    assert!(refusal_in(folder.path(), xml).starts_with("the table can't be used: it has 1000 bytes"));
    bytes[12..20].copy_from_slice(&f64::NAN.to_le_bytes());
    written(&bytes);
    let found = refusal_in(folder.path(), xml);
    assert!(found.starts_with("the table can't be used: value 0 of red is not a finite number"), "{found}");
}

/// The mean of the four pixels in the middle.
fn centre(picture: &packlight::picture::Picture) -> f32 {
    let samples = &picture.channels[1].samples;
    [27, 28, 35, 36].map(|i| samples[i]).iter().sum::<f32>() / 4.0
}

/// A texture of one texel is a constant; so is its slope, 0.
#[test]
fn a_texture_of_one_texel_is_the_right_picture() {
    let folder = folder();
    let channel = |name: &str| packlight::picture::Channel { name: name.into(), samples: vec![0.5] };
    let channels = ["R", "G", "B"].map(channel).into();
    let picture = packlight::picture::Picture { width: 1, height: 1, channels, place: None };
    packlight::picture::save(&picture, &folder.path().join("a.exr"), packlight::picture::Preview::default())
        .expect("it can be written");
    let bitmap = "type='bitmap'><string name='filename' value='a.exr'/></texture>";
    for xml in [
        format!("<bsdf type='diffuse'><texture name='reflectance' {bitmap}</bsdf>"),
        format!("<bsdf type='bumpmap'><texture {bitmap}<bsdf type='diffuse'/></bsdf>"),
    ] {
        let description = load_in(folder.path(), &xml).unwrap_or_else(|e| panic!("{e}")).description;
        let scene = compile(&description).expect("one rectangle compiles");
        let picture = render(&scene, &Settings::default(), &|_| {}).picture;
        let sample = centre(&picture);
        assert!((sample - 0.5).abs() < 5e-3, "{xml}: {sample}");
    }
}

/// PNGs that are not 8 bits a channel are read for what they are.
#[test]
fn deep_and_palette_pictures_are_the_right_colour() {
    let folder = folder();
    for (name, bytes, want) in
        [("deep.png", &SIXTEEN_BITS[..], 0.2140), ("palette.png", &PALETTE[..], 0.5029)]
    {
        fs::write(folder.path().join(name), bytes).expect("it can be written");
        let xml = format!(
            "<bsdf type='diffuse'><texture name='reflectance' type='bitmap'>\
             <string name='filename' value='{name}'/></texture></bsdf>"
        );
        let description = load_in(folder.path(), &xml).unwrap_or_else(|e| panic!("{e}")).description;
        let scene = compile(&description).expect("one rectangle compiles");
        let picture = render(&scene, &Settings::default(), &|_| {}).picture;
        let sample = centre(&picture);
        assert!((sample - want).abs() < 5e-3, "{name}: {sample}, not {want}");
    }
}

#[rustfmt::skip]
mod pictures {
    /// 1 × 1, 16 bits a channel: (1, 0x8000/0xffff, 0), encoded.
    pub(super) const SIXTEEN_BITS: [u8; 72] = [137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 16, 2, 0, 0, 0, 192, 231, 143, 157, 0, 0, 0, 15, 73, 68, 65, 84, 120, 218, 99, 248, 255, 191, 129, 129, 129, 1, 0, 12, 252, 2, 127, 26, 12, 40, 139, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130];
    /// 1 × 1, two bits a pixel: the last of three colours, whose green is 188.
    pub(super) const PALETTE: [u8; 88] = [137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 2, 3, 0, 0, 0, 98, 123, 44, 26, 0, 0, 0, 9, 80, 76, 84, 69, 0, 0, 0, 255, 255, 255, 10, 188, 255, 27, 35, 8, 158, 0, 0, 0, 10, 73, 68, 65, 84, 120, 218, 99, 104, 0, 0, 0, 130, 0, 129, 218, 69, 8, 59, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130];
}
use pictures::{PALETTE, SIXTEEN_BITS};

#[test]
fn textures_that_are_damaged_are_told() {
    let folder = folder();
    fs::write(folder.path().join("a.png"), &SIXTEEN_BITS[..40]).expect("it can be written");
    let texture = "<texture name='alpha' type='bitmap'><string name='filename' value='a.png'/></texture>";
    let found = refusal_in(folder.path(), &format!("<bsdf type='roughplastic'>{texture}</bsdf>"));
    assert!(found.starts_with("the picture can't be used: "), "{found}");
}

#[test]
fn a_ramp_that_makes_light_is_warned_of() {
    let xml = "<bsdf type='toon'><string name='ramp' value='0.1: 1 0.5 0.2'/></bsdf>";
    let loaded = load_in(folder().path(), xml).unwrap_or_else(|e| panic!("{e}"));
    let Material::Toon { ramp, .. } = &loaded.description.materials[0] else { panic!() };
    assert_eq!(**ramp, Ramp::Steps(vec![Stop { cos: 0.1, color: Rgb::new(1.0, 0.5, 0.2) }]));
    let warnings: Vec<&str> = loaded.warnings.iter().map(packlight::load::Warning::message).collect();
    assert_eq!(warnings, ["the ramp reflects 1.80 times the light that arrives, before `reflectance`"]);
}

/// Cornell's files, from the folder beside the project, are not part of it.
#[test]
fn cornells_measurements_have_the_colour_of_their_paint() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes/brdf");
    if !shared.is_dir() {
        println!("skipped: {} is not there", shared.display());
        return;
    }
    for (name, brightest) in [("garnet_red", 0), ("krylon_blue", 2)] {
        let file = shared.join(format!("{name}.brdf"));
        let xml = format!("<bsdf type='merl'><string name='filename' value='{}'/></bsdf>", file.display());
        let description = load_in(folder().path(), &xml).unwrap_or_else(|e| panic!("{e}")).description;
        let scene = compile(&description).expect("one rectangle compiles");
        let picture = render(&scene, &Settings::default(), &|_| {}).picture;
        let mean = |k: usize| picture.channels[k].samples[27];
        for k in (0..3).filter(|k| *k != brightest) {
            assert!(mean(brightest) > 1.5 * mean(k), "{name}: {} {} {}", mean(0), mean(1), mean(2));
        }
        assert!(mean(brightest) < 0.6, "{name}: {}", mean(brightest));
    }
}

#[test]
fn a_damaged_brdf_is_told_with_its_line() {
    let folder = folder();
    fs::write(folder.path().join("a.brdf"), "# half a file\n2\n450 600\n0.1 0 0.2 0 0.5\n")
        .expect("writable");
    let xml = "<bsdf type='merl'><string name='filename' value='a.brdf'/></bsdf>";
    let error = load_in(folder.path(), xml).expect_err("it is damaged").to_string();
    assert!(error.ends_with("a.brdf:4:15: the file ends where f at 600 nm should stand"), "{error}");
}
