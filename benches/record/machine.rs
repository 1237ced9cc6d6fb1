//! What was measured on, and with what: the processor, the lanes, the commit.

use std::{fs, process::Command};

/// A processor and a build.
#[derive(Clone, Debug, Default)]
pub(crate) struct Machine {
    /// Name of the processor.
    pub(crate) cpu: String,
    /// Lanes that were compiled: `avx512`, `avx2`, `sse2`, `neon`.
    pub(crate) lanes: &'static str,
    /// Short hash, with `+` if the working copy differs from it; empty if git does not say.
    pub(crate) commit: String,
}

impl Machine {
    /// This one. `cpu` is for processors that do not say who they are, as many do in virtual machines.
    pub(crate) fn of_this_run(cpu: Option<&str>) -> Self {
        let told = || fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| name(&text));
        let cpu = cpu.map(str::to_owned).or_else(told).unwrap_or_else(|| std::env::consts::ARCH.to_owned());
        Self { cpu: cpu.replace(',', " "), lanes: lanes(), commit: commit().unwrap_or_default() }
    }

    /// The name as part of a file's: `amd-epyc-9654`.
    pub(crate) fn slug(&self) -> String {
        slug(&self.cpu)
    }
}

fn lanes() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "avx512"
    } else if cfg!(target_feature = "avx2") {
        "avx2"
    } else if cfg!(target_feature = "sse2") {
        "sse2"
    } else if cfg!(target_feature = "neon") {
        "neon"
    } else {
        "none"
    }
}

fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output =
            Command::new("git").args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let head = git(&["rev-parse", "--short=8", "HEAD"])?;
    // The record itself is written while it is made.
    let changed = git(&[
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        ".",
        ":!benches/record/*.csv",
        ":!benches/record/*.svg",
    ])?;
    Some(if changed.is_empty() { head } else { format!("{head}+") })
}

/// The processor's name without what all of them say; with family and model where it has no number.
pub(crate) fn name(cpuinfo: &str) -> Option<String> {
    let value = |key: &str| {
        let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        lines.find(|(name, _)| name.trim() == key).map(|(_, value)| value.trim())
    };
    let plain = value("model name")?.replace("(R)", "").replace("(TM)", "").replace("(tm)", "");
    let words = plain.split('@').next()?.split_whitespace();
    let words = words.filter(|word| !["CPU", "Processor"].contains(word) && !word.ends_with("-Core"));
    let mut name = words.collect::<Vec<_>>().join(" ");
    if !name.contains(|c: char| c.is_ascii_digit())
        && let (Some(family), Some(model)) = (value("cpu family"), value("model"))
    {
        name += &format!(" family {family} model {model}");
    }
    (!name.is_empty()).then_some(name)
}

/// In lower case, with hyphens.
pub(crate) fn slug(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let parts = lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-")
}
