//! Whatever a file holds, it becomes a scene or a clear refusal: no panic, no hang, no memory for what is only
//! announced.

#![allow(missing_docs)]

mod program;

use std::{
    fs,
    panic::catch_unwind,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use packlight::compile::compile;
use packlight::geometry::ray_file::RayFile;
use packlight::load::{LoadOptions, load};
use packlight::picture::{Encoding, decode};
use packlight::render::{Settings, render};
use packlight::scene::{Film, Integrator, MerlTable};
use packlight::verify::aim::Random;
use program::folder;

/// Longest that a file of these sizes may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// `PACKLIGHT_DAMAGES` for a run of a bench's size: 10000.
fn damages() -> usize {
    std::env::var("PACKLIGHT_DAMAGES").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Reads a file as what its name says. `Ok` is whether it could be used.
fn read(path: &Path) -> Result<bool, String> {
    let name = path.file_name().expect("a name").to_string_lossy().into_owned();
    let once = || {
        let began = Instant::now();
        let outcome = catch_unwind(|| use_file(path, &name));
        (outcome, began.elapsed())
    };
    let (mut outcome, mut time) = once();
    if time > PATIENCE {
        // Perhaps the machine was busy.
        (outcome, time) = once();
    }
    if time > PATIENCE {
        return Err(format!("{}: took {time:?}", path.display()));
    }
    match outcome.map_err(|_| format!("{}: a panic", path.display()))? {
        Ok(()) => Ok(true),
        // A file that a scene names is told by its own name.
        Err(words) if words.contains(": ") && words.len() > 10 => Ok(false),
        Err(words) => Err(format!("{}: refused with `{words}`", path.display())),
    }
}

/// Pictures, rays and tables are decoded, all others shown.
fn use_file(path: &Path, name: &str) -> Result<(), String> {
    let bytes = || fs::read(path).expect("readable");
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "png" | "jpg" | "hdr" | "exr" | "bmp" | "tga" | "webp" => {
            decode(path, Encoding::Srgb).map(drop).map_err(|error| error.to_string())
        }
        "rays" => RayFile::decode(&bytes()).map(drop).map_err(|error| format!("{name}: {error}")),
        "binary" => MerlTable::decode(&bytes()).map(drop).map_err(|error| format!("{name}: {error}")),
        "spd" => show(&carrier(path, "xml", |name| {
            format!(
                "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"sphere\"><bsdf type=\"conductor\">\
                 <spectrum name=\"eta\" filename=\"{name}\"/><spectrum name=\"k\" value=\"1\"/></bsdf></shape></scene>"
            )
        })),
        "serialized" => show(&carrier(path, "xml", |name| {
            format!(
                "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"serialized\">\
                 <string name=\"filename\" value=\"{name}\"/></shape></scene>"
            )
        })),
        "mtl" => show(&carrier(path, "obj", |name| {
            format!("mtllib {name}\nusemtl MyMaterial\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        })),
        _ => show(path),
    }
}

/// A file beside another one that names it.
fn carrier(path: &Path, extension: &str, text: impl Fn(&str) -> String) -> PathBuf {
    let carrier = path.with_extension(extension);
    fs::write(&carrier, text(&path.file_name().expect("a name").to_string_lossy())).expect("writable");
    carrier
}

/// Loads, compiles, and renders four pixels by four.
fn show(path: &Path) -> Result<(), String> {
    let mut description = load(path, &LoadOptions::default()).map_err(|error| error.to_string())?.description;
    description.sensor.film = Film { filter: description.sensor.film.filter, ..Film::new(4, 4) };
    description.sensor.sampler.sample_count = 1;
    // As deep as a file may ask for, nobody waits.
    if let Integrator::Path { max_depth, .. } = &mut description.integrator {
        *max_depth = Some(max_depth.unwrap_or(8).min(8));
    }
    let name = path.file_name().expect("a name").to_string_lossy();
    let scene = compile(&description).map_err(|error| format!("{name}: {error}"))?;
    let picture = render(&scene, &Settings::default(), &|_| {}).picture;
    let samples = picture.channels.iter().flat_map(|channel| &channel.samples);
    assert!(samples.copied().all(f32::is_finite), "a film holds what is not finite");
    Ok(())
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> =
        entries.flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect();
    files.sort();
    files
}

#[test]
fn files_that_others_found_hard() {
    let scenes = root().join("../shared/scenes");
    let files: Vec<PathBuf> =
        ["malformed", "awkward"].iter().flat_map(|name| files_below(&scenes.join(name))).collect();
    if files.is_empty() {
        println!("skipped: {} is not there", scenes.display());
        return;
    }
    let outcomes: Vec<Result<bool, String>> = files.iter().map(|path| read(path)).collect();
    let used = outcomes.iter().filter(|outcome| **outcome == Ok(true)).count();
    let faults: Vec<&String> = outcomes.iter().filter_map(|outcome| outcome.as_ref().err()).collect();
    println!("{} files, {used} of them used", files.len());
    assert!(faults.is_empty(), "{faults:#?}");
}

/// A part is cut off, bytes are changed, or a part takes the place of another.
fn damaged(good: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = good.to_vec();
    // Headers are short, and hold what matters.
    let reach = [64, 512, bytes.len()][random.below(3)].min(bytes.len());
    match random.below(4) {
        0 => bytes.truncate(random.below(good.len())),
        1 => bytes[random.below(reach)] ^= 1 << random.below(8),
        2 => {
            for _ in 0..1 + random.below(5) {
                bytes[random.below(reach)] = random.below(256) as u8;
            }
        }
        _ => {
            let (from, to) = (random.below(good.len()), random.below(reach));
            let part = good[from..(from + random.below(40)).min(good.len())].to_vec();
            bytes.splice(to..(to + random.below(10)).min(good.len()), part);
        }
    }
    bytes
}

/// Damages files in many ways, where the files that they name are.
fn damage(name: &str, goods: &[PathBuf]) {
    let folder = folder(&format!("any_file/{name}"));
    for beside in ["meshes", "textures"] {
        fs::create_dir_all(folder.join(beside)).expect("writable");
        for path in files_below(&root().join("scenes").join(beside)) {
            fs::copy(&path, folder.join(beside).join(path.file_name().expect("a name"))).expect("writable");
        }
    }
    for good in goods.iter().filter(|path| !path.exists()) {
        println!("skipped: {} is not there", good.display());
    }
    let goods: Vec<(&PathBuf, Vec<u8>)> = goods
        .iter()
        .filter(|path| path.exists())
        .map(|path| (path, fs::read(path).expect("readable")))
        .collect();
    // Some take a tenth of a second, for the tables of their materials. Not on the pool that compiles and renders them:
    // a thread of it that waits would begin the next file in the middle of one.
    let damage_one = |thread: usize, i: usize| {
        let (good, bytes) = &goods[i % goods.len()];
        let extension = good.extension().unwrap_or_default();
        let path = folder.join(format!("damaged-{thread}")).with_extension(extension);
        let bytes = damaged(bytes, &mut Random::new(i as u64));
        fs::write(&path, &bytes).expect("writable");
        read(&path).map_err(|fault| {
            let kept = folder.join(format!("fault-{i}")).with_extension(extension);
            fs::write(&kept, &bytes).expect("writable");
            format!("{}: {fault}", kept.display())
        })
    };
    let count = if goods.is_empty() { 0 } else { damages() };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let (damage_one, mut outcomes) = (&damage_one, Vec::new());
    thread::scope(|scope| {
        let work = |thread| move || (thread..count).step_by(threads).map(|i| damage_one(thread, i)).collect();
        let started: Vec<_> = (0..threads).map(|thread| scope.spawn(work(thread))).collect();
        for thread in started {
            let found: Vec<Result<bool, String>> = thread.join().expect("a thread that ends");
            outcomes.extend(found);
        }
    });
    let used = outcomes.iter().filter(|outcome| **outcome == Ok(true)).count();
    let faults: Vec<&String> = outcomes.iter().filter_map(|outcome| outcome.as_ref().err()).collect();
    println!("{name}: {used} of {count} damaged files were used");
    assert!(faults.is_empty(), "{faults:#?}");
}

fn of_scenes(names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| root().join("scenes").join(name)).collect()
}

fn of_others(names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| root().join("../shared/scenes").join(name)).collect()
}

#[test]
fn damaged_scenes() {
    damage("xml", &of_scenes(&["cornell.xml", "materials.xml", "instances.xml", "sky.xml", "spheres.xml"]));
}

#[test]
fn damaged_obj() {
    let mut goods = of_scenes(&["meshes/gem.obj"]);
    goods.extend(of_others(&["malformed/regr_3429812.obj", "malformed/number_formats.obj"]));
    damage("obj", &goods);
}

#[test]
fn damaged_ply() {
    let mut goods = of_others(&["malformed/cube_binary.ply", "awkward/degtri_sliding.ply"]);
    let ascii = folder("any_file/seed").join("ascii.ply");
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    fs::write(&ascii, format!("{header}0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n")).expect("writable");
    goods.push(ascii);
    damage("ply", &goods);
}

#[test]
fn damaged_serialized() {
    use std::io::Write;
    let path = folder("any_file/serialized_seed").join("a.serialized");
    // Version 4, one shape: single precision, a name, three vertices, one triangle.
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let floats = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0f32].map(f32::to_bits);
    let counts = [3u64, 1].map(u64::to_le_bytes).concat();
    let body = [words(&[0x1000]), b"a\0".to_vec(), counts, words(&floats), words(&[0, 1, 2])].concat();
    zlib.write_all(&body).expect("memory");
    let header = [0x041c_u16, 4].map(u16::to_le_bytes).concat();
    let table = [0u64.to_le_bytes().to_vec(), 1u32.to_le_bytes().to_vec()].concat();
    fs::write(&path, [header, zlib.finish().expect("memory"), table].concat()).expect("writable");
    assert_eq!(read(&path), Ok(true));
    damage("serialized", &[path]);
}

#[test]
fn damaged_spectra_and_libraries() {
    damage("spd", &of_others(&["brdf/ior/Ag.eta.spd", "brdf/ior/Cu.k.spd"]));
    damage("mtl", &of_others(&["malformed/cube_mtllib_after_g.mtl", "malformed/empty_mat.mtl"]));
}

#[test]
fn damaged_pictures() {
    let mut goods = of_scenes(&["textures/sky.hdr", "textures/tiles.png", "textures/bosses.png"]);
    goods.extend(of_others(&[
        "mitsuba/reference/tests/scenes/floating_sphere/refs/test_directional_ref_rgb.exr",
        "malformed/gltf-validator/image/cyan.jpg",
    ]));
    damage("pictures", &goods);
}

#[test]
fn damaged_rays_and_tables() {
    let folder = folder("any_file/rays_seed");
    let (rays, table) = (folder.join("a.rays"), folder.join("a.binary"));
    let ray = packlight::geometry::Ray32::new(glam::Vec3::ONE, glam::Vec3::Z, 0.0, 9.0);
    fs::write(&rays, packlight::geometry::ray_file::encode(&[ray; 20])).expect("writable");
    // A MERL file is 35 MB; its header is what a decoder believes.
    let header: Vec<u8> = [90i32, 90, 180].iter().flat_map(|n| n.to_le_bytes()).collect();
    fs::write(&table, [header, vec![0; 500]].concat()).expect("writable");
    damage("rays", &[rays, table]);
}

/// Small files that stand for large ones: with little memory at hand, they are refused all the same.
#[cfg(target_os = "linux")]
#[test]
fn what_is_only_announced_takes_no_memory() {
    use std::process::Command;
    let folder = folder("any_file/announced");
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("writable");
    let ply = |format: &str, vertices: &str, list: &str, rest: &[u8]| {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list {list} int vertex_indices\nend_header\n"
        );
        [header.as_bytes(), rest].concat()
    };
    let endless = [[0u8; 36].as_slice(), &u32::MAX.to_le_bytes()].concat();
    write("vertices.ply", &ply("binary_little_endian", "4000000000", "uchar", &[0; 36]));
    write("corners.ply", &ply("binary_little_endian", "3", "uint", &endless));
    write("words.ply", &ply("ascii", "3", "uint", b"0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"));
    let scene = |inside: &str| {
        format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{inside}</scene>").into_bytes()
    };
    write("entities.xml", b"<!DOCTYPE a [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;\">]><scene>&b;</scene>");
    write("deep.xml", "<bsdf type=\"mask\">".repeat(100_000).as_bytes());
    write("closed.xml", &scene(&["<a>".repeat(50_000), "</a>".repeat(50_000)].concat()));
    write("loop.xml", &scene("<include filename=\"loop.xml\"/>"));
    write("twice.xml", &scene("<include filename=\"twin.xml\"/><include filename=\"twin.xml\"/>"));
    write("twin.xml", &scene("<include filename=\"twice.xml\"/>"));
    write("circle.xml", &scene("<bsdf type=\"mask\" id=\"a\"><ref id=\"a\"/></bsdf>"));
    let blends: String = (1..40)
        .map(|i| {
            format!(
                "<bsdf type=\"blendbsdf\" id=\"b{i}\"><float name=\"weight\" value=\".5\"/><ref id=\"b{0}\"/><ref id=\"b{0}\"/></bsdf>",
                i - 1
            )
        })
        .collect();
    write("blends.xml", &scene(&format!("<bsdf type=\"diffuse\" id=\"b0\"/>{blends}")));
    let film = "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"2000000000\"/></film></sensor>";
    write("film.xml", format!("<scene version=\"3.0.0\">{film}</scene>").as_bytes());
    let masks = ["<bsdf type=\"mask\">".repeat(100_000), "</bsdf>".repeat(100_000)].concat();
    write("nested.xml", &scene(&masks));
    let doubled: String =
        (1..40).map(|i| format!("<default name=\"d{i}\" value=\"$d{0}$d{0}\"/>", i - 1)).collect();
    write("doubled.xml", &scene(&format!("<default name=\"d0\" value=\"a bomb\"/>{doubled}")));
    let defaults: String = (0..200_000).map(|i| format!("<default name=\"d{i}\" value=\"\"/>")).collect();
    write("defaults.xml", &scene(&defaults));
    let attributes: String = (0..200_000).map(|i| format!(" a{i}=\"\"")).collect();
    write("attributes.xml", &scene(&format!("<bsdf{attributes}/>")));
    let spaces: String = (0..5000).map(|i| format!("<a xmlns:a{i}=\"{i}\">")).collect();
    write("spaces.xml", &scene(&[spaces, "</a>".repeat(5000)].concat()));
    let properties: String = (0..100_000).map(|i| format!("<float name=\"p{i}\" value=\"1\"/>")).collect();
    write("properties.xml", &scene(&format!("<bsdf type=\"diffuse\">{properties}</bsdf>")));
    write("name.xml", &scene(&format!("<bsdf type=\"{}\"/>", "diffuse".repeat(1_000_000))));
    let endless = "<integrator type=\"path\"><integer name=\"rr_depth\" value=\"2000000000\"/></integrator>";
    write("endless.xml", &scene(endless));
    let texture = "<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" \
                   value=\"rows.hdr\"/></texture></bsdf>";
    write("rows.xml", &scene(&format!("<shape type=\"sphere\">{texture}</shape>")));
    write("rows.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 32768\n");
    for path in files_below(&folder).into_iter().filter(|path| !path.ends_with("rows.hdr")) {
        // Address space, in KiB: what threads and allocators reserve is most of it.
        let limited = format!("ulimit -v 1500000; exec \"$0\" info \"{}\"", path.display());
        let inspect = || {
            let began = Instant::now();
            let mut shell = Command::new("sh");
            let output = shell.args(["-c", &limited, env!("CARGO_BIN_EXE_packlight")]).output();
            (output.expect("a shell"), began.elapsed())
        };
        let (mut output, mut time) = inspect();
        if time > PATIENCE {
            // Perhaps the machine was busy.
            (output, time) = inspect();
        }
        assert!(time <= PATIENCE, "{}: took {time:?}", path.display());
        let words = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{}: {words}", path.display());
        assert!(
            words.contains(&*path.file_name().expect("a name").to_string_lossy()) || words.contains("twi"),
            "{words}"
        );
        assert!(words.len() < 20_000, "{}: {} bytes of words", path.display(), words.len());
    }
}

/// Where a warning stands is found by counting lines; of fifty thousand warnings, twenty are shown.
#[test]
fn many_warnings_take_no_time() {
    let path = folder("any_file/warnings").join("idle.xml");
    let idle = "<bsdf type=\"diffuse\" id=\"a\"/>";
    let all: String = (0..50_000).map(|i| idle.replace("\"a\"", &format!("\"a{i}\"\n"))).collect();
    let sensor = "<sensor type=\"perspective\"/><shape type=\"sphere\"/>";
    fs::write(&path, format!("<scene version=\"3.0.0\">{sensor}{all}</scene>")).expect("writable");
    let options = LoadOptions::default();
    let least = (0..3).map(|_| {
        let began = Instant::now();
        let loaded = load(&path, &options).expect("legal");
        assert!(loaded.warnings.len() > 50_000);
        let last = loaded.warnings.iter().rfind(|warning| warning.message().contains("a49999"));
        assert!(last.expect("it is told").place().contains("idle.xml:5000"));
        began.elapsed()
    });
    let least = least.min().expect("three times");
    assert!(least < PATIENCE / 5, "took {least:?}");
}
