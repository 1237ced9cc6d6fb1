//! Mitsuba XML: what loads, what it means, and how errors read.

use std::{fs, sync::Arc};

use miette::Diagnostic;
use packlight::{
    load::{LoadError, LoadOptions, Loaded, load},
    picture::{Channel, Picture, Preview, save},
    scene::*,
};

/// A scene around `body`, which starts on line 3.
fn scene(body: &str) -> String {
    let sensor = "<sensor type='perspective'><film type='hdrfilm'><rfilter type='box'/></film></sensor>";
    format!("<scene version='3.0.0'>\n{sensor}<integrator type='path'/>\n{body}\n</scene>")
}

fn load_text_with(text: &str, defines: &[(&str, &str)]) -> Result<Loaded, LoadError> {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    fs::write(&path, text).expect("the folder for temporary files can be written");
    let defines = defines.iter().map(|&(name, value)| (name.into(), value.into())).collect();
    load(&path, &LoadOptions { defines, ..LoadOptions::default() })
}

fn load_body(body: &str) -> SceneDescription {
    match load_text_with(&scene(body), &[]) {
        Ok(loaded) => loaded.description,
        Err(error) => panic!("{body}: {error}"),
    }
}

/// `line:column: message | help`.
fn refusal(text: &str) -> String {
    let error = load_text_with(text, &[]).expect_err(text);
    let line = error.to_string();
    let line = line.split_once("scene.xml:").map_or(line.as_str(), |(_, rest)| rest);
    let help = Diagnostic::help(&error).map_or(String::new(), |help| help.to_string());
    format!("{} | {help}", line.trim_start())
}

#[track_caller]
fn assert_refused(body: &str, expected: &str) {
    let found = refusal(&scene(body));
    assert!(found.starts_with(expected), "{body}\n   found {found}\nexpected {expected}");
}

fn warnings(text: &str) -> Vec<String> {
    let loaded = load_text_with(text, &[]).expect(text);
    loaded.warnings.iter().map(|w| w.message().to_owned()).collect()
}

#[test]
fn steps_of_a_transform_apply_in_the_order_written() {
    let scene = load_body(
        "<shape type='rectangle'><transform name='to_world'>
           <scale value='2'/><rotate z='1' angle='90'/><translate x='1' y='2' z='3'/>
         </transform></shape>",
    );
    let to_world = scene.shapes[0].to_world;
    assert_eq!(to_world.transform_point3(glam::DVec3::X), glam::DVec3::new(1.0, 4.0, 3.0));
}

#[test]
fn look_at_has_its_left_hand_on_local_x() {
    let sensor = "<sensor type='perspective'><transform name='to_world'>
        <lookat origin='0,0,4' target='0 0 0' up='0, 1, 0'/></transform></sensor>";
    let text = format!("<scene version='3.0.0'>{sensor}</scene>");
    let to_world = load_text_with(&text, &[]).unwrap().description.sensor.to_world;
    let columns = to_world.to_cols_array_2d();
    assert_eq!(columns, [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 4.0]]);
}

#[test]
fn matrices_are_row_major() {
    let scene = load_body(
        "<shape type='cube'><transform name='to_world'>
           <matrix value='1 0 0 5  0 2 0 6  0 0 3 7  0 0 0 1'/></transform></shape>",
    );
    let point = scene.shapes[0].to_world.transform_point3(glam::DVec3::ONE);
    assert_eq!(point, glam::DVec3::new(6.0, 8.0, 10.0));
}

#[test]
fn parameters_come_from_the_command_line_first() {
    let text = scene(
        "<default name='kind' value='cube'/><default name='r' value='0.25'/>
         <shape type='$kind'><bsdf type='diffuse'><rgb name='reflectance' value='$r, 0.$digit, 1'/></bsdf></shape>",
    );
    let defines = [("kind", "disk"), ("digit", "5")];
    let scene = load_text_with(&text, &defines).unwrap().description;
    assert!(matches!(scene.shapes[0].geometry, Geometry::Disk));
    let reflectance = Texture::Constant(Rgb::new(0.25, 0.5, 1.0));
    assert_eq!(scene.materials[0], Material::Diffuse { reflectance });

    let error = load_text_with(&text, &[("kind", "disk"), ("digit", "5"), ("knd", "x")]).unwrap_err();
    assert!(error.to_string().ends_with("the scene has no parameter `knd`"), "{error}");
    assert_eq!(Diagnostic::help(&error).unwrap().to_string(), "did you mean `kind`?");
}

#[test]
fn referenced_materials_are_shared_wherever_they_stand() {
    let scene = load_body(
        "<shape type='cube'><ref id='red'/></shape>
         <bsdf type='twosided' id='red'><bsdf type='diffuse'><ref id='t' name='reflectance'/></bsdf></bsdf>
         <texture type='checkerboard' id='t'/>
         <shape type='disk'><ref id='red'/></shape><shape type='cube'/>",
    );
    assert_eq!(scene.materials.len(), 2);
    let of = |i: usize| scene.shapes[i].material;
    assert_eq!((of(0), of(1), of(2)), (MaterialIndex(0), MaterialIndex(0), MaterialIndex(1)));
    let Material::TwoSided { front, back: None } = &scene.materials[0] else { panic!() };
    assert!(matches!(&**front, Material::Diffuse { reflectance: Texture::Checkerboard { .. } }));
    assert_eq!(scene.materials[1], Material::default());
}

#[test]
fn shapes_that_shine_are_black_by_default() {
    let scene = load_body(
        "<shape type='disk' id='lamp'><emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>
         <shape type='disk'><emitter type='area'><spectrum name='radiance' value='2'/></emitter></shape>",
    );
    assert_eq!(scene.shapes[0].name, "lamp");
    assert_eq!(scene.shapes[0].radiance, Some(Rgb::splat(5.0)));
    let equal_energy = Rgb::new(2.4096, 1.8966, 1.8178);
    assert!(scene.shapes[1].radiance.unwrap().abs_diff_eq(equal_energy, 1e-6));
    assert_eq!(scene.materials, [Material::Diffuse { reflectance: Texture::Constant(Rgb::ZERO) }]);
}

#[test]
fn defaults_are_those_of_mitsuba() {
    let scene = load_body(
        "<shape type='cube'><bsdf type='conductor'/></shape>
         <shape type='cube'><bsdf type='dielectric'/></shape>
         <shape type='cube'><bsdf type='phong'/></shape>
         <shape type='cylinder'/><emitter type='spot'/><emitter type='point'/>",
    );
    let constant = |grey| Texture::Constant(Rgb::splat(grey));
    assert_eq!(
        scene.materials[..3],
        [
            Material::Conductor {
                metal: Metal { eta: constant(0.0), k: constant(1.0) },
                specular_reflectance: constant(1.0),
            },
            Material::Dielectric {
                int_ior: 1.5046,
                ext_ior: 1.000_277,
                specular_reflectance: constant(1.0),
                specular_transmittance: constant(1.0),
            },
            Material::Phong {
                diffuse_reflectance: constant(0.5),
                specular_reflectance: constant(0.2),
                exponent: constant(30.0),
            },
        ]
    );
    assert!(matches!(
        scene.shapes[3].geometry,
        Geometry::Cylinder { p0: glam::DVec3::ZERO, p1: glam::DVec3::Z, radius: 1.0 }
    ));
    let Emitter::Spot { cutoff_angle, beam_width, direction, .. } = scene.emitters[0] else { panic!() };
    assert_eq!((cutoff_angle, beam_width), (20.0_f64.to_radians(), 15.0_f64.to_radians()));
    assert_eq!(direction, glam::DVec3::Z);
    assert_eq!(scene.emitters[1], Emitter::Point { position: glam::DVec3::ZERO, intensity: Rgb::ONE });
    assert_eq!(scene.integrator, Integrator::default());
    assert_eq!((scene.sensor.film, scene.sensor.sampler), (Film::new(768, 576), Sampler::default()));
}

#[test]
fn named_materials_have_their_constants() {
    let scene = load_body(
        "<shape type='cube'><bsdf type='conductor'><string name='material' value='Cu'/></bsdf></shape>
         <shape type='cube'><bsdf type='dielectric'><string name='int_ior' value='diamond'/>
           <float name='ext_ior' value='1'/></bsdf></shape>",
    );
    let Material::Conductor { metal, .. } = &scene.materials[0] else { panic!() };
    let (eta, k) = (Rgb::new(0.2010, 0.9238, 1.1022), Rgb::new(3.9133, 2.4531, 2.1421));
    assert_eq!(*metal, Metal { eta: Texture::Constant(eta), k: Texture::Constant(k) });
    let Material::Dielectric { int_ior, ext_ior, .. } = scene.materials[1] else { panic!() };
    assert_eq!((int_ior, ext_ior), (2.419, 1.0));
}

#[test]
fn integrators_have_their_parameters() {
    for (xml, expected) in [
        (
            "<integrator type='path'><integer name='max_depth' value='-1'/></integrator>",
            Integrator::Path { max_depth: None, rr_depth: 5, hide_emitters: false },
        ),
        (
            // Roulette that never begins, where something else ends a path.
            "<integrator type='path'><integer name='max_depth' value='8'/>\
             <integer name='rr_depth' value='100000'/></integrator>",
            Integrator::Path { max_depth: Some(8), rr_depth: 100_000, hide_emitters: false },
        ),
        ("<integrator type='whitted'/>", Integrator::Whitted { max_depth: 10 }),
        ("<integrator type='ao'/>", Integrator::AmbientOcclusion { distance: f32::INFINITY }),
        (
            "<integrator type='ao'><float name='distance' value='2.5'/></integrator>",
            Integrator::AmbientOcclusion { distance: 2.5 },
        ),
        (
            "<integrator type='irradiance'><integer name='max_depth' value='3'/></integrator>",
            Integrator::Irradiance { max_depth: Some(3), rr_depth: 5 },
        ),
        (
            "<integrator type='aov'><string name='aovs' value='a:directional_albedo,m:material_id'/></integrator>",
            Integrator::Aov {
                channels: vec![
                    AovChannel { name: "a".into(), kind: Aov::DirectionalAlbedo },
                    AovChannel { name: "m".into(), kind: Aov::MaterialId },
                ],
            },
        ),
        (
            "<integrator type='direct'><boolean name='hide_emitters' value='true'/></integrator>",
            Integrator::Direct { hide_emitters: true },
        ),
        (
            "<integrator type='aov'><string name='aovs' value='d:depth, n:sh_normal'/></integrator>",
            Integrator::Aov {
                channels: vec![
                    AovChannel { name: "d".into(), kind: Aov::Depth },
                    AovChannel { name: "n".into(), kind: Aov::ShNormal },
                ],
            },
        ),
    ] {
        let text = format!("<scene version='3.0.0'><sensor type='orthographic'/>{xml}</scene>");
        assert_eq!(load_text_with(&text, &[]).unwrap().description.integrator, expected, "{xml}");
    }
}

#[test]
fn included_files_stand_in_the_place_of_the_include() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    write("main.xml", &scene("<shape type='cube'/><include filename='parts/a.xml'/><shape type='cube'/>"));
    write("parts/a.xml", "<scene version='3.0.0'><shape type='disk'/><include filename='b.xml'/></scene>");
    write("parts/b.xml", "<shape type='sphere'><float name='radius' value='3'/></shape>");
    let main = folder.path().join("main.xml");
    let names = |loaded: Loaded| -> Vec<String> {
        loaded.description.shapes.into_iter().map(|shape| shape.name).collect()
    };
    assert_eq!(names(load(&main, &LoadOptions::default()).unwrap()), ["cube", "disk", "sphere", "cube"]);

    write("parts/b.xml", "<scene version='3.0.0'>\n <include filename='../main.xml'/></scene>");
    let error = load(&main, &LoadOptions::default()).unwrap_err();
    assert!(error.place().ends_with("b.xml:2:21"), "{error}");
    assert!(error.to_string().ends_with("`../main.xml` includes itself"), "{error}");
}

#[test]
fn shapes_share_what_they_read() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nf 1/1 2/1 3/1\n").unwrap();
    let shape =
        |more: &str| format!("<shape type='obj'><string name='filename' value='m.obj'/>{more}</shape>");
    let unflipped = shape("<boolean name='flip_tex_coords' value='false'/>");
    let path = folder.path().join("s.xml");
    fs::write(&path, scene(&[shape(""), shape(""), unflipped].concat())).unwrap();
    let scene = load(&path, &LoadOptions::default()).unwrap().description;
    let mesh = |i: usize| match &scene.shapes[i].geometry {
        Geometry::Mesh { mesh, face_normals: false } => mesh,
        other => panic!("{other:?}"),
    };
    assert!(Arc::ptr_eq(mesh(0), mesh(1)));
    assert!(!Arc::ptr_eq(mesh(0), mesh(2)));
    assert!(mesh(0).uvs.iter().all(|uv| uv.y == 0.75) && mesh(2).uvs.iter().all(|uv| uv.y == 0.25));
    assert_eq!(scene.shapes[0].name, "m.obj");
}

#[test]
fn environments_are_pictures_that_may_be_turned() {
    let folder = tempfile::tempdir().unwrap();
    let plane = |name: &str, value: f32| Channel { name: name.into(), samples: vec![value, 1.0, 2.0, 3.0] };
    let write = |name: &str, red: f32| {
        let channels = vec![plane("R", red), plane("G", 0.0), plane("B", 0.0)];
        let picture = Picture { width: 2, height: 2, channels, place: None };
        save(&picture, &folder.path().join(name), Preview::default()).unwrap();
    };
    write("sky.exr", 0.5);
    write("hole.exr", -0.5);
    let path = folder.path().join("scene.xml");
    let read = |file: &str, more: &str| {
        let name = format!("<string name='filename' value='{file}'/>");
        fs::write(&path, scene(&format!("<emitter type='envmap'>{name}{more}</emitter>"))).unwrap();
        load(&path, &LoadOptions::default())
    };
    let turned = "<transform name='to_world'><scale value='2'/><rotate y='1' angle='90'/></transform>";
    let loaded = read("sky.exr", &format!("<float name='scale' value='3'/>{turned}")).unwrap();
    let [Emitter::Envmap { picture, scale, to_world }] = &loaded.description.emitters[..] else {
        panic!("{:?}", loaded.description.emitters)
    };
    assert_eq!((picture.width, *scale), (2, 3.0));
    assert!((*to_world * glam::DVec3::Z - glam::DVec3::X).length() < 1e-12);
    let holed = read("hole.exr", "").unwrap().warnings;
    assert!(
        holed.iter().any(|w| w.message() == "negative values in the picture (1) are taken as 0"),
        "{holed:?}"
    );
    for (file, more, expected) in [
        ("sky.exr", "<float name='scale' value='-1'/>", "`scale` must not be negative"),
        ("sky.exr", "<float name='scale' value='2e38'/>", "R of pixel (0, 1) is 2"),
        ("sky.exr", "<transform name='to_world'><scale x='2'/></transform>", "not stretched"),
    ] {
        let error = read(file, more).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn nine_coefficients_are_a_light() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<String> = (0..9).map(|i| format!("[{i}, 0.5, -1]")).collect();
    fs::write(folder.path().join("sky.json"), format!("{{\"coefficients\": [{}]}}", rows.join(","))).unwrap();
    fs::write(folder.path().join("bad.json"), "{\"coefficients\": [[1, 2, 3]]}").unwrap();
    let path = folder.path().join("scene.xml");
    let read = |inside: &str| {
        fs::write(&path, scene(&format!("<emitter type='shlight'>{inside}</emitter>"))).unwrap();
        load(&path, &LoadOptions::default())
    };
    let inside = "<string name='filename' value='sky.json'/><float name='scale' value='2'/>";
    let loaded = read(inside).unwrap();
    let [Emitter::Sh { coefficients, .. }] = &loaded.description.emitters[..] else {
        panic!("{:?}", loaded.description.emitters)
    };
    assert_eq!(coefficients[8].to_array(), [16.0, 1.0, -2.0]);
    let error = read("<string name='filename' value='bad.json'/>").unwrap_err();
    assert!(error.to_string().contains("the coefficients can't be used: "), "{error}");
}

#[test]
fn a_name_without_an_extension_is_not_guessed_but_proposed() {
    let told = |path: &str| {
        let error = load(path.as_ref(), &LoadOptions::default()).expect_err("nothing is guessed");
        Diagnostic::help(&error).expect("there is a way out").to_string()
    };
    assert_eq!(told("scenes/cornell"), "did you mean `scenes/cornell.xml`?");
    assert!(told("scenes/quark").starts_with("scenes are Mitsuba 3 `.xml`"));
    assert_eq!(told("scenes/cornel.xml"), "did you mean `scenes/cornell.xml`?");
}

#[test]
fn sensors_are_chosen_by_their_number() {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    let path = folder.path().join("scene.xml");
    let film = "<film type='hdrfilm'><rfilter type='box'/></film>";
    let sensor = |kind: &str| format!("<sensor type='{kind}'>{film}</sensor>");
    let body = [sensor("perspective"), sensor("orthographic")].concat();
    let head = "<scene version='3.0.0'><integrator type='path'/><emitter type='constant'/>";
    fs::write(&path, format!("{head}{body}</scene>")).expect("writable");
    let with = |sensor| load(&path, &LoadOptions { sensor, ..LoadOptions::default() });
    for (chosen, parallel, warnings) in [(None, false, 1), (Some(0), false, 0), (Some(1), true, 0)] {
        let loaded = with(chosen).expect("it loads");
        let is_parallel = matches!(loaded.description.sensor.projection, Projection::Orthographic);
        assert_eq!((is_parallel, loaded.warnings.len()), (parallel, warnings), "{chosen:?}");
    }
    let error = with(Some(2)).expect_err("there are two").to_string();
    assert!(error.contains("there is no sensor 2: the scene has 2"), "{error}");
    let bare = load("gen:soup:10".as_ref(), &LoadOptions { sensor: Some(1), ..LoadOptions::default() });
    assert!(bare.expect_err("it has one").to_string().contains("a bare mesh is given one"));
}

#[test]
fn legal_oddities_are_warnings() {
    let has = |text: &str, part: &str| {
        let found = warnings(text);
        assert!(found.iter().any(|w| w.contains(part)), "{part}: {found:?}");
    };
    has(&scene("<bsdf type='diffuse' id='lonely'/>"), "the bsdf `lonely` is never used");
    has(&scene("<sensor type='orthographic'/>"), "the first sensor is used");
    has(&scene(""), "nothing in the scene shines");
    has("<scene version='3.0.0'><sensor type='orthographic'/></scene>", "no integrator");
    has("<scene version='3.0.0'><sensor type='orthographic'/></scene>", "no film");
    has(
        "<scene version='3.0.0'><sensor type='orthographic'><film type='hdrfilm'>
           <string name='pixel_format' value='xyz'/></film></sensor></scene>",
        "tristimulus values",
    );
}

#[test]
fn structure_that_is_wrong_is_refused() {
    for (text, expected) in [
        (
            "<scene version='3.0.0'>\n <shape></scene>",
            "2:9: this is not XML: expected 'shape' tag, not 'scene' | ",
        ),
        ("<scene version='3.0.0'>\n <shape ", "2:8: this is not XML: "),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]>\n<scene/>", "1:1: document type declarations are not read | remove"),
        ("<shape type='cube'/>", "1:2: the root of a scene file is `scene`, not `shape` | write <scene"),
        ("<scene/>", "1:2: `scene` needs the attribute `version` | "),
        ("<scene version='0.6.0'/>", "1:17: scenes of Mitsuba version `0.6.0` are not read | "),
        ("<scene version='3.0.0'/>", "1:2: the scene has no sensor | write <sensor type="),
        ("", "1:1: this is not XML: "),
    ] {
        let found = refusal(text);
        assert!(found.starts_with(expected), "{text}\n   found {found}\nexpected {expected}");
    }
    let deep = scene(&("<bsdf type='twosided'>".repeat(100) + &"</bsdf>".repeat(100)));
    assert!(refusal(&deep).contains("elements are nested more than 64 deep"));
}

#[test]
fn elements_and_types_that_are_wrong_are_refused() {
    for (body, expected) in [
        ("<shap type='cube'/>", "3:2: there is no element `shap` | did you mean `shape`?"),
        ("<medium type='x'/>", "3:2: the element `medium` is not supported yet | "),
        (" words ", "3:2: text between elements has no meaning | "),
        ("<shape type='cone'/>", "3:14: there is no shape `cone` | supported shapes are `sphere`, "),
        ("<shape type='spere'/>", "3:14: there is no shape `spere` | did you mean `sphere`? "),
        (
            "<shape type='linearcurve'/>",
            "3:14: the shape `linearcurve` is not supported yet | supported shapes are ",
        ),
        (
            "<bsdf type='thindielectric' id='x'/>",
            "3:13: the bsdf `thindielectric` is not supported yet | supported bsdfs are `diffuse`, `conductor`, ",
        ),
        ("<emitter type='sunsky'/>", "3:16: the emitter `sunsky` is not supported yet | "),
        ("<emitter type='envmap'/>", "3:2: the emitter `envmap` needs `filename` | "),
        ("<shape kind='cube'/>", "3:2: `shape` needs the attribute `type` | "),
        ("<shape type='cube' tpye='x'/>", "3:20: `shape` has no attribute `tpye` | did you mean `type`?"),
        ("<shape type='cube'><ref id='no'/></shape>", "3:29: no object has the id `no` | give the object"),
        (
            "<bsdf type='diffuse' id='gold'/><shape type='cube'><ref id='glod'/></shape>",
            "3:61: no object has the id `glod` | did you mean `gold`?",
        ),
        (
            "<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>",
            "4:26: two objects have the id `a` | ids name one object each",
        ),
        ("<shape type='$what'/>", "3:14: the parameter `$what` has no value | write <default name=\"what\""),
        ("<include filename='no.xml'/>", "3:20: there is no file `no.xml` | looked for /"),
        ("<emitter type='area'/>", "3:2: an `area` emitter stands inside the shape that shines | "),
        ("<emitter type='constant'/><emitter type='constant'/>", "3:28: a scene has one environment"),
        ("<film type='hdrfilm'/>", "3:2: the scene takes no film | "),
        (
            "<shape type='cube'><float name='a' value='1'><x/></float></shape>",
            "3:47: `x` can't stand inside `float`",
        ),
    ] {
        assert_refused(body, expected);
    }
}

#[test]
fn properties_that_are_wrong_are_refused() {
    for (inside, expected) in [
        (
            "<float name='raduis' value='2'/>",
            "4:14: the shape `sphere` has no property `raduis` | did you mean `radius`?",
        ),
        ("<float name='radius' value='0'/>", "4:29: `radius` must be greater than 0, but is 0 | "),
        ("<float name='radius' value='two'/>", "4:29: `two` is not a number | numbers look like"),
        ("<float name='radius' value='NaN'/>", "4:29: `NaN` is not a finite number of 32 bits | "),
        ("<float name='radius' value='1e99'/>", "4:29: `1e99` is not a finite number of 32 bits | "),
        (
            "<float name='radius' val='1'/>",
            "4:2: `float` needs the attribute `value` | did you mean `value` by `val`?",
        ),
        (
            "<string name='radius' value='1'/>",
            "4:30: `radius` must be written as `float`, not as `string` | ",
        ),
        (
            "<boolean name='flip_normals' value='yes'/>",
            "4:37: `yes` is not a boolean | booleans are `true` and `false`",
        ),
        (
            "<float name='radius' value='1'/><float name='radius' value='1'/>",
            "4:46: `radius` is given twice | ",
        ),
        ("<point name='center' value='1 2'/>", "4:29: expected 3 numbers, found 2 | "),
        (
            "<point name='center' x='1' value='1 2 3'/>",
            "4:28: `value` and `x`, `y`, `z` exclude each other | ",
        ),
        (
            "<transform name='toWorld'/>",
            "4:18: the shape `sphere` has no property `toWorld` | did you mean `to_world`?",
        ),
        (
            "<transform name='to_world'><turn/></transform>",
            "4:29: a transform has no step `turn` | the steps of a transform are",
        ),
        (
            "<transform name='to_world'><scale x='0'/></transform>",
            "4:2: the transform is singular: it flattens space | ",
        ),
        (
            "<transform name='to_world'><scale x='2'/></transform>",
            "4:2: a `sphere` can't be sheared or scaled unevenly | ",
        ),
        (
            "<transform name='to_world'><rotate angle='2'/></transform>",
            "4:29: the axis of a rotation is zero | ",
        ),
        (
            "<transform name='to_world'><rotate y='1'/></transform>",
            "4:29: `rotate` needs the attribute `angle` | ",
        ),
        (
            "<transform name='to_world'><lookat origin='0 0 0' target='0 0 0' up='0 1 0'/></transform>",
            "4:29: `origin` and `target` are the same point | ",
        ),
        (
            "<transform name='to_world'><lookat origin='0 0 0' target='0 1 0' up='0 1 0'/></transform>",
            "4:70: `up` is zero or parallel to the direction of view | ",
        ),
        (
            "<transform name='to_world'><matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/></transform>",
            "4:43: the last row of the matrix is not `0 0 0 1` | ",
        ),
        (
            "<transform name='to_world'><scale value='1e30'/><scale value='1e30'/></transform>",
            "4:50: the transform overflows here | ",
        ),
        (
            "<bsdf type='diffuse'/><bsdf type='diffuse'/>",
            "4:24: the shape `sphere` takes one bsdf, not several | ",
        ),
        ("<emitter type='point'/>", "4:2: the emitter `point` can't stand inside a shape | "),
        ("<shape type='cube'/>", "4:2: the shape `sphere` takes no shape | "),
    ] {
        assert_refused(&format!("<shape type='sphere'>\n{inside}</shape>"), expected);
    }
}

#[test]
fn materials_and_lights_that_are_wrong_are_refused() {
    for (body, expected) in [
        (
            "<bsdf type='diffuse'><rgb name='reflectence' value='1'/></bsdf>",
            "3:33: the bsdf `diffuse` has no property `reflectence` | did you mean `reflectance`?",
        ),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='0 0 1.5'/></bsdf>",
            "3:53: `reflectance` must lie between 0 and 1 | a surface can't",
        ),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='#fff'/></bsdf>",
            "3:53: hexadecimal colours like `#fff` are refused | `rgb` takes linear values",
        ),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='1 1'/></bsdf>",
            "3:53: `rgb` takes 1 or 3 numbers, found 2 | ",
        ),
        (
            "<bsdf type='diffuse'><spectrum name='reflectance' value='1 0'/></bsdf>",
            "3:58: `spectrum` takes one number or a curve, found 2 numbers | ",
        ),
        (
            "<bsdf type='diffuse'><texture type='checkerboard'/></bsdf>",
            "3:23: the bsdf `diffuse` takes no texture | a texture goes where its `name` says; \
             the properties here are `reflectance`",
        ),
        (
            "<bsdf type='diffuse'><bsdf type='diffuse' name='reflectance'/></bsdf>",
            "3:23: `reflectance` must be written as `rgb` or `texture`, not as `bsdf` | ",
        ),
        ("<bsdf type='twosided'/>", "3:2: `twosided` takes one bsdf, or a second for the back, but has 0 | "),
        (
            "<bsdf type='twosided'><bsdf type='dielectric'/></bsdf>",
            "3:24: `twosided` is for opaque bsdfs: a `dielectric` already has two sides | ",
        ),
        ("<bsdf type='twosided' id='a'><ref id='a'/></bsdf>", "3:39: an object can't contain itself | "),
        (
            "<bsdf type='twosided'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>",
            "3:24: a `twosided` bsdf can't stand inside another | ",
        ),
        (
            "<bsdf type='conductor'><string name='material' value='Ai'/></bsdf>",
            "3:55: the conductor `Ai` is not known | ",
        ),
        (
            "<bsdf type='conductor'><string name='material' value='Au'/><rgb name='k' value='1'/></bsdf>",
            "3:55: `k` and `material` exclude each other | ",
        ),
        (
            "<bsdf type='dielectric'><string name='int_ior' value='dimond'/></bsdf>",
            "3:55: the index of refraction of `dimond` is not known | did you mean `diamond`?",
        ),
        (
            "<texture type='bitmap'><string name='filename' value='no.png'/></texture>",
            "3:55: there is no file `no.png` | looked for /",
        ),
        ("<texture type='bitmap'/>", "3:2: the texture `bitmap` needs `filename` | write <string "),
        (
            "<texture type='checkerboard'><texture type='checkerboard' name='color0'/></texture>",
            "3:31: `color0` must be written as `rgb`, not as `texture` | ",
        ),
        (
            "<shape type='obj'><string name='file' value='a'/></shape>",
            "3:2: the shape `obj` needs `filename` | ",
        ),
        (
            "<emitter type='point'><rgb name='intensity' value='-1'/></emitter>",
            "3:52: `intensity` must not be negative or exceed 32 bits | ",
        ),
        (
            "<emitter type='point'><boolean name='intensity' value='true'/></emitter>",
            "3:56: `intensity` must be written as `rgb`, not as `boolean` | ",
        ),
        (
            "<emitter type='directional'><vector name='direction' x='0'/></emitter>",
            "3:30: `direction` is zero | ",
        ),
        (
            "<emitter type='spot'><float name='beam_width' value='30'/></emitter>",
            "3:54: `beam_width` is 30, outside of [0, 20] | ",
        ),
    ] {
        assert_refused(body, expected);
    }
}

#[test]
fn films_have_mitsubas_defaults() {
    let film = |inside: &str| {
        let text = format!("<scene version='3.0.0'><sensor type='perspective'>{inside}</sensor></scene>");
        load_text_with(&text, &[]).expect(inside).description.sensor.film
    };
    let filter = |inside: &str| film(&format!("<film type='hdrfilm'>{inside}</film>")).filter;
    let gaussian = ReconstructionFilter::Gaussian { stddev: 0.5 };
    assert_eq!(film(""), Film { filter: gaussian, ..Film::new(768, 576) });
    assert_eq!(filter(""), gaussian);
    assert_eq!(filter("<rfilter type='gaussian'/>"), gaussian);
    assert_eq!(filter("<rfilter type='box'/>"), ReconstructionFilter::Box);
    assert_eq!(filter("<rfilter type='tent'/>"), ReconstructionFilter::Tent { radius: 1.0 });
    let third = 1.0 / 3.0;
    assert_eq!(filter("<rfilter type='mitchell'/>"), ReconstructionFilter::Mitchell { b: third, c: third });
    let (b, c) = (0.5, third);
    let other = "<rfilter type='mitchell'><float name='B' value='0.5'/></rfilter>";
    assert_eq!(filter(other), ReconstructionFilter::Mitchell { b, c });
    assert_eq!(filter("<rfilter type='catmullrom'/>"), ReconstructionFilter::CatmullRom);
    assert_eq!(filter("<rfilter type='lanczos'/>"), ReconstructionFilter::Lanczos { lobes: 3 });
    let cropped = film(
        "<film type='hdrfilm'><integer name='width' value='10'/><integer name='height' value='8'/>
           <integer name='crop_offset_y' value='2'/><integer name='crop_width' value='5'/>
           <integer name='crop_height' value='6'/></film>",
    );
    assert_eq!(cropped.window(), Crop { x: 0, y: 2, width: 5, height: 6 });
}

#[test]
fn a_thin_lens_needs_its_aperture_and_its_focus() {
    let sensor =
        |inside: &str| format!("<scene version='3.0.0'><sensor type='thinlens'>\n{inside}</sensor></scene>");
    let lens = "<float name='fov' value='60'/><float name='aperture_radius' value='0.5'/><float name='focus_distance' value='3'/>";
    let projection = load_text_with(&sensor(lens), &[]).unwrap().description.sensor.projection;
    let Projection::ThinLens { x_fov, aperture_radius, focus_distance } = projection else {
        panic!("no lens")
    };
    assert!((x_fov.to_degrees() - 60.0).abs() < 1e-9);
    assert_eq!((aperture_radius, focus_distance), (0.5, 3.0));
    for (inside, expected) in [
        ("", "1:25: the sensor `thinlens` needs `aperture_radius` | write <float name=\"aperture_radius\""),
        (
            "<float name='aperture' value='1'/>",
            "1:25: the sensor `thinlens` needs `aperture_radius` | did you mean",
        ),
        (
            "<float name='aperture_radius' value='1'/>",
            "1:25: the sensor `thinlens` needs `focus_distance` | write <float name=\"focus_distance\"",
        ),
        (
            "<float name='aperture_radius' value='0'/><float name='focus_distance' value='1'/>",
            "2:38: `aperture_radius` must be greater than 0, but is 0",
        ),
    ] {
        let found = refusal(&sensor(inside));
        assert!(found.starts_with(expected), "{inside}\n   found {found}\nexpected {expected}");
    }
}

#[test]
fn sensors_and_integrators_that_are_wrong_are_refused() {
    let film = |inside: &str| format!("<film type='hdrfilm'>{inside}</film>");
    for (inside, expected) in [
        (film("<integer name='width' value='0'/>"), "2:51: `width` must be at least 1, but is 0 | "),
        (
            film("<integer name='height' value='99999'/>"),
            "2:52: `height` must be at most 65536, but is 99999 | ",
        ),
        (
            film("<string name='pixel_format' value='rgbb'/>"),
            "2:57: `rgbb` is no value of `pixel_format` | did you mean `rgba`?",
        ),
        (
            film("<rfilter type='tend'/>"),
            "2:37: there is no rfilter `tend` | did you mean `tent`? supported rfilters are `box`, ",
        ),
        (
            film("<rfilter type='box'><float name='radius' value='1'/></rfilter>"),
            "2:55: the rfilter `box` has no property `radius` | ",
        ),
        (
            film("<rfilter type='tent'><float name='radius' value='-1'/></rfilter>"),
            "2:71: `radius` must be greater than 0, but is -1 | ",
        ),
        (
            film("<rfilter type='gaussian'><float name='stddev' value='1000'/></rfilter>"),
            "2:75: `stddev` is 1000, more than 64 pixels | lengths of a filter",
        ),
        (
            film("<rfilter type='mitchell'><float name='B' value='1.5'/></rfilter>"),
            "2:70: `B` must lie between 0 and 1, but is 1.5 | ",
        ),
        (
            film("<rfilter type='lanczos'><integer name='lobes' value='0'/></rfilter>"),
            "2:75: `lobes` must be at least 1, but is 0 | ",
        ),
        (
            film("<integer name='width' value='9'/><integer name='crop_offset_x' value='9'/>"),
            "2:92: the crop ends at 18, but the film at 9 | `crop_offset_x` and `crop_width` together",
        ),
        (
            "<float name='fov' value='180'/>".into(),
            "2:26: `fov` must lie between 0 and 180 degrees, but is 180 | ",
        ),
        (
            "<string name='fov_axis' value='w'/>".into(),
            "2:32: `w` is no value of `fov_axis` | the choices are `x`, `y`, ",
        ),
        (
            "<string name='focal_length' value='long'/>".into(),
            "2:36: `long` is no focal length | write `50mm`",
        ),
        (
            "<float name='far_clip' value='0.001'/>".into(),
            "2:31: `far_clip` (0.001) must be greater than `near_clip` (0.01) | ",
        ),
        (
            "<transform name='to_world'><scale value='2'/></transform>".into(),
            "2:2: the `to_world` of a `perspective` sensor can't scale or shear | ",
        ),
        (
            "<sampler type='independent'><integer name='sample_count' value='0'/></sampler>".into(),
            "2:65: `sample_count` must be at least 1, but is 0 | ",
        ),
    ] {
        let found = refusal(&format!(
            "<scene version='3.0.0'><sensor type='perspective'>\n{inside}</sensor></scene>"
        ));
        assert!(found.starts_with(expected), "{inside}\n   found {found}\nexpected {expected}");
    }
    for (integrator, expected) in [
        (
            "type='volpath'/>",
            "2:19: the integrator `volpath` is not supported yet | supported integrators are ",
        ),
        (
            "type='path'><integer name='max_depth' value='-2'/></integrator>",
            "2:58: `max_depth` must be -1 (no limit) or",
        ),
        (
            "type='path'><float name='max_depth' value='2'/></integrator>",
            "2:56: `max_depth` must be written as `integer`, not as `float` | ",
        ),
        ("type='aov'/>", "2:2: the integrator `aov` needs `aovs` | "),
        (
            "type='aov'><string name='aovs' value='a:deepth'/></integrator>",
            "2:51: the variable `deepth` is not supported | did you mean `depth`?",
        ),
        ("type='aov'><string name='aovs' value='a'/></integrator>", "2:51: `a` is not `name:type` | "),
        ("type='aov'><integrator type='path'/></integrator>", "2:2: the integrator `aov` needs `aovs` | "),
    ] {
        let found = refusal(&format!(
            "<scene version='3.0.0'><sensor type='orthographic'/>\n<integrator {integrator}</scene>"
        ));
        assert!(found.starts_with(expected), "{integrator}\n   found {found}\nexpected {expected}");
    }
}

#[test]
fn the_offending_text_is_underlined() {
    let text = scene("<bsdf type='difuse' id='x'/>");
    let error = load_text_with(&text, &[]).unwrap_err();
    let span = *error.labels().unwrap().next().unwrap().inner();
    assert_eq!(&text[span.offset()..span.offset() + span.len()], "difuse");
}

/// A group `g` of `inside`.
fn group(inside: &str) -> String {
    format!("<shape type='shapegroup' id='g'>{inside}</shape>")
}

#[test]
fn a_group_is_drawn_where_it_is_placed() {
    let place =
        "<shape type='instance'><ref id='g'/><transform name='to_world'><scale x='-2'/></transform></shape>";
    // An instance may stand before its group.
    let scene = load_body(&format!(
        "{place}{}{place}<shape type='cube'/>",
        group("<shape type='cube'><bsdf type='plastic'/></shape><shape type='sphere'/>")
    ));
    assert_eq!((scene.shapes.len(), scene.groups.len(), scene.instances.len()), (1, 1, 2));
    let ShapeGroup { name, shapes } = &scene.groups[0];
    assert_eq!((name.as_str(), shapes.len()), ("g", 2));
    assert!(matches!(scene.materials[shapes[0].material.0 as usize], Material::Plastic { .. }));
    assert_eq!(shapes[1].material, scene.shapes[0].material);
    assert!(scene.instances.iter().all(|instance| instance.group == GroupIndex(0)));
    assert_eq!(scene.instances[1].to_world.matrix3.determinant(), -2.0);
    assert_eq!(warnings(&self::scene(&group("<shape type='cube'/>")))[0], "the shape `g` is never used");
}

#[test]
fn groups_and_instances_that_are_wrong_are_refused() {
    for (body, expected) in [
        ("<shape type='instance'/>".to_owned(), "3:2: this `instance` places nothing | write <ref id="),
        (
            "<shape type='instance'><shape type='cube'/></shape>".to_owned(),
            "3:25: an `instance` places a `shapegroup`, not a `cube` | put the shape into a <shape type=",
        ),
        (
            group("<shape type='cube'/>") + "\n<shape type='instance'><ref id='g'/><ref id='g'/></shape>",
            "3:2: an `instance` places one `shapegroup`, not several | ",
        ),
        (
            group("<shape type='cube'/>")
                + "\n<shape type='instance'><ref id='g'/><bsdf type='diffuse'/></shape>",
            "4:38: the shape `instance` takes no bsdf | ",
        ),
        (
            group("<shape type='cube'/>")
                + "\n<shape type='instance'><ref id='g'/><transform name='to_world'><scale x='0'/></transform></shape>",
            "4:38: ",
        ),
        (
            group("<shape type='cube'><emitter type='area'/></shape>"),
            "3:53: a shape in a `shapegroup` can't shine | let the shape that shines stand in the scene itself",
        ),
        (
            group("<shape type='shapegroup'/>"),
            "3:34: a `shapegroup` can't stand in a `shapegroup` | place its shapes in this group",
        ),
        (
            group("<shape type='cube'/>")
                + "\n<shape type='shapegroup'><shape type='instance'><ref id='g'/></shape></shape>",
            "4:27: an `instance` can't stand in a `shapegroup` | ",
        ),
        (group("<bsdf type='diffuse'/>"), "3:34: the shape `shapegroup` takes no bsdf | "),
        (group("<shape type='spere'/>"), "3:46: there is no shape `spere` | did you mean `sphere`? "),
        (
            group("<float name='radius' value='1'/>"),
            "3:46: the shape `shapegroup` has no property `radius` | ",
        ),
    ] {
        assert_refused(&body, expected);
    }
}
