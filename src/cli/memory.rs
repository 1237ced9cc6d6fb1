//! `--memory-limit`, and the most memory the process has had, as the system counts it.

use clap::Args;

use super::{failure::Failure, quantity};
use crate::{
    render::{Budget, Conditions},
    scene::SceneDescription,
};

/// The option, for every command that renders.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct MemoryOption {
    /// Refuse a scene that would take more memory, before its tree is built: 2GiB, 512MB or bytes; what the
    /// machine has, if not given
    #[arg(long, value_name = "SIZE", value_parser = size)]
    memory_limit: Option<u64>,
}

impl MemoryOption {
    /// What the scene will take, which is no more than the limit.
    ///
    /// # Errors
    /// If it is more: what takes most of it, and the way out.
    pub(super) fn check(
        self,
        description: &SceneDescription,
        conditions: &Conditions,
    ) -> Result<Expected, Failure> {
        let expected = Expected::new(description, conditions);
        let (limit, whose) = match self.memory_limit {
            Some(limit) => (limit, "of --memory-limit"),
            None => (machine().unwrap_or(u64::MAX), "of this machine (--memory-limit may say more)"),
        };
        match expected.peak() > limit {
            true => Err(Failure::Sentence(expected.refusal(limit, whose))),
            false => Ok(expected),
        }
    }
}

/// What a render is expected to take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    pub(super) budget: Budget,
    /// What loading has taken, which is known by now. 0 where the system does not say.
    loading: u64,
}

impl Expected {
    pub(super) fn new(description: &SceneDescription, conditions: &Conditions) -> Self {
        Self { budget: Budget::new(description, conditions), loading: peak().unwrap_or(0) }
    }

    /// The most that it will have taken at one time.
    pub(super) fn peak(&self) -> u64 {
        self.budget.peak().max(self.loading)
    }

    fn refusal(&self, limit: u64, whose: &str) -> String {
        let need = format!(
            "rendering takes about {}, more than the {} {whose}",
            quantity::memory(self.peak()),
            quantity::memory(limit)
        );
        if self.loading > self.budget.peak() {
            return format!(
                "{need}: loading the scene alone took that; raise the limit, or divide its files"
            );
        }
        let mut parts = self.budget.parts();
        parts.sort_by_key(|&(_, bytes)| std::cmp::Reverse(bytes));
        let out = match parts[0].0 {
            "film" => "render a smaller picture (--width), a crop, or fewer channels",
            "textures" => "use smaller pictures",
            "wavefront" => "use fewer --threads, or --integrator path, which asks one light at a time",
            "building the BVH" => "use --quality fast, which builds with less, or simpler meshes",
            "program" => "use fewer --threads",
            _ => "use simpler meshes, or instances of one that stands in many places",
        };
        format!("{need}; most of it: {}; raise the limit, or {out}", listed(&parts[..3]))
    }
}

/// Parts of a budget, for people: those that there are.
pub(super) fn listed(parts: &[(&str, u64)]) -> String {
    let part = |&(name, bytes): &(&str, u64)| format!("{name} {}", quantity::memory(bytes));
    parts.iter().filter(|(_, bytes)| *bytes > 0).map(part).collect::<Vec<_>>().join(", ")
}

/// For clap: `2GiB`, `512MB`, `1.5G`, `4096`. Units of 1024 end in `iB` or are one letter, of 1000 end in `B`.
fn size(argument: &str) -> Result<u64, String> {
    let digits = argument.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match argument[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "k" | "kib" => f64::from(1 << 10),
        "m" | "mib" => f64::from(1 << 20),
        "g" | "gib" => f64::from(1 << 30),
        "t" | "tib" => f64::from(1 << 30) * 1024.0,
        _ => f64::NAN,
    };
    let bytes = digits.trim().parse::<f64>().map_or(f64::NAN, |number| number * unit);
    match (1.0..1e18).contains(&bytes) {
        true => Ok(bytes as u64),
        false => Err("expected an amount of memory, as in 2GiB, 512MB or 4096 (bytes)".into()),
    }
}

/// The memory that there is, in bytes, with what may be swapped out; `None` where the system does not say.
fn machine() -> Option<u64> {
    let told = std::fs::read_to_string("/proc/meminfo").ok()?;
    kibibytes(&told, "MemTotal:")?.checked_add(kibibytes(&told, "SwapTotal:")?)
}

/// The most that the process has had, in bytes; `None` where the system does not say.
pub(super) fn peak() -> Option<u64> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The line of that name in a file of `/proc`, in bytes.
fn kibibytes(told: &str, name: &str) -> Option<u64> {
    let value = told.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bvh::Quality,
        compile::Needs,
        scene::{Aov, AovChannel, Film},
    };

    #[test]
    fn amounts_are_read_in_their_own_unit() {
        for (text, bytes) in [
            ("4096", 4096),
            ("512MB", 512_000_000),
            ("512mb", 512_000_000),
            ("2GiB", 2 << 30),
            ("1.5G", 3 << 29),
            ("64k", 65_536),
            ("1TiB", 1 << 40),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "GiB", "0", "-1G", "2 furlongs", "nan", "inf", "1e300", "1e300T"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_refusal_names_what_is_largest_and_the_way_out() {
        let scene = Needs { meshes: 1 << 20, tree: 2 << 20, building: 700 << 20, ..Needs::default() };
        let budget = Budget { scene, film: 5 << 20, ..Budget::default() };
        let expected = Expected { budget, loading: 1000 };
        let told = expected.refusal(64 << 20, "of somebody");
        for part in ["703.0 MiB", "64.0 MiB", "building the BVH 700.0 MiB, film 5.0 MiB", "--quality fast"] {
            assert!(told.contains(part), "{part} is not in {told}");
        }
        let told = Expected { loading: 1 << 40, ..expected }.refusal(64 << 20, "of somebody");
        assert!(told.contains("loading the scene alone"), "{told}");
    }

    #[test]
    fn a_limit_is_the_most_that_is_allowed() {
        let conditions = Conditions { quality: Quality::Medium, threads: 1, keeps_sums: false };
        let description = SceneDescription::default();
        let needed = Expected::new(&description, &conditions).peak();
        let check = |limit| MemoryOption { memory_limit: limit }.check(&description, &conditions).is_ok();
        assert!(check(None) && check(Some(2 * needed)) && !check(Some(needed / 2)));
    }

    #[test]
    fn the_line_is_found_and_read() {
        let high_water = |told| kibibytes(told, "VmHWM:");
        assert_eq!(high_water("VmPeak:\t  99 kB\nVmHWM:\t   1234 kB\n"), Some(1234 * 1024));
        assert_eq!(high_water("VmHWM: lots\n"), None);
        assert_eq!(high_water(""), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_has_used_some_of_what_there_is() {
        let (peak, there) = (peak().expect("known"), machine().expect("known"));
        assert!(100_000 < peak && peak < there, "{peak} of {there}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_machine_is_a_limit_that_somebody_may_lift() {
        let conditions = Conditions { quality: Quality::Medium, threads: 1, keeps_sums: false };
        let mut description = SceneDescription::default();
        // 512 million pixels and a thousand layers of three channels: more than any machine has.
        description.sensor.film = Film::new(1 << 15, 1 << 14);
        description.aovs = vec![AovChannel { name: "n".into(), kind: Aov::ShNormal }; 1000];
        let check = |memory_limit| MemoryOption { memory_limit }.check(&description, &conditions);
        let Err(Failure::Sentence(told)) = check(None) else { panic!("no machine has so much") };
        assert!(told.contains("of this machine (--memory-limit may say more)"), "{told}");
        assert!(check(Some(1 << 59)).is_ok());
    }
}
