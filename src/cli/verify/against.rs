//! `--against embree`: our hits and Embree's.

use std::{fmt, path::Path};

use clap::ValueEnum;
use serde::Serialize;

use crate::{
    cli::{
        failure::Failure,
        quantity::{counted, grouped},
    },
    compile::Scene,
    geometry::{Hit, PrimitiveId, Ray32},
    verify::{
        Exhibit,
        against::{Against, compare},
        embree::Embree,
        scene_of,
    },
};

/// Names the library's file.
const VARIABLE: &str = "EMBREE_LIB";

/// Whose answers ours are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Other {
    /// Intel's Embree 4, in its robust mode; EMBREE_LIB names the library
    Embree,
}

/// What came of it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct AgainstRow {
    /// Who, and which version.
    whose: String,
    /// Spheres, disks, cylinders and instances, which only we would have: both have the triangles only.
    left_out: u64,
    rays: u64,
    same: u64,
    /// Different triangles at the same distance.
    ties: u64,
    /// Rays along edges, or that begin or end on a triangle.
    at_edges: u64,
    /// What rounding does not explain.
    pub(super) different: u64,
}

/// Traces rays of a scene's triangles twice.
pub(super) fn against_embree<'a>(
    scene: &Scene,
    classes: impl Iterator<Item = &'a [Ray32]>,
) -> Result<(AgainstRow, Option<Exhibit>), Failure> {
    let Some(library) = std::env::var_os(VARIABLE).filter(|name| !name.is_empty()) else {
        return Err(Failure::Sentence(format!(
            "--against embree: {VARIABLE} does not name the library; set it, as in \
             {VARIABLE}=/usr/lib/x86_64-linux-gnu/libembree4.so.4"
        )));
    };
    let path = Path::new(&library);
    let triangles: Vec<_> =
        (0..scene.primitive_count()).filter_map(|i| scene.triangle(PrimitiveId(i))).collect();
    let refuse = |why: String| Failure::Sentence(format!("--against embree: {}: {why}", path.display()));
    let embree = Embree::new(path, &triangles).map_err(|error| refuse(error.to_string()))?;
    let ours =
        scene_of(&triangles).ok_or_else(|| refuse("the triangles can't be compiled by themselves".into()))?;
    let (mut sum, mut exhibit) = (Against::default(), None);
    for rays in classes {
        let mut a = vec![Hit::MISS; rays.len()];
        ours.closest_hits(rays, &mut a);
        let b = embree.closest_hits(rays);
        let found = compare(&triangles, rays, &a, &b);
        if let Some(first) = found.first.filter(|_| exhibit.is_none()) {
            exhibit = Some(show(&triangles, rays[first], [a[first], b[first]]));
        }
        sum.add(&found);
    }
    let Against { rays, same, ties, at_edges, different, .. } = sum;
    let left_out = u64::from(scene.primitive_count()) - triangles.len() as u64;
    let whose = format!("Embree {}", embree.version());
    Ok((AgainstRow { whose, left_out, rays, same, ties, at_edges, different }, exhibit))
}

/// The ray, and what either has hit.
fn show(triangles: &[[glam::Vec3; 3]], ray: Ray32, hits: [Hit; 2]) -> Exhibit {
    let hit = hits.iter().filter(|hit| hit.primitive != PrimitiveId::NONE);
    let mut shown: Vec<u32> = hit.map(|hit| hit.primitive.0).collect();
    shown.dedup();
    Exhibit {
        what: "Embree's hit is another one".into(),
        triangles: shown.into_iter().map(|id| triangles[id as usize]).collect(),
        rays: vec![ray],
        expected: None,
    }
}

impl fmt::Display for AgainstRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { whose, left_out, rays, same, ties, at_edges, different } = self;
        let [same, ties, at_edges, different] = [*same, *ties, *at_edges, *different].map(grouped);
        writeln!(
            f,
            "\n  {whose}: of {}, {same} hit the same, {ties} a neighbour at the same distance, {at_edges} differ at \
             an edge or an end, {different} differ otherwise",
            counted(*rays, "ray"),
        )?;
        if *left_out > 0 {
            let what = format!("{} no triangle", if *left_out == 1 { "is" } else { "are" });
            writeln!(f, "  {} that {what} left out", counted(*left_out, "primitive"))?;
        }
        Ok(())
    }
}
