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

/// How the table is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Table {
    /// A line a class, of 80 columns.
    Wide,
    /// Single rays on a line of their own, of 60 columns.
    Narrow,
}

impl Table {
    /// For a terminal of so many columns, or none at all.
    pub(super) fn within(columns: Option<usize>) -> Self {
        if columns.is_some_and(|columns| columns < 80) { Self::Narrow } else { Self::Wide }
    }
}

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
    table: Table,
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
    pub(super) fn compare(&mut self, timed: Timed, packets: Counts, singles: Counts, table: Table) {
        let mrays_per_s = mega_per_second(self.rays, timed.best);
        self.single = Some(Single { mrays_per_s, packets, singles, table });
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
        if let Some(Single { mrays_per_s, packets, singles, table }) = self.single {
            let per_ray = |counts: Counts| {
                let [nodes, tests] =
                    [counts.nodes, counts.primitives].map(|n| short(n as f64 / self.rays as f64));
                format!("{nodes:>5} {tests:>5}")
            };
            let factor = if mrays_per_s > 0.0 { self.mrays_per_s / mrays_per_s } else { 0.0 };
            write!(f, " {} {:>5.1}", per_ray(packets), 100.0 * packets.lane_use())?;
            let singles = format!("{mrays_per_s:>7.2} {}", per_ray(singles));
            match table {
                Table::Wide => write!(f, " {singles} {factor:>5.2}")?,
                Table::Narrow => write!(f, " {factor:>5.2}\n    {:<24} {singles}", "single rays")?,
            }
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
    table: Table,
}

impl Build {
    pub(super) fn new(name: String, summary: Summary, table: Table) -> Self {
        Self { name, summary, table }
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
        let rate = format!("{:>7} {:>5} {:>5}", "Mrays/s", "nodes", "tests");
        let (singles, over) = match self.table {
            Table::Wide => (format!(" {rate}"), format!("{:<25} single rays", "packets")),
            Table::Narrow => (String::new(), "packets".to_owned()),
        };
        writeln!(f, "  {:<10} {:>9} {:>5} {over}", "", "", "hits")?;
        writeln!(f, "  {:<10} {:>9} {:>5} {rate} lanes{singles} ratio", "class", "rays", "%")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(table: Table) -> String {
        let class = RayClass { name: "shadow", query: Query::Any, rays: Vec::new() };
        let timed = Timed { best: Duration::from_secs(1), hits: 5_000_000, t_sum: 0.0 };
        let mut row = Row::new(&class, 0, timed, Summary::default());
        row.rays = 9_999_999;
        let counts = |nodes| Counts { nodes, primitives: 3 * nodes, ..Counts::default() };
        row.compare(timed, counts(99_999_990), counts(70_000_000), table);
        let build = Build::new("scene.xml".to_owned(), Summary::default(), table).to_string();
        let head = build.lines().rev().take(2).collect::<Vec<_>>();
        format!("{}\n{}\n{row}", head[1], head[0])
    }

    #[test]
    fn a_table_is_as_wide_as_the_terminal_can_show() {
        assert_eq!([None, Some(200), Some(80)].map(Table::within), [Table::Wide; 3]);
        assert_eq!([Some(79), Some(60), Some(0)].map(Table::within), [Table::Narrow; 3]);
        for (table, most) in [(Table::Wide, 80), (Table::Narrow, 60)] {
            let told = told(table);
            let lengths: Vec<usize> = told.lines().map(|line| line.chars().count()).collect();
            assert_eq!((lengths[1], lengths[2]), (most, most), "{told}");
            assert!(lengths.iter().all(|&length| length <= most), "{told}");
        }
        // Single rays stand below packets, number by number.
        let told = told(Table::Narrow);
        let ends = |line: usize, number: &str| {
            told.lines().nth(line).and_then(|l| l.find(number)).map(|at| at + number.len())
        };
        assert_eq!(ends(2, " 10.00"), ends(1, " nodes"), "{told}");
        assert_eq!(ends(3, " 7.00"), ends(1, " nodes"), "{told}");
        assert_eq!(ends(3, " 21.00"), ends(1, " tests"), "{told}");
    }
}
