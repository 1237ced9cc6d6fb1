//! `--stats`: what a ray costs.

use std::fmt;

use serde::Serialize;

use crate::{
    cli::quantity::counted,
    compile::Scene,
    render::{RayClass, measure, ray_classes},
};

/// Field names are keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct Lesson {
    rays: Vec<Cost>,
}

/// What rays of a kind are tested against in the tree, each by itself.
#[derive(Clone, Copy, Debug, Serialize)]
struct Cost {
    kind: &'static str,
    nodes_per_ray: f64,
    primitives_per_ray: f64,
}

impl Lesson {
    /// Of the rays that one sample of each pixel sends.
    pub(super) fn new(scene: &Scene) -> Self {
        let cost = |class: &RayClass| {
            let counts = measure::count_singles(scene, class);
            let rays = class.rays.len().max(1) as f64;
            Cost {
                kind: class.name,
                nodes_per_ray: counts.nodes as f64 / rays,
                primitives_per_ray: counts.primitives as f64 / rays,
            }
        };
        Self { rays: ray_classes(scene).iter().map(cost).collect() }
    }
}

impl fmt::Display for Lesson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  a ray    by itself meets, in {}:", counted(self.rays.len() as u64, "kind"))?;
        for Cost { kind, nodes_per_ray, primitives_per_ray } in &self.rays {
            writeln!(f, "    {kind:<9} {nodes_per_ray:>7.2} nodes {primitives_per_ray:>7.2} primitives")?;
        }
        Ok(())
    }
}
