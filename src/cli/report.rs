//! What a render took, told to people or as JSON.

use std::{fmt, time::Duration};

use serde::Serialize;

use super::{
    overrides::IntegratorName,
    quantity::{counted, grouped, mega, mega_per_second, memory, time},
    render::{denoised::Denoised, lesson::Lesson},
};
use crate::{
    compile::{Scene, Summary},
    render::{Backend, Coverage, Settings, Statistics},
    simd::cpu,
};

/// A finished render. Field names are the keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Report {
    scene: String,
    output: String,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    /// The fewest and the most that a pixel has: other numbers where the render was stopped.
    samples_least: u32,
    samples_most: u32,
    /// Whether it has all that was asked for.
    complete: bool,
    #[serde(skip)]
    continued_by: Option<String>,
    integrator: String,
    backend: &'static str,
    sorted: bool,
    lanes: String,
    threads: usize,
    triangles: u64,
    quadrics: u64,
    materials: u32,
    lights: u32,
    load_seconds: f64,
    bvh_seconds: f64,
    render_seconds: f64,
    rays: Rays,
    mrays_per_second: f64,
    msamples_per_second: f64,
    profile: Profile,
    lane_use: LaneUse,
    invalid_samples: u64,
    first_invalid: Option<Sample>,
    #[serde(skip_serializing_if = "Option::is_none")]
    denoised: Option<Denoised>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<Lesson>,
    #[serde(skip)]
    options: String,
    /// What was expected before the tree was built.
    memory_budget_bytes: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_memory_bytes: Option<u64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Rays {
    camera: u64,
    bounce: u64,
    shadow: u64,
}

/// Shares of the threads' time in [0, 1], 0 where one ray goes at a time.
#[derive(Clone, Copy, Debug, Serialize)]
struct Profile {
    trace: f64,
    sort: f64,
    shade: f64,
    add: f64,
}

/// In [0, 1].
#[derive(Clone, Copy, Debug, Serialize)]
struct LaneUse {
    trace: f64,
    shade: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Sample {
    x: u32,
    y: u32,
    sample: u32,
}

/// What the report is made of.
pub(super) struct Sources<'a> {
    pub(super) name: String,
    pub(super) output: String,
    /// What decides the picture besides the scene, as typed.
    pub(super) options: String,
    pub(super) scene: &'a Scene,
    pub(super) coverage: Coverage,
    /// The file from which it could go on, if that is to be said here.
    pub(super) continued_by: Option<String>,
    pub(super) settings: Settings,
    pub(super) summary: Summary,
    pub(super) statistics: Statistics,
    pub(super) lesson: Option<Lesson>,
    pub(super) denoised: Option<Denoised>,
    pub(super) load_time: Duration,
    pub(super) threads: usize,
    pub(super) memory_budget: u64,
    pub(super) peak_memory: Option<u64>,
}

impl From<Sources<'_>> for Report {
    fn from(from: Sources<'_>) -> Self {
        let Sources { scene, summary, statistics, .. } = from;
        let rays = statistics.camera_rays + statistics.bounce_rays + statistics.shadow_rays;
        let [trace, sort, shade, add] = statistics.profile.shares();
        Self {
            scene: from.name,
            output: from.output,
            width: scene.film.window().width,
            height: scene.film.window().height,
            samples_per_pixel: scene.sampler.sample_count,
            samples_least: from.coverage.least,
            samples_most: from.coverage.most,
            complete: from.coverage.complete,
            continued_by: from.continued_by,
            integrator: IntegratorName::from(&scene.integrator).to_string(),
            backend: match from.settings.backend {
                Backend::Packet => "packet",
                Backend::Scalar => "scalar",
            },
            sorted: from.settings.sort,
            lanes: cpu::compiled(),
            threads: from.threads,
            triangles: summary.triangles,
            quadrics: summary.quadrics,
            materials: summary.materials,
            lights: summary.lights,
            load_seconds: from.load_time.as_secs_f64(),
            bvh_seconds: summary.bvh_time.as_secs_f64(),
            render_seconds: statistics.time.as_secs_f64(),
            rays: Rays {
                camera: statistics.camera_rays,
                bounce: statistics.bounce_rays,
                shadow: statistics.shadow_rays,
            },
            mrays_per_second: mega_per_second(rays, statistics.time),
            msamples_per_second: mega_per_second(statistics.samples, statistics.time),
            profile: Profile { trace, sort, shade, add },
            lane_use: LaneUse {
                trace: statistics.trace_lanes.ratio(),
                shade: statistics.shade_lanes.ratio(),
            },
            invalid_samples: statistics.invalid_samples,
            first_invalid: statistics.first_invalid.map(|(x, y, sample)| Sample { x, y, sample }),
            denoised: from.denoised,
            stats: from.lesson,
            options: from.options,
            memory_budget_bytes: from.memory_budget,
            peak_memory_bytes: from.peak_memory,
        }
    }
}

impl Report {
    fn samples(&self) -> String {
        let of =
            if self.complete { String::new() } else { format!("{} of ", grouped(self.samples_most.into())) };
        let most = if self.complete { self.samples_most } else { self.samples_per_pixel };
        let least = if self.samples_least == self.samples_most {
            String::new()
        } else {
            format!("{} to ", grouped(self.samples_least.into()))
        };
        format!("{least}{of}{}", counted(most, "sample"))
    }

    /// As they were asked for.
    pub(super) fn samples_per_pixel(&self) -> u32 {
        self.samples_per_pixel
    }

    /// NaN and infinite samples are kept out of the picture, but never silently.
    pub(super) fn warning(&self) -> Option<String> {
        let what = match self.invalid_samples {
            0 => return None,
            1 => "1 sample was not a finite number and was left out of the picture".to_owned(),
            n => format!("{} samples were not finite numbers and were left out of the picture", grouped(n)),
        };
        Some(match self.first_invalid {
            Some(Sample { x, y, sample }) => {
                let Self { scene, options, .. } = self;
                format!(
                    "{what}; the first is sample {sample} of pixel ({x}, {y}), which this shows by itself:\n  \
                     packlight render {scene}{options} --pixel {x},{y} --sample {sample}"
                )
            }
            None => what,
        })
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |seconds: f64| time(Duration::from_secs_f64(seconds));
        writeln!(f, "{} -> {}", self.scene, self.output)?;
        writeln!(
            f,
            "  picture  {} x {}, {} a pixel, {}",
            self.width,
            self.height,
            self.samples(),
            self.integrator
        )?;
        if let Some(kept) = self.continued_by.as_ref().filter(|_| !self.complete) {
            writeln!(f, "  stopped  --resume {kept} continues it")?;
        }
        if let Some(Denoised { output, by, seconds: spent }) = &self.denoised {
            writeln!(f, "  denoised {output}, by {by} in {}", seconds(*spent))?;
        }
        writeln!(
            f,
            "  scene    {}, {}, {}, {}",
            counted(self.triangles, "triangle"),
            counted(self.quadrics, "quadric"),
            counted(self.materials, "material"),
            counted(self.lights, "light")
        )?;
        writeln!(
            f,
            "  time     load {}, BVH {}, render {} on {}",
            seconds(self.load_seconds),
            seconds(self.bvh_seconds),
            seconds(self.render_seconds),
            counted(self.threads as u64, "thread")
        )?;
        let Rays { camera, bounce, shadow } = self.rays;
        writeln!(f, "  rays     {} camera, {} bounce, {} shadow", mega(camera), mega(bounce), mega(shadow))?;
        writeln!(
            f,
            "  speed    {:.2} Mrays/s, {:.2} Msamples/s",
            self.mrays_per_second, self.msamples_per_second
        )?;
        match self.backend {
            "packet" => {
                let Profile { trace, sort, shade, add } = self.profile;
                let [trace, sort, shade, add] = [trace, sort, shade, add].map(|share| 100.0 * share);
                // What goes on from all its samples has no time to share out.
                if trace + sort + shade + add > 0.0 {
                    writeln!(
                        f,
                        "  profile  trace {trace:.1} %, sort {sort:.1} %, shade {shade:.1} %, add {add:.1} %"
                    )?;
                }
                let [trace, shade] = [self.lane_use.trace, self.lane_use.shade].map(|used| 100.0 * used);
                writeln!(
                    f,
                    "  lanes    {trace:.1} % at work in trace, {shade:.1} % in shade\n           {}",
                    self.lanes
                )?;
            }
            _ => writeln!(f, "  lanes    one ray at a time")?,
        }
        if let Some(stats) = &self.stats {
            write!(f, "{stats}")?;
        }
        if let Some(bytes) = self.peak_memory_bytes {
            writeln!(f, "  memory   {} at the peak", memory(bytes))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{compile::compile, render, scene::SceneDescription};

    fn report(statistics: Statistics) -> Report {
        Report::from(Sources {
            name: "box.xml".into(),
            output: "box.exr".into(),
            options: " --seed 9".into(),
            scene: &compile(&SceneDescription::default()).expect("it compiles"),
            coverage: Coverage { least: 4, most: 4, complete: true },
            continued_by: Some("kept.exr".into()),
            settings: Settings::default(),
            summary: Summary { triangles: 1234, lights: 1, ..Summary::default() },
            statistics,
            lesson: None,
            denoised: None,
            load_time: Duration::from_millis(12),
            threads: 2,
            memory_budget: 1 << 20,
            peak_memory: None,
        })
    }

    #[test]
    fn rates_count_all_rays() {
        let report = report(Statistics {
            samples: 1_000_000,
            camera_rays: 1_000_000,
            bounce_rays: 2_000_000,
            shadow_rays: 3_000_000,
            trace_lanes: render::LaneUse { active: 6, total: 8 },
            profile: render::Profile {
                trace: Duration::from_secs(3),
                shade: Duration::from_secs(1),
                ..render::Profile::default()
            },
            time: Duration::from_secs(2),
            ..Statistics::default()
        });
        assert_eq!((report.mrays_per_second, report.msamples_per_second), (3.0, 0.5));
        let text = report.to_string();
        for part in
            ["1,234 triangles", "1 light\n", "3.00 Mrays/s", "trace 75.0 %", "75.0 % at work", "2 threads"]
        {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }

    #[test]
    fn what_has_not_ended_says_how_it_goes_on() {
        let mut report = report(Statistics::default());
        let text = report.to_string();
        assert!(text.contains(", 4 samples a pixel, ") && !text.contains("kept.exr"), "{text}");
        (report.samples_per_pixel, report.complete) = (4096, false);
        let text = report.to_string();
        assert!(text.contains(", 4 of 4,096 samples a pixel, "), "{text}");
        assert!(text.contains("\n  stopped  --resume kept.exr continues it\n"), "{text}");
        report.samples_most = 8;
        assert!(report.to_string().contains(", 4 to 8 of 4,096 samples a pixel, "), "{report}");
    }

    #[test]
    fn memory_is_absent_where_it_is_unknown() {
        let json = serde_json::to_value(report(Statistics::default())).unwrap();
        assert!(json.get("peak_memory_bytes").is_none());
        assert_eq!(json["triangles"], 1234);
        assert!(json["first_invalid"].is_null());
    }

    #[test]
    fn invalid_samples_are_told_with_their_place() {
        assert_eq!(report(Statistics::default()).warning(), None);
        let counts =
            Statistics { invalid_samples: 2, first_invalid: Some((3, 4, 5)), ..Statistics::default() };
        let warning = report(counts).warning().unwrap();
        assert!(warning.contains("2 samples") && warning.contains("sample 5 of pixel (3, 4)"), "{warning}");
        assert!(warning.ends_with("packlight render box.xml --seed 9 --pixel 3,4 --sample 5"), "{warning}");
    }
}
