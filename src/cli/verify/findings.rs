//! What was found, for programs and for people.

use std::fmt;

use serde::Serialize;

use super::{against::AgainstRow, exhibit::Written};
use crate::{
    cli::{
        failure::Failure,
        quantity::{counted, grouped},
    },
    compile::Summary,
    verify::{cracks::Cracks, departures::Departures, ways::Comparison},
};

/// Field names are the keys of `--json`.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Findings {
    scene: String,
    triangles: u64,
    quadrics: u64,
    pub(super) classes: Vec<ClassRow>,
    pub(super) leaks: Option<LeakRow>,
    pub(super) self_hits: Option<SelfHitRow>,
    pub(super) against: Option<AgainstRow>,
    /// Of the rays of a file, those that do not find what they should.
    pub(super) unexpected: Option<u64>,
    pub(super) failure: Option<Written>,
}

/// Rays of one kind, each asked for its nearest hit and whether it is blocked.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ClassRow {
    class: &'static str,
    rays: u64,
    hits: u64,
    /// Rays that were tested against every primitive too.
    brute_force: u64,
    mismatches: u64,
}

/// Rays aimed at edges and vertices that triangles share.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LeakRow {
    edges: u64,
    vertices: u64,
    rays: u64,
    leaks: u64,
}

/// Rays that left a triangle.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct SelfHitRow {
    rays: u64,
    self_hits: u64,
}

impl ClassRow {
    pub(super) fn new(class: &'static str, compared: &Comparison) -> Self {
        let Comparison { rays, hits, brute_force, mismatches, .. } = *compared;
        Self { class, rays, hits, brute_force, mismatches }
    }
}

impl From<&Cracks> for LeakRow {
    fn from(found: &Cracks) -> Self {
        let Cracks { edges, vertices, rays, leaks, .. } = *found;
        Self { edges, vertices, rays, leaks }
    }
}

impl SelfHitRow {
    pub(super) fn add(&mut self, found: &Departures) {
        self.rays += found.rays;
        self.self_hits += found.self_hits;
    }
}

impl Findings {
    pub(super) fn new(scene: String, summary: Summary) -> Self {
        Self {
            scene,
            triangles: summary.triangles,
            quadrics: summary.quadrics,
            classes: Vec::new(),
            leaks: None,
            self_hits: None,
            against: None,
            unexpected: None,
            failure: None,
        }
    }

    /// A failure if anything is wrong.
    pub(super) fn verdict(&self) -> Result<(), Failure> {
        let mismatches: u64 = self.classes.iter().map(|row| row.mismatches).sum();
        let leaks = self.leaks.as_ref().map_or(0, |row| row.leaks);
        let self_hits = self.self_hits.as_ref().map_or(0, |row| row.self_hits);
        let different = self.against.as_ref().map_or(0, |row| row.different);
        let unexpected = self.unexpected.unwrap_or(0);
        let wrong: Vec<String> = [
            (mismatches, "answer that differs", "answers that differ"),
            (leaks, "leak", "leaks"),
            (self_hits, "self-hit", "self-hits"),
            (different, "hit that Embree does not have", "hits that Embree does not have"),
            (unexpected, "ray that does not find what it should", "rays that do not find what they should"),
        ]
        .into_iter()
        .filter(|&(count, ..)| count > 0)
        .map(|(count, one, many)| format!("{} {}", grouped(count), if count == 1 { one } else { many }))
        .collect();
        if wrong.is_empty() {
            return Ok(());
        }
        let show = self.failure.as_ref().map(|failure| format!("; to see it again: {}", failure.command));
        Err(Failure::Sentence(format!("{}: {}{}", self.scene, wrong.join(", "), show.unwrap_or_default())))
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.scene)?;
        writeln!(f, "  {}, {}", counted(self.triangles, "triangle"), counted(self.quadrics, "quadric"))?;
        writeln!(f)?;
        writeln!(
            f,
            "  {:<11} {:>10} {:>10} {:>12} {:>11}",
            "class", "rays", "hits", "brute force", "mismatches"
        )?;
        for ClassRow { class, rays, hits, brute_force, mismatches } in &self.classes {
            let [rays, hits, brute, mismatches] = [*rays, *hits, *brute_force, *mismatches].map(grouped);
            writeln!(f, "  {class:<11} {rays:>10} {hits:>10} {brute:>12} {mismatches:>11}")?;
        }
        if let Some(LeakRow { edges, vertices, rays, leaks }) = self.leaks {
            writeln!(
                f,
                "\n  leaks        {} of {} at {} and {} that triangles share",
                grouped(leaks),
                counted(rays, "ray"),
                counted(edges, "edge"),
                if vertices == 1 { "1 vertex".into() } else { format!("{} vertices", grouped(vertices)) }
            )?;
        }
        if let Some(SelfHitRow { rays, self_hits }) = self.self_hits {
            writeln!(
                f,
                "  self-hits    {} of {} that left a triangle",
                grouped(self_hits),
                counted(rays, "ray")
            )?;
        }
        if let Some(against) = &self.against {
            write!(f, "{against}")?;
        }
        if let Some(unexpected) = self.unexpected {
            writeln!(f, "  unexpected   {}", grouped(unexpected))?;
        }
        if let Some(failure) = &self.failure {
            writeln!(
                f,
                "\n  {}: {} and {} show it:\n  {}",
                failure.what,
                counted(failure.triangles as u64, "triangle"),
                counted(failure.rays as u64, "ray"),
                failure.command
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings() -> Findings {
        let mut findings = Findings::new("a.xml".into(), Summary { triangles: 2, ..Summary::default() });
        let compared = Comparison { rays: 1234, hits: 5, brute_force: 6, ..Comparison::default() };
        findings.classes.push(ClassRow::new("primary", &compared));
        findings.leaks = Some(LeakRow { edges: 1, vertices: 0, rays: 9, leaks: 0 });
        findings.self_hits = Some(SelfHitRow { rays: 20, self_hits: 0 });
        findings
    }

    #[test]
    fn the_table_and_json_hold_what_was_found() {
        let text = findings().to_string();
        for part in ["1,234", "0 of 9 rays at 1 edge and 0 vertices", "0 of 20 rays that left a triangle"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        let json = serde_json::to_value(findings()).unwrap();
        assert_eq!(json["classes"][0]["mismatches"], 0);
        assert_eq!(json["leaks"]["leaks"], 0);
    }

    #[test]
    fn any_fault_is_a_failure() {
        assert!(findings().verdict().is_ok());
        let faults: [fn(&mut Findings); 4] = [
            |findings| findings.classes[0].mismatches = 1,
            |findings| findings.leaks = Some(LeakRow { edges: 1, vertices: 1, rays: 1, leaks: 1 }),
            |findings| findings.self_hits = Some(SelfHitRow { rays: 1, self_hits: 1 }),
            |findings| findings.unexpected = Some(1),
        ];
        for fault in faults {
            let mut findings = findings();
            fault(&mut findings);
            assert!(findings.verdict().is_err(), "{findings}");
        }
    }
}
