//! `--stats`: what a render can teach, as a table or as JSON.

use std::fmt;

use serde::Serialize;

use crate::{
    cli::quantity::{grouped, time},
    compile::Scene,
    render::{Census, Crowd, LaneUse, Profile, census},
};

/// Field names are keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct Lesson {
    rays: Vec<Rays>,
    /// Shadow rays that something blocks, in [0, 1].
    blocked: f64,
    sorting: Sorting,
    ends: Ends,
    /// Paths that arrive at their first, second, … vertex.
    paths_by_vertex: Vec<u64>,
    /// Of all threads together; 0 where one ray goes at a time.
    thread_seconds: Stages,
}

/// What rays of a kind do in the tree, on average.
#[derive(Clone, Copy, Debug, Serialize)]
struct Rays {
    kind: &'static str,
    count: u64,
    /// Each by itself.
    nodes_per_ray: f64,
    primitives_per_ray: f64,
    /// As they are traced: what each was tested against, and the tests that were run for it and its company.
    nodes_per_ray_together: f64,
    primitives_per_ray_together: f64,
    tests_per_ray_together: f64,
    /// Of the packets that are handed to the tree, in [0, 1].
    lane_use: f64,
}

/// What sorting by material does for shading.
#[derive(Clone, Copy, Debug, Serialize)]
struct Sorting {
    lane_use_sorted: f64,
    lane_use_unsorted: f64,
    groups_sorted: u64,
    groups_unsorted: u64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Ends {
    escaped: u64,
    surface: u64,
    depth: u64,
    russian_roulette: u64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Stages {
    trace: f64,
    sort: f64,
    shade: f64,
    add: f64,
}

impl Lesson {
    /// Of the rays that one sample of each pixel sends; `profile` is that of the whole render.
    pub(super) fn new(scene: &Scene, profile: &Profile) -> Self {
        let Census { camera, bounce, shadow, blocked, sorted, unsorted, vertices, ends } = census(scene);
        let kinds = [("camera", camera), ("bounce", bounce), ("shadow", shadow)];
        Self {
            rays: kinds.iter().filter(|(_, crowd)| crowd.rays > 0).map(rays).collect(),
            blocked: ratio(blocked, shadow.rays),
            sorting: Sorting {
                lane_use_sorted: sorted.ratio(),
                lane_use_unsorted: unsorted.ratio(),
                groups_sorted: groups(sorted),
                groups_unsorted: groups(unsorted),
            },
            ends: Ends {
                escaped: ends.escaped,
                surface: ends.surface,
                depth: ends.depth,
                russian_roulette: ends.roulette,
            },
            paths_by_vertex: vertices,
            thread_seconds: Stages {
                trace: profile.trace.as_secs_f64(),
                sort: profile.sort.as_secs_f64(),
                shade: profile.shade.as_secs_f64(),
                add: profile.add.as_secs_f64(),
            },
        }
    }
}

fn rays(&(kind, Crowd { rays, packets, alone, together }): &(&'static str, Crowd)) -> Rays {
    Rays {
        kind,
        count: rays,
        nodes_per_ray: ratio(alone.nodes, rays),
        primitives_per_ray: ratio(alone.primitives, rays),
        nodes_per_ray_together: ratio(together.nodes, rays),
        primitives_per_ray_together: ratio(together.primitives, rays),
        tests_per_ray_together: ratio(together.tests, rays),
        lane_use: packets.ratio(),
    }
}

/// 0 of nothing.
fn ratio(part: u64, whole: u64) -> f64 {
    part as f64 / whole.max(1) as f64
}

fn groups(lanes: LaneUse) -> u64 {
    lanes.total / crate::simd::LANES as u64
}

impl fmt::Display for Lesson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        writeln!(f, "  one sample of each pixel, counted:")?;
        writeln!(
            f,
            "    {:<6} {:>9} {:>13} {:>19} {:>5}",
            "", "", "alone, a ray", "in company, a ray", "lanes"
        )?;
        writeln!(
            f,
            "    {:<6} {:>9} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5}",
            "rays", "number", "nodes", "prims", "nodes", "prims", "tests", "%"
        )?;
        for rays in &self.rays {
            writeln!(
                f,
                "    {:<6} {:>9} {:>6.2} {:>6.2} {:>6.2} {:>6.2} {:>5.2} {:>5.1}",
                rays.kind,
                grouped(rays.count),
                rays.nodes_per_ray,
                rays.primitives_per_ray,
                rays.nodes_per_ray_together,
                rays.primitives_per_ray_together,
                rays.tests_per_ray_together,
                percent(rays.lane_use),
            )?;
        }
        if self.rays.iter().any(|rays| rays.kind == "shadow") {
            writeln!(f, "    {:.1} % of the shadow rays are blocked", percent(self.blocked))?;
        }
        let Sorting { lane_use_sorted, lane_use_unsorted, groups_sorted, groups_unsorted } = self.sorting;
        writeln!(
            f,
            "  sorting  {:.1} % of shading's lanes at work, {:.1} % with hits as they come:",
            percent(lane_use_sorted),
            percent(lane_use_unsorted),
        )?;
        writeln!(
            f,
            "           {} groups of eight in place of {}",
            grouped(groups_sorted),
            grouped(groups_unsorted)
        )?;
        let Ends { escaped, surface, depth, russian_roulette } = self.ends;
        let all = escaped + surface + depth + russian_roulette;
        let share = |ends| percent(ratio(ends, all));
        writeln!(
            f,
            "  paths    end {:.1} % in the open, {:.1} % at a surface, {:.1} % by depth,\n           \
             {:.1} % by Russian roulette",
            share(escaped),
            share(surface),
            share(depth),
            share(russian_roulette),
        )?;
        let reach: Vec<String> = self.paths_by_vertex.iter().take(VERTICES).map(|&n| grouped(n)).collect();
        let more = if self.paths_by_vertex.len() > VERTICES { " …" } else { "" };
        writeln!(f, "           {}{more} arrive at vertex 1, 2, 3 …", reach.join(", "))?;
        let Stages { trace, sort, shade, add } = self.thread_seconds;
        let [trace, sort, shade, add] =
            [trace, sort, shade, add].map(|s| time(std::time::Duration::from_secs_f64(s)));
        writeln!(f, "  stages   trace {trace}, sort {sort}, shade {shade}, add {add}, of all threads")
    }
}

/// As many as fit on a line.
const VERTICES: usize = 6;
