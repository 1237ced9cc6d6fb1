//! A class of rays through a scene, on one thread, as a row.

use packlight::{
    bvh::Way,
    compile::Scene,
    render::{
        RayClass,
        measure::{self, Timed},
    },
};

use crate::{
    row::{Row, rounded},
    run::pool,
};

/// Fills in rates and counts; `row` is for one thread.
pub(crate) fn trace(scene: &Scene, class: &RayClass, repeat: u32, row: &mut Row) -> Result<(), String> {
    let rays = class.rays.len() as f64;
    let rate = |timed: &Timed| rays / timed.best.as_secs_f64() / 1e6;
    let (packets, singles) =
        pool(1)?.install(|| (measure::packets(scene, class, repeat), measure::singles(scene, class, repeat)));
    let (wide, narrow) =
        (measure::count_packets(scene, class, Way::Chosen), measure::count_singles(scene, class));
    let summary = scene.summary();
    row.primitives = Some(summary.triangles + summary.quadrics);
    row.rays = Some(class.rays.len() as u64);
    row.mega_per_s = rounded(rate(&packets));
    "scalar".clone_into(&mut row.beside);
    row.beside_mega_per_s = rounded(rate(&singles));
    row.ratio = rounded(rate(&packets) / rate(&singles));
    row.agrees = Some((packets.hits, packets.t_sum.to_bits()) == (singles.hits, singles.t_sum.to_bits()));
    row.nodes_per_ray = rounded(wide.nodes as f64 / rays);
    row.tests_per_ray = rounded(wide.primitives as f64 / rays);
    row.lane_use = rounded(wide.lane_use());
    row.single_nodes_per_ray = rounded(narrow.nodes as f64 / rays);
    row.single_tests_per_ray = rounded(narrow.primitives as f64 / rays);
    Ok(())
}
