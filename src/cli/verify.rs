//! `packlight verify SCENE`: do all ways of tracing it agree, and does nothing leak?

mod against;
mod exhibit;
mod findings;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    MACHINE, console, failure::Failure, quality::QualityOption, ray_file, source::Source,
    threads::ThreadsOption,
};
use crate::{
    compile::{Scene, compile_owned},
    geometry::Ray32,
    load::Loaded,
    render::Query,
    verify::{
        Class, Exhibit, Expected, classes,
        cracks::{Seams, cracks},
        departures::departures,
        ways::{answers, compare, found},
    },
};
use against::{Other, against_embree};
use findings::{ClassRow, Findings, LeakRow, SelfHitRow};

/// Tests of a ray against a primitive that brute force may take for a class of rays.
const BRUTE_TESTS: u64 = 1 << 28;

const EXAMPLES: &str = "\
Examples:
  packlight verify scenes/cornell.xml
  packlight verify bunny.obj --most 10000 --into faults
  packlight verify bunny.obj --against embree
  packlight verify bunny.obj --rays faults/primary.rays \\
      --expect hit";

/// Arguments of `verify`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Only the rays of this file, as `bench --save-rays` or a failed `verify` wrote it
    #[arg(long, value_name = "FILE")]
    rays: Option<PathBuf>,

    /// What each of those rays should find
    #[arg(long, value_name = "WHAT", requires = "rays")]
    expect: Option<ExpectedName>,

    /// About how many rays of each class are traced
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    most: u32,

    /// Folder for what shows a fault, if there is one
    #[arg(long, value_name = "DIR", default_value = ".")]
    into: PathBuf,

    /// Compare nearest hits with those of another program too
    #[arg(long, value_name = "WHOSE")]
    against: Option<Other>,

    #[command(flatten, next_help_heading = MACHINE)]
    threads: ThreadsOption,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ExpectedName {
    Hit,
    Miss,
}

impl From<ExpectedName> for Expected {
    fn from(name: ExpectedName) -> Self {
        match name {
            ExpectedName::Hit => Self::Hit,
            ExpectedName::Miss => Self::Miss,
        }
    }
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = arguments.rays.as_deref().map(ray_file::read).transpose()?;
    let findings = arguments.threads.pool()?.install(|| {
        let (Loaded { description, .. }, _) = arguments.source.load()?;
        let scene = compile_owned(description, arguments.quality.quality())?;
        let classes = match &file {
            Some(file) => vec![Class { name: "file", query: Query::Closest, rays: file.rays.clone() }],
            None => classes(&scene, arguments.most as usize),
        };
        // Before the others take their time: it may not be there.
        let against = arguments
            .against
            .map(|Other::Embree| against_embree(&scene, classes.iter().map(|class| class.rays.as_slice())));
        let (against, differs) = against.transpose()?.unzip();
        let (mut findings, exhibit) = match &file {
            Some(file) => arguments.of_file(&scene, &file.rays),
            None => arguments.of_scene(&scene, &classes),
        };
        findings.against = against;
        let origin = || (arguments.source.path.as_path(), arguments.source.options());
        if let Some(exhibit) = exhibit.filter(|_| file.is_none()) {
            findings.failure = Some(exhibit::write(&exhibit, &arguments.into, origin())?);
        } else if let Some(exhibit) = differs.flatten().filter(|_| file.is_none()) {
            let mut written = exhibit::write(&exhibit, &arguments.into, origin())?;
            written.command += " --against embree";
            findings.failure = Some(written);
        }
        Ok::<_, Failure>(findings)
    })?;
    if arguments.json {
        console::print_json(&findings)?;
    } else {
        console::print(&findings.to_string())?;
    }
    findings.verdict()
}

impl Arguments {
    fn of_scene(&self, scene: &Scene, classes: &[Class]) -> (Findings, Option<Exhibit>) {
        let mut findings = Findings::new(self.source.path.display().to_string(), scene.summary());
        let (mut exhibit, mut self_hits) = (None, SelfHitRow::default());
        for class in classes {
            let compared = compare(scene, &class.rays, BRUTE_TESTS, &answers);
            findings.classes.push(ClassRow::new(class.name, &compared));
            exhibit = exhibit.or(compared.exhibit);
            if class.query == Query::Closest {
                let left = departures(scene, &class.rays);
                self_hits.add(&left);
                exhibit = exhibit.or(left.exhibit);
            }
        }
        let leaks = cracks(scene, &Seams::of(scene), u64::from(self.most));
        findings.leaks = Some(LeakRow::from(&leaks));
        findings.self_hits = Some(self_hits);
        (findings, exhibit.or(leaks.exhibit))
    }

    fn of_file(&self, scene: &Scene, rays: &[Ray32]) -> (Findings, Option<Exhibit>) {
        let mut findings = Findings::new(self.source.path.display().to_string(), scene.summary());
        let compared = compare(scene, rays, BRUTE_TESTS, &answers);
        findings.classes.push(ClassRow::new("file", &compared));
        findings.unexpected = self.expect.map(|expected| found(scene, rays, expected.into()));
        (findings, compared.exhibit)
    }
}
