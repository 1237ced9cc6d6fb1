//! A measurement as a line: for programs, and for people.

use std::{fmt, time::Duration};

use serde::Serialize;

use crate::{
    cli::quality::QualityName,
    cli::quantity::{counted, grouped, mega_per_second, memory, time},
    compile::Summary,
    render::{
        Query, RayClass,
        measure::{Counts, Timed},
    },
};

/// A class of rays. Field names are the keys of `--json`; the first five are what other programs that
/// compare ray tracers expect.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    mrays_per_s: f64,
    hits: u64,
    t_sum: f64,
    build_s: f64,
    bvh_bytes: u64,
    quality: &'static str,
    class: &'static str,
    query: &'static str,
    rays: u64,
    /// Rays of the file that can't be traced; they count as misses.
    invalid: u64,
    threads: usize,
    #[serde(skip)]
    single: Option<Single>,
}

/// What the table says beside the rate.
#[derive(Clone, Copy, Debug)]
struct Single {
    mrays_per_s: f64,
    packets: Counts,
    singles: Counts,
}

impl Row {
    pub(super) fn new(class: &RayClass, invalid: u64, timed: Timed, summary: Summary) -> Self {
        let rays = class.rays.len() as u64;
        Self {
            mrays_per_s: mega_per_second(rays, timed.best),
            hits: timed.hits,
            t_sum: timed.t_sum,
            build_s: summary.bvh_time.as_secs_f64(),
            bvh_bytes: summary.bvh_bytes,
            quality: QualityName::from(summary.quality).name(),
            class: class.name,
            query: match class.query {
                Query::Closest => "closest",
                Query::Any => "any",
            },
            rays,
            invalid,
            threads: rayon::current_num_threads(),
            single: None,
        }
    }

    /// Adds the single-ray path and what was counted.
    pub(super) fn compare(&mut self, timed: Timed, packets: Counts, singles: Counts) {
        let mrays_per_s = mega_per_second(self.rays, timed.best);
        self.single = Some(Single { mrays_per_s, packets, singles });
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.hits as f64 / self.rays as f64;
        let class = match self.query {
            "any" => format!("{} any", self.class),
            _ => self.class.to_owned(),
        };
        write!(f, "  {class:<10} {:>9} {share:>5.1} {:>7.2}", grouped(self.rays), self.mrays_per_s)?;
        if let Some(Single { mrays_per_s, packets, singles }) = self.single {
            let per_ray = |n: u64| short(n as f64 / self.rays as f64);
            let factor = if mrays_per_s > 0.0 { self.mrays_per_s / mrays_per_s } else { 0.0 };
            write!(
                f,
                " {:>5} {:>5} {:>5.1} {mrays_per_s:>7.2} {:>5} {:>5} {factor:>5.2}",
                per_ray(packets.nodes),
                per_ray(packets.primitives),
                100.0 * packets.lane_use(),
                per_ray(singles.nodes),
                per_ray(singles.primitives),
            )?;
        }
        writeln!(f)?;
        match self.invalid {
            0 => Ok(()),
            n => writeln!(
                f,
                "  {} of the file can't be traced (not finite, no direction, or ends out of order) and counted \
                 as misses",
                counted(n, "ray")
            ),
        }
    }
}

/// Four digits that count, so that a line is no longer than a terminal's 80 columns.
fn short(x: f64) -> String {
    let places = if x < 100.0 {
        2
    } else if x < 1000.0 {
        1
    } else {
        0
    };
    format!("{x:.places$}")
}

/// The tree, and the head of the table.
pub(super) struct Build {
    name: String,
    summary: Summary,
}

impl Build {
    pub(super) fn new(name: String, summary: Summary) -> Self {
        Self { name, summary }
    }
}

impl fmt::Display for Build {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { triangles, quadrics, bvh_nodes, bvh_bytes, bvh_time, quality, .. } = self.summary;
        let primitives = triangles + quadrics;
        let each = if primitives == 0 { 0.0 } else { bvh_bytes as f64 / primitives as f64 };
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  {}, {}", counted(triangles, "triangle"), counted(quadrics, "quadric"))?;
        writeln!(
            f,
            "  tree of {} quality: {}, {:.2} M primitives/s on {}",
            QualityName::from(quality),
            time(Duration::from_secs_f64(bvh_time.as_secs_f64())),
            mega_per_second(primitives, bvh_time),
            counted(rayon::current_num_threads() as u64, "thread"),
        )?;
        writeln!(f, "  {}, {}, {each:.0} bytes a primitive", counted(bvh_nodes, "node"), memory(bvh_bytes))?;
        writeln!(f)?;
        writeln!(f, "  {:<10} {:>9} {:>5} {:<25} single rays", "", "", "hits", "packets")?;
        writeln!(
            f,
            "  {:<10} {:>9} {:>5} {:>7} {:>5} {:>5} {:>5} {:>7} {:>5} {:>5} ratio",
            "class", "rays", "%", "Mrays/s", "nodes", "tests", "lanes", "Mrays/s", "nodes", "tests"
        )
    }
}
