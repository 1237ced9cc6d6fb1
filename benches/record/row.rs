//! A measurement: a line of the record.

use serde::{Deserialize, Serialize};

use crate::machine::Machine;

/// What is measured.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Table {
    /// Meshes of one kind, from a thousand triangles to ten million.
    Growth,
    /// Every scene of `scenes/`, eight rays at a time and one.
    Scenes,
    /// Meshes and rays on which other ray tracers are measured, beside Embree.
    Peers,
}

/// The class of a row that measures the build and not rays.
pub(crate) const BUILD: &str = "build";

/// Field names are the columns of the file; README.md beside this file says what is in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) date: String,
    pub(crate) commit: String,
    pub(crate) cpu: String,
    pub(crate) lanes: String,
    pub(crate) threads: usize,
    pub(crate) options: String,
    pub(crate) table: Table,
    pub(crate) scene: String,
    pub(crate) class: String,
    pub(crate) primitives: Option<u64>,
    pub(crate) rays: Option<u64>,
    pub(crate) mega_per_s: Option<f64>,
    pub(crate) beside: String,
    pub(crate) beside_mega_per_s: Option<f64>,
    pub(crate) ratio: Option<f64>,
    pub(crate) agrees: Option<bool>,
    pub(crate) nodes_per_ray: Option<f64>,
    pub(crate) tests_per_ray: Option<f64>,
    pub(crate) lane_use: Option<f64>,
    pub(crate) single_nodes_per_ray: Option<f64>,
    pub(crate) single_tests_per_ray: Option<f64>,
    pub(crate) bytes_per_primitive: Option<f64>,
    pub(crate) beside_bytes_per_primitive: Option<f64>,
    pub(crate) peak_per_bvh: Option<f64>,
}

impl Row {
    /// A row without quantities.
    pub(crate) fn new(
        date: &str,
        machine: &Machine,
        threads: usize,
        table: Table,
        scene: &str,
        class: &str,
    ) -> Self {
        Self {
            date: date.to_owned(),
            commit: machine.commit.clone(),
            cpu: machine.cpu.clone(),
            lanes: machine.lanes.to_owned(),
            threads,
            options: String::new(),
            table,
            scene: scene.to_owned(),
            class: class.to_owned(),
            primitives: None,
            rays: None,
            mega_per_s: None,
            beside: String::new(),
            beside_mega_per_s: None,
            ratio: None,
            agrees: None,
            nodes_per_ray: None,
            tests_per_ray: None,
            lane_use: None,
            single_nodes_per_ray: None,
            single_tests_per_ray: None,
            bytes_per_primitive: None,
            beside_bytes_per_primitive: None,
            peak_per_bvh: None,
        }
    }

    /// Do both measure the same thing? The later one then replaces the earlier.
    pub(crate) fn replaces(&self, earlier: &Self) -> bool {
        let key = |row: &Self| {
            let text = [&row.cpu, &row.lanes, &row.options, &row.scene, &row.class].map(String::clone);
            (row.table, row.threads, text)
        };
        key(self) == key(earlier)
    }
}

/// Four digits: more would be noise.
pub(crate) fn rounded(x: f64) -> Option<f64> {
    if !x.is_finite() {
        return None;
    }
    format!("{x:.3e}").parse().ok()
}
