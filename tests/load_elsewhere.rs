//! What a scene takes from other files and other names: includes, paths, aliases, curves, serialized meshes.

#![allow(missing_docs)]

use std::fs;

use miette::Diagnostic;
use packlight::{
    load::{LoadError, LoadOptions, Loaded, load},
    scene::*,
};

/// Writes files into a folder of their own and loads the first.
fn load_files(files: &[(&str, &str)]) -> Result<Loaded, LoadError> {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("it can be written");
        fs::write(path, text).expect("it can be written");
    }
    load(&folder.path().join(files[0].0), &LoadOptions::default())
}

/// A scene around `body`, which starts on line 2.
fn scene(body: &str) -> String {
    let film = "<film type='hdrfilm'><rfilter type='box'/></film>";
    format!(
        "<scene version='3.0.0'><sensor type='perspective'>{film}</sensor><integrator type='path'/>\n{body}\n</scene>"
    )
}

fn loaded(files: &[(&str, &str)]) -> SceneDescription {
    load_files(files).unwrap_or_else(|error| panic!("{error}")).description
}

/// `file:line:column: message | help`, without the folder.
fn refusal(files: &[(&str, &str)]) -> String {
    let error = load_files(files).expect_err("it is refused");
    let line = error.to_string();
    let (place, _) = line.split_once(": ").expect("a place");
    let line = &line[place.rfind('/').map_or(0, |slash| slash + 1)..];
    let help = Diagnostic::help(&error).map_or(String::new(), |help| help.to_string());
    format!("{line} | {help}")
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn an_included_file_names_files_as_the_scene_does() {
    let main = scene("<include filename='parts/shapes.xml'/>");
    let part = "<scene version='3.0.0'><shape type='obj'><string name='filename' value='meshes/a.obj'/></shape></scene>";
    let files = [("main.xml", main.as_str()), ("parts/shapes.xml", part), ("meshes/a.obj", TRIANGLE)];
    assert_eq!(loaded(&files).shapes.len(), 1);
    // Beside the included file it is found too, but only where the scene has none.
    let beside = [("main.xml", main.as_str()), ("parts/shapes.xml", part), ("parts/meshes/a.obj", TRIANGLE)];
    assert_eq!(loaded(&beside).shapes.len(), 1);
    let missing = refusal(&[("main.xml", &main), ("parts/shapes.xml", part)]);
    assert!(missing.contains("there is no file `meshes/a.obj`"), "{missing}");
}

#[test]
fn a_path_is_searched_first_and_the_last_path_before_it() {
    let mesh = |x: u32| TRIANGLE.replace("v 1 0 0", &format!("v {x} 0 0"));
    let width = |scene: &SceneDescription| match &scene.shapes[0].geometry {
        Geometry::Mesh { mesh, .. } => mesh.positions[1].x,
        _ => panic!("no mesh"),
    };
    let shape = "<shape type='obj'><string name='filename' value='a.obj'/></shape>";
    let [one, two, three] = [1, 2, 3].map(mesh);
    let files = |body: &str| {
        let text = scene(&format!("{body}{shape}"));
        let files = [("main.xml", text.as_str()), ("a.obj", &one), ("x/a.obj", &two), ("y/a.obj", &three)];
        width(&loaded(&files))
    };
    assert_eq!(files(""), 1.0);
    assert_eq!(files("<path value='x'/>"), 2.0);
    assert_eq!(files("<path value='x'/><path value='y'/>"), 3.0);
}

#[test]
fn an_alias_is_another_name() {
    let body = "<bsdf type='diffuse' id='a'/><alias id='a' as='b'/><shape type='cube'><ref id='b'/></shape>";
    let scene = loaded(&[("main.xml", &scene(body))]);
    assert_eq!(scene.materials.len(), 1);
}

#[test]
fn elements_that_lead_nowhere_are_refused() {
    for (body, expected) in [
        ("<path value='no/where'/>", "main.xml:2:14: there is no folder `no/where` | looked for /"),
        ("<path/>", "main.xml:2:2: `path` needs the attribute `value` | "),
        (
            "<shape type='cube'><path value='.'/></shape>",
            "main.xml:2:21: `path` stands in the scene, not inside",
        ),
        ("<alias id='a' as='b'/>", "main.xml:2:12: no object before this has the id `a` | "),
        (
            "<bsdf type='diffuse' id='wall'/><alias id='wal' as='b'/>",
            "main.xml:2:44: no object before this has the id `wal` | did you mean `wall`?",
        ),
        (
            "<bsdf type='diffuse' id='a'/><alias id='a' as='a'/>",
            "main.xml:2:48: two objects have the id `a` | ",
        ),
        ("<include filename='main.xml'/>", "main.xml:2:20: `main.xml` includes itself | break the loop"),
        ("<shape type='serialized'/>", "main.xml:2:2: the shape `serialized` needs `filename` | "),
    ] {
        let found = refusal(&[("main.xml", &scene(body))]);
        let found = found.as_str();
        assert!(found.starts_with(expected), "{body}\n   found {found}\nexpected {expected}");
    }
}

fn reflectance(scene: &SceneDescription) -> Rgb {
    match &scene.materials[0] {
        Material::Diffuse { reflectance: Texture::Constant(rgb) } => *rgb,
        other => panic!("{other:?}"),
    }
}

#[test]
fn curves_are_seen_under_daylight_or_as_they_shine() {
    let curve = "value='400:0.4, 500:0.1 550:0.6,700:0.3'";
    let file = "400 0.4\n500 0.1 # a remark\n550 0.6\n700 0.3\n";
    let shape = |spectrum: &str| {
        scene(&format!(
            "<shape type='cube'><bsdf type='diffuse'><spectrum name='reflectance' {spectrum}/></bsdf></shape>"
        ))
    };
    let written = reflectance(&loaded(&[("main.xml", &shape(curve))]));
    assert!((written - Rgb::new(0.568_308, 0.435_65, 0.207_878)).length() < 1e-3, "{written}");
    let read = reflectance(&loaded(&[("main.xml", &shape("filename='a.spd'")), ("a.spd", file)]));
    assert_eq!(read, written);

    let lamp = "<shape type='cube'><emitter type='area'><spectrum name='radiance' value='400:0, 500:8, 600:15.6, 700:18.4'/></emitter></shape>";
    let radiance = loaded(&[("main.xml", &scene(lamp))]).shapes[0].radiance.expect("it shines");
    assert!((radiance - Rgb::new(20.7108, 10.8546, 2.771_15)).length() < 1e-2, "{radiance}");
    // A number is grey, a constant spectrum is not.
    let lamp = "<emitter type='constant'><float name='radiance' value='2'/></emitter>";
    let emitters = loaded(&[("main.xml", &scene(lamp))]).emitters;
    assert_eq!(emitters, [Emitter::Constant { radiance: Rgb::splat(2.0) }]);
}

#[test]
fn colours_that_srgb_lacks_are_clamped_aloud() {
    let body = "<bsdf type='diffuse' id='a'><spectrum name='reflectance' value='400:0.04, 500:0.05, 600:0.9, 700:0.99'/></bsdf>
        <shape type='cube'><ref id='a'/></shape>
        <emitter type='constant'><spectrum name='radiance' value='450:2,550:3'/></emitter>";
    let Loaded { description, warnings, .. } = load_files(&[("main.xml", &scene(body))]).expect("it loads");
    let red = reflectance(&description);
    assert!((red - Rgb::new(1.0, 0.394_803, 0.0)).length() < 1e-3, "{red}");
    let of = |part: &str| warnings.iter().filter(|warning| warning.message().contains(part)).count();
    assert_eq!(of("`reflectance` is the colour (1.1"), 1, "{warnings:?}");
    assert_eq!(of("`radiance` is the colour (-1.1"), 1, "{warnings:?}");
}

#[test]
fn curves_that_are_wrong_are_refused() {
    for (spectrum, expected) in [
        ("value='400:1'", "a curve needs two points at least"),
        ("value='400:1, 500'", "`500` is not a wavelength and a value"),
        ("value='400:1, 500:x'", "`500:x` is not a wavelength and a value"),
        ("value='400:1, 300:1'", "the wavelength 300 follows 400"),
        ("value='400:1, 500:-1'", "the value -1 at 500 nm is negative"),
        ("value='400:1, 500:nan'", "`500:nan` is not a wavelength and a value"),
        ("value='1 2 3'", "`spectrum` takes one number or a curve, found 3 numbers"),
        ("value='400:1, 500:2'", "`reflectance` must lie between 0 and 1"),
        ("filename='no.spd'", "there is no file `no.spd`"),
    ] {
        let body = format!("<bsdf type='diffuse'><spectrum name='reflectance' {spectrum}/></bsdf>");
        let found = refusal(&[("main.xml", &scene(&body))]);
        assert!(found.starts_with("main.xml:2:") && found.contains(expected), "{spectrum}\n   found {found}");
    }
    let body = "<bsdf type='diffuse'><spectrum name='reflectance' filename='a.spd'/></bsdf>";
    let found = refusal(&[("main.xml", &scene(body)), ("a.spd", "400 1\n500 y\n")]);
    assert!(found.starts_with("a.spd:2:1: `500 y` is not a wavelength and a value"), "{found}");
}

#[test]
fn a_checkerboard_as_a_number_has_its_fields_exchanged() {
    let fields = "<float name='color0' value='0.75'/><float name='color1' value='0.25'/>";
    let board = |slot: &str| format!("<texture type='checkerboard' name='{slot}'>{fields}</texture>");
    let body = format!(
        "<shape type='cube'><bsdf type='mask'>{}<bsdf type='diffuse'>{}</bsdf></bsdf></shape>",
        board("opacity"),
        board("reflectance")
    );
    let scene = loaded(&[("main.xml", &scene(&body))]);
    let Material::Mask { opacity, nested } = &scene.materials[0] else { panic!("no mask") };
    let Material::Diffuse { reflectance } = &**nested else { panic!("not diffuse") };
    let first = |texture: &Texture| match texture {
        Texture::Checkerboard { color0, .. } => color0.x,
        other => panic!("{other:?}"),
    };
    assert_eq!((first(reflectance), first(opacity)), (0.75, 0.25));
}

#[test]
fn a_moment_is_the_integrator_inside_it() {
    let sensor = "<sensor type='perspective'/>";
    let text = |integrator: &str| format!("<scene version='3.0.0'>{sensor}\n{integrator}</scene>");
    let inside = "<integrator type='direct'><boolean name='hide_emitters' value='true'/></integrator>";
    let moment = text(&format!("<integrator type='moment'>{inside}</integrator>"));
    let Loaded { description, warnings, .. } = load_files(&[("main.xml", &moment)]).expect("it loads");
    assert_eq!(description.integrator, Integrator::Direct { hide_emitters: true });
    assert!(warnings.iter().any(|w| w.message().contains("`moment` is read as the `direct` inside it")));
    for (integrator, expected) in [
        ("<integrator type='moment'/>", "main.xml:2:2: the integrator `moment` has no integrator inside"),
        (
            "<integrator type='moment'><integrator type='path'/><integrator type='path'/></integrator>",
            "main.xml:2:53: the integrator `moment` takes one integrator, not several",
        ),
        (
            "<integrator type='moment'><integrator type='moment'/></integrator>",
            "main.xml:2:28: a `moment` can't stand inside a `moment`",
        ),
        (
            "<integrator type='moment'><integer name='depth' value='1'/><integrator type='path'/></integrator>",
            "main.xml:2:42: the integrator `moment` has no property `depth`",
        ),
    ] {
        let found = refusal(&[("main.xml", &text(integrator))]);
        assert!(found.starts_with(expected), "{integrator}\n   found {found}\nexpected {expected}");
    }
}
