//! The program as a shell sees it: exit codes, and what goes to which stream.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path};

use program::{command, fails, folder, packlight, path, stderr, stdout, triangle};

#[test]
fn help_is_on_stdout_with_examples_and_exit_codes() {
    let output = packlight(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    for part in ["render", "info", "Examples:", "Exit codes:"] {
        assert!(stdout(&output).contains(part), "{part} is not in\n{}", stdout(&output));
    }
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

#[test]
fn help_of_a_command_is_grouped() {
    let output = packlight(&["render", "--help"]);
    assert_eq!(output.status.code(), Some(0));
    for part in ["Picture:", "Machine", "--spp", "--backend", "--define"] {
        assert!(stdout(&output).contains(part), "{part} is not in\n{}", stdout(&output));
    }
}

#[test]
fn version_says_which_lanes_were_compiled() {
    let output = packlight(&["--version"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).starts_with(concat!("packlight ", env!("CARGO_PKG_VERSION"))));
    assert!(stdout(&output).contains("f32x8 in "), "{}", stdout(&output));
}

#[test]
fn usage_errors_are_2() {
    fails(&["rendr"], 2, "render");
    fails(&["render", "a.xml"], 2, "--output");
    fails(&["render", "a.xml", "-o", "a.exr", "--spp", "0"], 2, "--spp");
    fails(&["render", "a.xml", "-o", "a.exr", "--width", "0"], 2, "--width");
    fails(&["render", "a.xml", "-o", "a.exr", "--threads", "0"], 2, "--threads");
    fails(&["render", "a.xml", "-o", "a.exr", "--integrator", "bdpt"], 2, "whitted");
    fails(&["render", "a.xml", "-o", "a.exr", "--exposure", "nan"], 2, "--exposure");
    fails(&["render", "a.xml", "-o", "a.exr", "-D", "spp"], 2, "NAME=VALUE");
}

#[test]
fn what_does_not_fit_is_told_with_the_usage_of_its_command() {
    let layer = ["render", "scenes/cornell.xml", "-o", "a.png", "--aov", "albedo"];
    fails(&layer, 2, "\nUsage: packlight render [OPTIONS] <SCENE>\n");
    fails(&["render", "scenes/cornell.xml", "--pixel", "600,0"], 2, "\nUsage: packlight render ");
    fails(&["brdf", "diffuse"], 2, "\nUsage: packlight brdf [OPTIONS] [MODEL]\n");
}

#[test]
fn a_number_below_nought_is_a_value_that_is_refused() {
    for (option, value) in [
        ("--seed", "-1"),
        ("--spp", "-4"),
        ("--target-error", "-0.1"),
        ("--crop", "-1,2,3,4"),
        ("--cropwindow", "-0.1,1,0,1"),
        ("--pixel", "-1,2"),
    ] {
        fails(&["render", "a.xml", option, value], 2, &format!("invalid value '{value}' for '{option} <"));
    }
}

#[test]
fn an_option_that_does_nothing_to_a_file_is_told() {
    let folder = folder("idle");
    let scene = triangle(&folder);
    let said = |out: &str, option: &str, value: &str| {
        let out = path(&folder, out);
        let output = packlight(&["render", &scene, "-o", &out, "--width", "4", "--spp", "1", option, value]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stderr(&output)
    };
    for (option, value) in [("--exr-type", "half"), ("--exr-compression", "rle"), ("--metadata", "all")] {
        assert_eq!(said("a.png", option, value), format!("warning: {option} only changes an .exr\n"));
        assert_eq!(said("a.exr", option, value), "");
    }
    for (option, value) in [("--exposure", "1"), ("--tonemap", "agx")] {
        assert!(said("a.hdr", option, value).starts_with(&format!("warning: {option} only changes a .png;")));
        assert_eq!(said("a.png", option, value), "");
    }
}

#[test]
fn an_unknown_extension_is_2_whatever_the_scene() {
    fails(&["render", "no-such-scene.xml", "-o", "a.jpg"], 2, ".exr, .hdr or .png");
    fails(&["render", "no-such-scene.xml", "-o", "a"], 2, ".exr, .hdr or .png");
}

#[test]
fn no_arguments_show_the_help() {
    fails(&[], 2, "Usage:");
}

#[test]
fn a_missing_scene_is_1_and_named() {
    let folder = folder("missing-scene");
    fails(&["info", "no-such-scene.xml"], 1, "no-such-scene.xml");
    let out = path(&folder, "a.exr");
    fails(&["render", "no-such-scene.xml", "-o", &out], 1, "no-such-scene.xml");
    assert_eq!(fs::read_dir(&folder).expect("readable").count(), 0, "something was left behind");
}

#[test]
fn a_missing_folder_is_1_before_anything_is_loaded() {
    let folder = folder("missing-folder");
    let out = path(&folder, "no/such/a.exr");
    fails(&["render", "no-such-scene.xml", "-o", &out], 1, "create it first");
    assert_eq!(fs::read_dir(&folder).expect("readable").count(), 0, "something was left behind");
}

#[test]
fn a_folder_in_place_of_a_picture_is_1() {
    let folder = folder("folder-as-picture");
    let out = path(&folder, "a.exr");
    fs::create_dir(&out).expect("a folder can be made");
    fails(&["render", "no-such-scene.xml", "-o", &out], 1, "is a folder");
}

/// `/proc` takes no files, not even from root.
#[cfg(target_os = "linux")]
#[test]
fn an_unwritable_folder_is_1_before_anything_is_loaded() {
    fails(&["render", "no-such-scene.xml", "-o", "/proc/a.exr"], 1, "can't write into /proc");
}

#[test]
fn a_refused_scene_is_plain_text_in_a_pipe() {
    let folder = folder("refused-scene");
    let scene = path(&folder, "broken.xml");
    fs::write(&scene, "<scene version=\"3.0.0\">\n    <shape type=\"sphere\"\n</scene>\n").expect("writable");
    let output = packlight(&["info", &scene]);
    assert_eq!(output.status.code(), Some(1), "{}", stdout(&output));
    assert!(output.stdout.is_empty());
    let message = stderr(&output);
    assert!(message.contains("broken.xml"), "{message}");
    assert!(message.is_ascii() && !message.contains('\x1b'), "{message}");
}

#[test]
fn json_is_one_object_and_nothing_else() {
    let folder = folder("json");
    let scene = triangle(&folder);
    let out = path(&folder, "a.exr");
    for arguments in [
        vec!["info", &scene, "--json"],
        vec!["render", &scene, "-o", &out, "--width", "8", "--spp", "1", "--json"],
    ] {
        let output = packlight(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
        assert_eq!(json["scene"], scene.as_str());
        assert!(json["lanes"].as_str().is_some_and(|lanes| lanes.starts_with("f32x8")));
    }
}

#[test]
fn a_render_is_told_on_stdout_unless_quiet() {
    let folder = folder("summary");
    let scene = triangle(&folder);
    let out = path(&folder, "a.png");
    let arguments = ["render", &scene, "-o", &out, "--width", "8", "--spp", "1", "--threads", "1"];
    let told = packlight(&arguments);
    assert_eq!(told.status.code(), Some(0), "{}", stderr(&told));
    for part in ["8 x 6", "1 sample a pixel", "1 thread", "Mrays/s"] {
        assert!(stdout(&told).contains(part), "{part} is not in\n{}", stdout(&told));
    }
    assert!(!stderr(&told).contains("rendering ["), "a progress bar in a pipe");
    let quiet = packlight(&[&arguments[..], &["--quiet"]].concat());
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stdout.is_empty(), "{}", stdout(&quiet));
}

#[test]
fn channels_without_names_are_refused_for_aov() {
    let folder = folder("aov-png");
    let scene = triangle(&folder);
    let out = path(&folder, "a.png");
    fails(&["render", &scene, "-o", &out, "--integrator", "aov"], 2, "only an .exr");
}

#[test]
fn files_have_the_channels_that_the_film_asks_for() {
    let folder = folder("pixel-format");
    let (scene, out) = (path(&folder, "scene.xml"), path(&folder, "out.exr"));
    for (format, expected) in
        [("luminance", "Y depth.Z"), ("rgba", "A B G R depth.Z"), ("luminance_alpha", "A Y depth.Z")]
    {
        let text = format!(
            "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>\
             <integer name='width' value='8'/><integer name='height' value='8'/>\
             <string name='pixel_format' value='{format}'/></film></sensor></scene>"
        );
        fs::write(&scene, text).expect("a scene can be written");
        let output = packlight(&["render", &scene, "-o", &out, "--spp", "2", "--aov", "depth"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let written = exr::meta::MetaData::read_from_file(&out, false).expect("an EXR file");
        let channels = &written.headers[0].channels.list;
        let mut names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
        names.sort();
        assert_eq!(names.join(" "), expected);
        fails(&["render", &scene, "-o", &out, "--shard", "1/2"], 2, "a pixel_format of rgb");
    }
}

#[test]
fn a_closed_pipe_is_not_a_panic() {
    let folder = folder("closed-pipe");
    let scene = triangle(&folder);
    for arguments in [vec!["info", &scene], vec!["--help"]] {
        let mut child = command(&arguments).spawn().expect("the program starts");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("the program ends");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
        assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
    }
}

#[test]
fn a_model_is_drawn_tabulated_and_checked() {
    let folder = folder("brdf");
    let (svg, png, csv) = (path(&folder, "a.svg"), path(&folder, "a.png"), path(&folder, "a.csv"));
    for plot in [&svg, &png] {
        let model = "plastic:diffuse_reflectance=0.1 0.2 0.6";
        let output = packlight(&["brdf", model, "-o", plot, "--csv", &csv, "--spp", "1"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let drawn = fs::read_to_string(&svg).expect("it was written");
    assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>"), "{}", &drawn[..80]);
    assert_eq!(drawn.matches("<image ").count(), 2, "the lobe and the sphere");
    assert!(fs::read(&png).expect("it was written").starts_with(b"\x89PNG"));
    let table = fs::read_to_string(&csv).expect("it was written");
    for part in [
        "quantity,incident_degrees,outgoing_degrees,r,g,b\n",
        "\nslice,40,",
        "\nspike,80,",
        "\nreflected,89,,",
    ] {
        assert!(table.contains(part), "{part}");
    }
    let names: Vec<_> = fs::read_dir(&folder).expect("readable").collect();
    assert_eq!(names.len(), 3, "something was left behind");
}

#[test]
fn a_model_that_is_none_fails_its_check() {
    let good = packlight(&["brdf", "roughconductor:alpha=0.3,material=Au", "--check"]);
    assert_eq!(good.status.code(), Some(0), "{}", stdout(&good));
    for property in ["reciprocity", "albedo", "isotropy", "pdf = 1", "samples follow pdf"] {
        assert!(stdout(&good).contains(property), "{property} is not in\n{}", stdout(&good));
    }
    let toon = packlight(&["brdf", "toon", "--check"]);
    assert_eq!(toon.status.code(), Some(1));
    assert!(stdout(&toon).lines().any(|line| line.starts_with("  reciprocity         NO ")));
    assert!(stderr(&toon).contains("toon is not a reflection model"), "{}", stderr(&toon));
}

#[test]
fn what_brdf_does_not_understand_is_refused() {
    fails(&["brdf"], 2, "MODEL");
    fails(&["brdf", "diffuse"], 2, "nothing is asked for");
    fails(&["brdf", "diffuse", "-o", "a.exr"], 2, ".svg or .png");
    fails(&["brdf", "diffuse", "--check", "--light", "90"], 2, "less than 90");
    fails(&["brdf", "--scene", "a.xml", "--check"], 2, "--material");
    fails(&["brdf", "diffuse", "--scene", "a.xml", "--material", "b", "--check"], 2, "cannot be used with");
    fails(&["brdf", "sheet"], 2, "--output");
    fails(&["brdf", "difuse", "--check"], 1, "did you mean `diffuse`?");
    fails(&["brdf", "diffuse:reflectance=2", "--check"], 1, "MODEL:1:21");
    fails(&["brdf", "diffuse", "-o", "no/such/a.svg"], 1, "create it first");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/spheres.xml");
    fails(&["brdf", "--scene", scene, "--material", "mettal", "--check"], 1, "did you mean `metal`?");
}

/// A point light so strong that what is near it is too bright for a sum.
fn blinding(folder: &Path) -> String {
    let scene = path(folder, "blinding.xml");
    let text = "<scene version='3.0.0'><integrator type='direct'/>
        <sensor type='perspective'><film type='hdrfilm'><integer name='width' value='8'/>
        <integer name='height' value='8'/><rfilter type='box'/></film></sensor>
        <shape type='rectangle'><transform name='to_world'><rotate y='1' angle='180'/><translate z='5'/></transform></shape>
        <emitter type='point'><point name='position' x='0' y='0' z='4.99'/>
        <rgb name='intensity' value='3e26'/></emitter></scene>";
    fs::write(&scene, text).expect("a scene can be written");
    scene
}

#[test]
fn samples_that_are_not_finite_are_told_with_the_command_that_replays_them() {
    let folder = folder("blinding");
    let (scene, out) = (blinding(&folder), path(&folder, "out.exr"));
    let output = packlight(&["render", &scene, "-o", &out, "--spp", "4", "--seed", "3", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(json["invalid_samples"].as_u64() > Some(0), "{json}");
    let warning = stderr(&output);
    let command = warning.split_once("packlight ").expect("a command").1.trim();
    assert!(command.contains("--seed 3 --pixel"), "{warning}");
    for more in [&[][..], &["--backend", "scalar"]] {
        let words: Vec<&str> = command.split(' ').chain(more.iter().copied()).collect();
        let replayed = packlight(&words);
        assert_eq!(replayed.status.code(), Some(0), "{}", stderr(&replayed));
        let printed = stdout(&replayed);
        let greatest =
            printed.split_whitespace().filter_map(|word| word.parse::<f32>().ok()).fold(0.0, f32::max);
        assert!(greatest > packlight::film::GREATEST, "{printed}");
    }
}

#[test]
fn pixels_are_within_the_picture_and_samples_need_one() {
    let folder = folder("pixel");
    let scene = blinding(&folder);
    fails(&["render", &scene, "--pixel", "8,0"], 2, "8 x 8 pixels");
    fails(&["render", &scene, "--sample", "1"], 2, "--pixel");
    fails(&["render", &scene, "--pixel", "0,0", "--sample", "4294967295"], 2, "0..4294967295");
    fails(&["render", &scene, "--pixel", "1,1", "-o", "a.png"], 2, "cannot be used with");
}

#[test]
fn the_meter_reads_the_sky() {
    let folder = folder("meter");
    let scene = path(&folder, "sky.xml");
    let text = "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'/>
        <emitter type='constant'><rgb name='radiance' value='1, 2, 0'/></emitter></scene>";
    fs::write(&scene, text).expect("a scene can be written");
    let output = packlight(&["meter", &scene, "--at", "0,-1,0", "--normal", "-1,0,0", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let (red, error) = (json["irradiance_w_m2"][0].as_f64(), json["standard_error_w_m2"][0].as_f64());
    let (red, error) = (red.expect("a number"), error.expect("a number"));
    assert!((red - std::f64::consts::PI).abs() < 3.0 * error + 1e-5, "{red} ± {error}");
    assert_eq!(json["irradiance_w_m2"][2].as_f64(), Some(0.0));
    fails(&["meter", &scene, "--at", "0,0", "--normal", "1,0,0"], 2, "three numbers");
    fails(&["meter", &scene, "--at", "0,0,0", "--normal", "0,0,0"], 2, "a direction has a length");
}

#[test]
fn a_picture_is_reduced_to_nine_coefficients() {
    let folder = folder("harmonics");
    let out = path(&folder, "sky.json");
    let output = packlight(&["envmap", "scenes/textures/sky.hdr", "--sh", "-o", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("root mean square"), "{}", stdout(&output));
    let written = fs::read_to_string(&out).expect("the file is there");
    let kept = fs::read_to_string("scenes/textures/sky.json").expect("the repository has it");
    assert_eq!(written, kept, "scenes/textures/sky.json is not what sky.hdr gives");
    fails(&["envmap", "scenes/textures/sky.hdr", "-o", &out], 2, "--sh");
}

#[test]
fn shells_and_man_are_told_every_command() {
    let scripts = [
        ("bash", "complete -F _packlight"),
        ("zsh", "#compdef packlight"),
        ("fish", "complete -c packlight"),
    ];
    for (shell, how) in scripts {
        let output = packlight(&["completions", shell]);
        assert_eq!(output.status.code(), Some(0));
        assert!(stdout(&output).contains(how), "{how} for {shell}");
        for word in ["render", "merge", "compare", "shard"] {
            assert!(stdout(&output).contains(word), "{word} for {shell}");
        }
    }
    let folder = folder("man").join("not/there");
    let output = packlight(&["man", &folder.display().to_string()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let page = fs::read_to_string(folder.join("packlight-render.1")).expect("there is a page");
    assert!(page.contains(".TH") && page.contains("\\-\\-checkpoint"), "{page}");
    // A page for each command that help lists and each that a page refers to, and no others.
    let help = stdout(&packlight(&["--help"]));
    let listed =
        help.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("commands");
    let command = |line: &str| line.strip_prefix("  ")?.split_whitespace().next().map(String::from);
    let listed = listed.lines().filter(|line| !line.starts_with("   ")).filter_map(command);
    let mut expected: Vec<String> = listed.filter(|name| name != "help").collect();
    assert!(expected.len() > 10, "{help}");
    expected.extend(["brdf-sheet", "submit-slurm"].map(String::from));
    let mut pages: Vec<String> = expected.iter().map(|name| format!("packlight-{name}.1")).collect();
    pages.push("packlight.1".into());
    pages.sort();
    let entries = fs::read_dir(&folder).expect("readable");
    let mut written: Vec<String> =
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    written.sort();
    assert_eq!(written, pages);
    for page in &written {
        let text = fs::read_to_string(folder.join(page)).expect("readable").replace('\\', "");
        let names = text.split("packlight-").skip(1).filter_map(|rest| rest.split_once("(1)"));
        for (name, _) in names.filter(|(name, _)| name.chars().all(|c| c.is_ascii_alphabetic() || c == '-')) {
            assert!(expected.iter().any(|known| known == name), "{page} refers to {name}");
        }
        assert!(!text.contains("f32x8"), "{page} tells this machine's lanes");
    }
}
