//! Beside Embree, on the same rays and in the same run, by a program that measures both.
//!
//! The environment says where things are that do not belong to this repository: `PEERS` names the program,
//! `PEERS_MESHES` the folder of meshes, `PEERS_RAYS` a folder of rays that are there already.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    compared::Compared,
    row::{BUILD, Table, rounded},
    run::Run,
};

/// Meshes, and whether the camera stands inside.
pub(crate) const SCENES: [(&str, bool); 8] = [
    ("gen:soup:100k", false),
    ("gen:terrain:1M", false),
    ("gen:spheres:1M", false),
    ("gen:hair:200k", false),
    ("stanford-bunny.obj", false),
    ("dragon_res2.ply", false),
    ("sponza.ply", true),
    ("kitchen.ply", true),
];

/// Embree's build that ours is compared with.
const BESIDE: &str = "embree/medium";
/// The harness's exit code where results differ.
const DISAGREES: i32 = 2;

/// The harness and its folders.
struct Harness {
    program: PathBuf,
    meshes: PathBuf,
    rays: PathBuf,
}

impl Harness {
    fn from_environment() -> Option<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = |name: &str, default: PathBuf| env::var_os(name).map_or(default, PathBuf::from);
        Some(Self {
            program: env::var_os("PEERS").filter(|program| !program.is_empty())?.into(),
            meshes: folder("PEERS_MESHES", root.join("../shared/scenes/meshes")),
            rays: folder("PEERS_RAYS", Path::new(env!("CARGO_TARGET_TMPDIR")).join("rays")),
        })
    }

    /// What it prints, and whether all results agree.
    fn run(&self, arguments: &[&str]) -> Result<String, String> {
        let told = |message: &str| format!("{} {}: {message}", self.program.display(), arguments.join(" "));
        let command = Command::new(&self.program).args(arguments).stdin(Stdio::null()).output();
        let output = command.map_err(|error| told(&error.to_string()))?;
        if !output.status.success() && output.status.code() != Some(DISAGREES) {
            return Err(told(String::from_utf8_lossy(&output.stderr).trim()));
        }
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// The folder of a mesh's rays, made if it is not there.
    fn rays(&self, mesh: &str, name: &str, inside: bool) -> Result<PathBuf, String> {
        let folder = self.rays.join(name.replace(':', "-"));
        if !folder.exists() {
            // Under another name until it is whole.
            let unfinished = folder.with_extension("unfinished");
            let told = |error: std::io::Error| format!("{}: {error}", unfinished.display());
            fs::create_dir_all(&unfinished).map_err(told)?;
            let out = unfinished.display().to_string();
            let mut arguments = vec!["rays", "--mesh", mesh, "--out", &out];
            arguments.extend(inside.then_some("--inside"));
            self.run(&arguments)?;
            fs::rename(&unfinished, &folder).map_err(told)?;
        }
        Ok(folder)
    }
}

/// Measures every mesh that is wanted, or says why not.
pub(crate) fn measure(run: &mut Run) -> Result<(), String> {
    let wanted = SCENES.into_iter().filter(|(name, _)| run.options.wants(Table::Peers, name));
    let wanted: Vec<_> = wanted.collect();
    if wanted.is_empty() {
        return Ok(());
    }
    let Some(harness) = Harness::from_environment() else {
        println!("peers   skipped: PEERS does not name the program that measures Embree");
        return Ok(());
    };
    for (name, inside) in wanted {
        let file = harness.meshes.join(name);
        let mesh = if name.starts_with("gen:") { name.to_owned() } else { file.display().to_string() };
        if !name.starts_with("gen:") && !file.exists() {
            println!("peers   skipped: {mesh} is not there; PEERS_MESHES names its folder");
            continue;
        }
        let rays = harness.rays(&mesh, name, inside)?;
        for threads in run.options.threads.clone() {
            println!("peers   {name}, {threads} thread{}", if threads == 1 { "" } else { "s" });
            compare(run, &harness, (name, &mesh), &rays, threads)?;
        }
    }
    Ok(())
}

fn compare(
    run: &mut Run,
    harness: &Harness,
    (name, mesh): (&str, &str),
    rays: &Path,
    threads: usize,
) -> Result<(), String> {
    let ours = format!("{} bench {}", env!("CARGO_BIN_EXE_packlight"), run.options.ours);
    let (rays, count, repeat) =
        (rays.display().to_string(), threads.to_string(), run.extent.repeat().to_string());
    let classes = run.options.class.join(",");
    let mut arguments = vec!["compare", "--ours", ours.trim(), "--mesh", mesh, "--rays", &rays];
    arguments.extend(["--threads", &count, "--repeat", &repeat]);
    if !classes.is_empty() {
        arguments.extend(["--classes", &classes]);
    }
    let compared = Compared::read(&harness.run(&arguments)?)?;
    for class in &compared.classes {
        let mut row = run.row(threads, Table::Peers, name, &class.name);
        row.options.clone_from(&run.options.ours);
        row.primitives = Some(compared.triangles);
        row.mega_per_s = rounded(class.ours);
        row.beside = format!("embree {}", class.mode);
        row.beside_mega_per_s = rounded(class.theirs);
        row.ratio = rounded(class.ours / class.theirs);
        row.agrees = Some(class.agrees);
        run.book.take(row)?;
    }
    if let (Some(ours), Some(theirs)) = (compared.build("ours"), compared.build(BESIDE)) {
        let mega_per_s = |seconds: f64| rounded(compared.triangles as f64 / seconds / 1e6);
        let mut row = run.row(threads, Table::Peers, name, BUILD);
        row.options.clone_from(&run.options.ours);
        row.primitives = Some(compared.triangles);
        row.mega_per_s = mega_per_s(ours.seconds);
        row.beside = BESIDE.replace('/', " ");
        row.beside_mega_per_s = mega_per_s(theirs.seconds);
        row.ratio = rounded(theirs.seconds / ours.seconds);
        row.bytes_per_primitive = rounded(ours.bytes_per_triangle);
        row.beside_bytes_per_primitive = rounded(theirs.bytes_per_triangle);
        run.book.take(row)?;
    }
    Ok(())
}
