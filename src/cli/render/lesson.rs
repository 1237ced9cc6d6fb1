//! `--stats`: where the time goes, and what a ray costs.

use std::fmt;

use serde::Serialize;

use crate::{
    cli::quantity::counted,
    compile::Scene,
    render::{Stages, measure, ray_classes},
};

/// Field names are keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct Lesson {
    /// Over all threads.
    stage_seconds: StageSeconds,
    rays: Vec<Cost>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct StageSeconds {
    trace: f64,
    shade: f64,
    shadow_rays: f64,
    add: f64,
}

/// What rays of a kind are tested against in the tree, each by itself.
#[derive(Clone, Copy, Debug, Serialize)]
struct Cost {
    kind: &'static str,
    nodes_per_ray: f64,
    primitives_per_ray: f64,
}

impl Lesson {
    /// Of a render that took these stages. One sample of each pixel sends the rays that are counted.
    pub(super) fn new(scene: &Scene, stages: Stages) -> Self {
        let cost = |class: &crate::render::RayClass| {
            let counts = measure::count_singles(scene, class);
            let rays = class.rays.len().max(1) as f64;
            Cost {
                kind: class.name,
                nodes_per_ray: counts.nodes as f64 / rays,
                primitives_per_ray: counts.primitives as f64 / rays,
            }
        };
        let Stages { trace, shade, connect, add } = stages;
        Self {
            stage_seconds: StageSeconds {
                trace: trace.as_secs_f64(),
                shade: shade.as_secs_f64(),
                shadow_rays: connect.as_secs_f64(),
                add: add.as_secs_f64(),
            },
            rays: ray_classes(scene).iter().map(cost).collect(),
        }
    }
}

impl fmt::Display for Lesson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StageSeconds { trace, shade, shadow_rays, add } = self.stage_seconds;
        let total = trace + shade + shadow_rays + add;
        let share = |seconds: f64| if total > 0.0 { 100.0 * seconds / total } else { 0.0 };
        writeln!(
            f,
            "  stages   trace {:.0} %, shade {:.0} %, shadow rays {:.0} %, add and compact {:.0} %",
            share(trace),
            share(shade),
            share(shadow_rays),
            share(add)
        )?;
        writeln!(f, "  a ray    by itself meets, in {}:", counted(self.rays.len() as u64, "kind"))?;
        for Cost { kind, nodes_per_ray, primitives_per_ray } in &self.rays {
            writeln!(f, "    {kind:<9} {nodes_per_ray:>7.2} nodes {primitives_per_ray:>7.2} primitives")?;
        }
        Ok(())
    }
}
