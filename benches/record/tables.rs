//! The record as tables in Markdown, ready to be pasted.

use std::fmt::Write as _;

use crate::{
    fit::{Fit, Growth},
    floors::Floors,
    growth,
    row::{BUILD, Row, Table},
};

/// Of rays, in the order in which light travels.
const CLASSES: [&str; 5] = ["primary", "shadow", "ao", "diffuse", "diffuse2"];

/// Rows that were measured alike: the same processor, lanes and options.
pub(crate) fn groups(rows: &[Row], table: Table) -> Vec<Vec<&Row>> {
    let same = |a: &Row, b: &Row| (&a.cpu, &a.lanes, &a.options) == (&b.cpu, &b.lanes, &b.options);
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows.iter().filter(|row| row.table == table) {
        match groups.iter_mut().find(|group| same(group[0], row)) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups
}

/// All that the rows hold.
pub(crate) fn all(rows: &[Row]) -> String {
    let mut text = String::new();
    for group in groups(rows, Table::Growth) {
        text += &heading("Growth", group[0]);
        text += &growth_table(&group);
        text += &growth_claims(&group);
    }
    for group in groups(rows, Table::Scenes) {
        text += &heading("Eight rays at a time / one, one thread", group[0]);
        text += &ratios(&group, 1);
    }
    for group in groups(rows, Table::Peers) {
        let mut threads: Vec<usize> = group.iter().map(|row| row.threads).collect();
        threads.sort_unstable();
        threads.dedup();
        for threads in threads {
            let count = if threads == 1 { "one thread".to_owned() } else { format!("{threads} threads") };
            text += &heading(&format!("Ours / Embree, {count} each"), group[0]);
            text += &ratios(&group, threads);
        }
    }
    text
}

fn heading(what: &str, row: &Row) -> String {
    let options = if row.options.is_empty() { String::new() } else { format!(", `{}`", row.options) };
    format!("\n{what} ({}, {}{options}, {}, commit {})\n\n", row.cpu, row.lanes, row.date, row.commit)
}

/// Classes down, scenes across, with geometric means, and floors where there are any. What is below its
/// floor, or disagrees, is marked.
fn ratios(group: &[&Row], threads: usize) -> String {
    let group: Vec<&Row> = group.iter().copied().filter(|row| row.threads == threads).collect();
    let mut scenes: Vec<&str> = Vec::new();
    for row in &group {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(&row.scene);
        }
    }
    let floored = group.first().is_some_and(|row| row.table == Table::Peers);
    let mut text =
        format!("| | {} | geometric mean |{}\n", scenes.join(" | "), if floored { " floors |" } else { "" });
    text += &format!("|{}\n", " --- |".repeat(scenes.len() + 2 + usize::from(floored)));
    for class in CLASSES.into_iter().chain([BUILD]) {
        let row = |scene: &&str| group.iter().find(|row| row.scene == **scene && row.class == class);
        let found: Vec<Option<&&Row>> = scenes.iter().map(row).collect();
        let ratios: Vec<f64> = found.iter().filter_map(|row| row.and_then(|row| row.ratio)).collect();
        if ratios.is_empty() {
            continue;
        }
        let floors = if floored { Floors::of(class, threads) } else { None };
        let _ = write!(text, "| {class} |");
        for row in &found {
            let floor = floors.map(|floors| floors.each);
            let _ = write!(text, " {} |", row.map_or(String::new(), |row| cell(row, floor)));
        }
        let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
        let _ = write!(text, " {} |", marked(mean, floors.map(|floors| floors.mean)));
        match floors {
            Some(Floors { each, mean }) => text += &format!(" {each:.2}, {mean:.2} |"),
            None if floored => text += " |",
            None => {}
        }
        text.push('\n');
    }
    text
}

fn cell(row: &Row, floor: Option<f64>) -> String {
    let ratio = row.ratio.map_or(String::new(), |ratio| marked(ratio, floor));
    if row.agrees == Some(false) { format!("{ratio} DISAGREES") } else { ratio }
}

/// Bold below the floor.
fn marked(ratio: f64, floor: Option<f64>) -> String {
    if floor.is_some_and(|floor| ratio < floor) { format!("**{ratio:.2}**") } else { format!("{ratio:.2}") }
}

/// A line a mesh.
fn growth_table(group: &[&Row]) -> String {
    let mut text = "\
| mesh | triangles | camera: nodes | one ray | per log₂ N | Mrays/s | bounce: nodes | one ray | per log₂ N | Mrays/s | Mtris/s | bytes/tri | peak/BVH |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"
    .to_owned();
    let number =
        |value: Option<f64>, digits: usize| value.map_or(String::new(), |value| format!("{value:.digits$}"));
    for build in group.iter().filter(|row| row.class == BUILD) {
        let triangles = build.primitives.unwrap_or_default();
        let _ = write!(text, "| {} | {triangles} |", build.scene);
        for class in growth::CLASSES {
            let row = group.iter().find(|row| row.scene == build.scene && row.class == class);
            let of = |quantity: fn(&Row) -> Option<f64>| row.and_then(|row| quantity(row));
            let single = of(|row| row.single_nodes_per_ray);
            let _ = write!(
                text,
                " {} | {} | {} | {} |",
                number(of(|row| row.nodes_per_ray), 2),
                number(single, 2),
                number(single.map(|nodes| nodes / (triangles as f64).log2()), 3),
                number(of(|row| row.mega_per_s), 2)
            );
        }
        let _ = writeln!(
            text,
            " {} | {} | {} |",
            number(build.mega_per_s, 2),
            number(build.bytes_per_primitive, 1),
            number(build.peak_per_bvh, 2)
        );
    }
    text
}

/// How nodes grow with the mesh, kind by kind.
fn growth_claims(group: &[&Row]) -> String {
    let mut text = String::from("\n");
    for (kind, class) in growth::KINDS.iter().flat_map(|kind| growth::CLASSES.map(|class| (kind, class))) {
        for (way, nodes) in [
            ("one ray", (|row| row.single_nodes_per_ray) as fn(&Row) -> Option<f64>),
            ("as traced", |row| row.nodes_per_ray),
        ] {
            if let Some(fit) = Fit::of(&points(group, kind, class, nodes)) {
                let Fit { a, b, r2, last_step, exponent } = fit;
                let verdict = match fit.growth() {
                    Growth::Logarithm => "log N".to_owned(),
                    Growth::Bent => format!("a little faster than log N, N^{exponent:.2} at the end"),
                    Growth::Power => format!("N^{exponent:.2} at the end"),
                };
                let _ = writeln!(
                    text,
                    "- {kind}, {class}, {way}: nodes = {a:.2} + {b:.3} log₂ N (R² {r2:.3}, last step {last_step:.2} of \
                     the mean): {verdict}"
                );
            }
        }
    }
    text
}

/// Nodes of one ray that grow like a power of N, a sentence each. Rays that travel together share nodes, so
/// those as traced are no cost of the tree.
pub(crate) fn unfounded(rows: &[Row]) -> Vec<String> {
    let mut found = Vec::new();
    for group in groups(rows, Table::Growth) {
        for (kind, class) in growth::KINDS.iter().flat_map(|kind| growth::CLASSES.map(|class| (kind, class)))
        {
            let points = points(&group, kind, class, |row| row.single_nodes_per_ray);
            if let Some(fit) = Fit::of(&points).filter(|fit| fit.growth() == Growth::Power) {
                found.push(format!("gen:{kind}, {class} rays: nodes grow like a power of N: {fit:?}"));
            }
        }
    }
    found
}

/// (N, quantity) in ascending order.
pub(crate) fn points(
    group: &[&Row],
    kind: &str,
    class: &str,
    quantity: fn(&Row) -> Option<f64>,
) -> Vec<(f64, f64)> {
    let of_kind = |row: &&&Row| row.class == class && row.scene.starts_with(&format!("gen:{kind}:"));
    let point = |row: &&Row| Some((row.primitives? as f64, quantity(row)?));
    let mut points: Vec<(f64, f64)> = group.iter().filter(of_kind).filter_map(point).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Small sphereflakes of different names are the same one.
    points.dedup_by_key(|point| point.0);
    points
}
