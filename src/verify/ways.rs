//! One question, asked in every way: the answers are the same to the bit.
//!
//! Single rays, which walk the tree with the scalar kernels, are what the others are compared with. A sample
//! of rays is tested against every primitive, which is the truth that needs no tree.

use glam::Vec3;
use rayon::prelude::*;

use super::{Exhibit, Expected, RUN, reduce::smallest, scene_of};
use crate::bvh::{Tracer, Traversal, Way};
use crate::compile::Scene;
use crate::geometry::{Hit, PrimitiveId, Ray32};
use crate::render::Query;

/// Rays that a thread takes at a time.
const CHUNK: usize = 4096;
/// Trials that making a fault smaller may take, for rays and for triangles.
const TRIALS: usize = 400;

/// How rays are answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// One after the other, by the scalar kernels.
    Single,
    /// As a stream.
    Stream(Way),
    /// Every primitive, without the tree.
    BruteForce,
}

impl By {
    /// All that are compared with single rays on every ray.
    pub const WAYS: [Self; 4] = [
        Self::Stream(Way::Chosen),
        Self::Stream(Way::Tile),
        Self::Stream(Way::Packet),
        Self::Stream(Way::Wave),
    ];

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Stream(Way::Chosen) => "chosen",
            Self::Stream(Way::Tile) => "tile",
            Self::Stream(Way::Packet) => "packet",
            Self::Stream(Way::Wave) => "wave",
            Self::BruteForce => "brute force",
        }
    }
}

/// The bits of t, u, v and the primitive; of an occlusion query 1 or 0, and zeros.
pub type Answer = [u32; 4];

/// Answers of a stream of rays. The crate's own is [`answers`]; a test's may be wrong on purpose.
pub trait Answers: Fn(&Scene, By, Query, &[Ray32]) -> Vec<Answer> + Sync {}
impl<F: Fn(&Scene, By, Query, &[Ray32]) -> Vec<Answer> + Sync> Answers for F {}

/// What was compared.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// Rays, each asked for its nearest hit and whether it is blocked.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
    /// Rays that were tested against every primitive.
    pub brute_force: u64,
    /// Answers that differ from those of single rays.
    pub mismatches: u64,
    /// The first of them.
    pub exhibit: Option<Exhibit>,
}

/// Asks a stream of rays one question.
pub fn answers(scene: &Scene, by: By, query: Query, rays: &[Ray32]) -> Vec<Answer> {
    let of_hit = |hit: Hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive.0];
    let of_blocked = |blocked: bool| [u32::from(blocked), 0, 0, 0];
    let mut traversal = Traversal::new(());
    match (by, query) {
        (By::Single, Query::Closest) => {
            rays.iter().map(|ray| of_hit(scene.closest_hit(&ray.ray(), &mut traversal))).collect()
        }
        (By::Single, Query::Any) => {
            rays.iter().map(|ray| of_blocked(scene.occluded(&ray.ray(), &mut traversal))).collect()
        }
        (By::Stream(way), Query::Closest) => {
            let mut hits = vec![Hit::MISS; rays.len()];
            scene.closest_hits_by(rays, &mut hits, way, &mut Tracer::new(()));
            hits.into_iter().map(of_hit).collect()
        }
        (By::Stream(way), Query::Any) => {
            let mut blocked = vec![0; rays.len()];
            scene.occluded_stream_by(rays, &mut blocked, way, &mut Tracer::new(()));
            blocked.into_iter().map(|blocked| of_blocked(blocked != 0)).collect()
        }
        (By::BruteForce, Query::Closest) => {
            rays.iter().map(|ray| of_hit(scene.brute_force(&ray.ray()))).collect()
        }
        (By::BruteForce, Query::Any) => {
            let blocked = |ray: &Ray32| scene.brute_force(&ray.ray()).primitive != PrimitiveId::NONE;
            rays.iter().map(|ray| of_blocked(blocked(ray))).collect()
        }
    }
}

/// How many rays do not find what they should, by single rays.
pub fn found(scene: &Scene, rays: &[Ray32], expected: Expected) -> u64 {
    let blocked = answers(scene, By::Single, Query::Any, rays);
    let should = u32::from(expected == Expected::Hit);
    blocked.iter().map(|answer| u64::from(answer[0] != should)).sum()
}

/// Compares all ways on all rays, and brute force on as many as `brute_tests` tests allow.
pub fn compare(scene: &Scene, rays: &[Ray32], brute_tests: u64, answers: &impl Answers) -> Comparison {
    let summary = scene.summary();
    let primitives = (summary.triangles + summary.quadrics + summary.placed).max(1);
    let every = (rays.len() as u64 * primitives).div_ceil(brute_tests.max(1)).max(1) as usize;
    let one = |(index, chunk): (usize, &[Ray32])| {
        let first = index * CHUNK;
        let sample: Vec<usize> = (0..chunk.len()).filter(|i| (first + i).is_multiple_of(every)).collect();
        compare_chunk(scene, chunk, &sample, answers)
    };
    let add = |mut sum: Comparison, next: Comparison| {
        sum.rays += next.rays;
        sum.hits += next.hits;
        sum.brute_force += next.brute_force;
        sum.mismatches += next.mismatches;
        sum.exhibit = sum.exhibit.or(next.exhibit);
        sum
    };
    let each: Vec<Comparison> = rays.par_chunks(CHUNK).enumerate().map(one).collect();
    each.into_iter().fold(Comparison::default(), add)
}

fn compare_chunk(scene: &Scene, rays: &[Ray32], sample: &[usize], answers: &impl Answers) -> Comparison {
    let mut found =
        Comparison { rays: rays.len() as u64, brute_force: sample.len() as u64, ..Comparison::default() };
    let every: Vec<usize> = (0..rays.len()).collect();
    for query in [Query::Closest, Query::Any] {
        let want = answers(scene, By::Single, query, rays);
        if query == Query::Any {
            found.hits = want.iter().map(|answer| u64::from(answer[0])).sum();
        }
        for by in By::WAYS.into_iter().chain([By::BruteForce]) {
            let which = if by == By::BruteForce { sample } else { &every };
            let asked: Vec<Ray32> = which.iter().map(|&i| rays[i]).collect();
            let got = answers(scene, by, query, &asked);
            let differ = |&(place, &i): &(usize, &usize)| got[place] != want[i];
            let mut wrong = which.iter().enumerate().filter(differ);
            if let Some((place, _)) = wrong.next() {
                found.mismatches += 1 + wrong.count() as u64;
                let fault = Fault { by, query, answers };
                found.exhibit.get_or_insert_with(|| fault.exhibit(scene, &asked, place));
            }
        }
    }
    found
}

/// A way that does not agree.
struct Fault<'a, A> {
    by: By,
    query: Query,
    answers: &'a A,
}

impl<A: Answers> Fault<'_, A> {
    fn shows(&self, scene: &Scene, rays: &[Ray32]) -> bool {
        let ask = |by| (self.answers)(scene, by, self.query, rays);
        ask(self.by) != ask(By::Single)
    }

    /// As few rays as show it, then as few triangles. What rays before it have taught the tree may be part of
    /// the fault: if the ray's own run does not show it, all rays up to it are kept.
    fn exhibit(&self, scene: &Scene, rays: &[Ray32], place: usize) -> Exhibit {
        let run = &rays[place / RUN * RUN..rays.len().min((place / RUN + 1) * RUN)];
        let few = if self.shows(scene, run) { run } else { rays };
        let few = smallest(few.to_vec(), TRIALS, |rays| self.shows(scene, rays));
        let scene_shows =
            |triangles: &[[Vec3; 3]]| scene_of(triangles).is_some_and(|scene| self.shows(&scene, &few));
        let all = (0..scene.primitive_count()).filter_map(|i| scene.triangle(PrimitiveId(i)));
        let all: Vec<_> = all.collect();
        let triangles = if scene_shows(&all) { smallest(all, TRIALS, scene_shows) } else { Vec::new() };
        let asked = match self.query {
            Query::Closest => "the nearest hit",
            Query::Any => "whether the ray is blocked",
        };
        let what = format!("{} and single rays differ about {asked}", self.by.name());
        Exhibit { what, triangles, rays: few, expected: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::aim::{Random, rays_at};

    fn triangles() -> Vec<[Vec3; 3]> {
        let mut random = Random::new(5);
        let mut triangle = || {
            let v = random.vector();
            [v, v + random.vector() * 0.3, v + random.vector() * 0.3]
        };
        (0..300).map(|_| triangle()).collect()
    }

    fn rays() -> Vec<Ray32> {
        let aimed = rays_at(&triangles(), 200, &mut Random::new(3));
        aimed.iter().map(|ray| Ray32::new(ray.org, ray.dir, ray.t_near, ray.t_far)).collect()
    }

    #[test]
    fn the_ways_agree() {
        let scene = scene_of(&triangles()).unwrap();
        let Comparison { rays, hits, brute_force, mismatches, exhibit } =
            compare(&scene, &self::rays(), 300 * 500, &answers);
        assert_eq!((mismatches, exhibit), (0, None));
        assert!(
            rays > 3800 && hits > 500 && (400..600).contains(&brute_force),
            "{rays} {hits} {brute_force}"
        );
    }

    /// The triangles, so much larger, and a scene of them.
    fn scaled(scale: f32) -> (Vec<[Vec3; 3]>, Scene) {
        let triangles: Vec<_> = triangles().into_iter().map(|corners| corners.map(|v| v * scale)).collect();
        let scene = scene_of(&triangles).unwrap();
        (triangles, scene)
    }

    /// A point of a triangle.
    fn point_of([a, b, c]: [Vec3; 3], random: &mut Random) -> Vec3 {
        let (s, t) = (random.unit(), random.unit());
        a + (b - a) * (s * (1.0 - t)) + (c - a) * (s * t)
    }

    /// From farther away than scenes may reach, along directions that are short, long, or of one component that is hardly
    /// there: products and reciprocals overflow, and vanish.
    #[test]
    fn the_ways_agree_at_the_ends_of_the_floats() {
        let mut random = Random::new(9);
        let mut hits = 0;
        for scale in [1.0, 1e6, 1e12, 1e15, 3e17] {
            let (triangles, scene) = scaled(scale);
            for away in [1.0, 1e3, 1e8, 1e20] {
                for length in [1e-44, 1e-40, 1e-38, 1e-30, 1e-20, 1e20, 1e26, 1e30, 1e38] {
                    let org = random.vector() * (scale * away);
                    let towards = triangles[random.below(triangles.len())];
                    // Two tiles from one point, of which the second spreads more.
                    let rays: Vec<Ray32> = (0..256)
                        .map(|i| {
                            let target = point_of(towards, &mut random);
                            let target = target + random.vector() * (scale * [0.0, 0.1][i / 128]);
                            let dir = (target - org) / (target - org).abs().max_element();
                            Ray32::new(org, dir * length, 0.0, f32::INFINITY)
                        })
                        .filter(Ray32::is_valid)
                        .collect();
                    let found = compare(&scene, &rays, u64::MAX, &answers);
                    assert_eq!(found.mismatches, 0, "{scale} {away} {length}: {:?}", found.exhibit);
                    hits += found.hits;
                }
            }
        }
        assert!(hits > 10_000, "{hits}");
    }

    /// Just so far as the triangle they hit, where a distance has so few bits that each operation may lose one.
    #[test]
    fn the_ways_agree_where_distances_vanish() {
        let mut random = Random::new(21);
        let mut hits = 0;
        for (scale, length) in [(1e-3, 3e38), (1e-6, 1e38), (1e-9, 1e34), (1e-20, 1e24)] {
            let (triangles, scene) = scaled(scale);
            // Few at a time: no neighbour's segment makes up for what is lost of one.
            for count in [1, 2, 40].into_iter().cycle().take(300) {
                let org = random.vector() * scale;
                let towards = triangles[random.below(triangles.len())];
                let rays: Vec<Ray32> = (0..count)
                    .map(|_| {
                        let dir = (point_of(towards, &mut random) - org) / scale;
                        let ray = Ray32::new(org, dir / dir.abs().max_element() * length, 0.0, f32::INFINITY);
                        let t_far = scene.closest_hit(&ray.ray(), &mut Traversal::new(())).t;
                        Ray32 { t_far, ..ray }
                    })
                    .filter(Ray32::is_valid)
                    .collect();
                let found = compare(&scene, &rays, u64::MAX, &answers);
                assert_eq!(found.mismatches, 0, "{scale} {length}: {:?}", found.exhibit);
                hits += found.hits;
            }
        }
        assert!(hits > 10_000, "{hits}");
    }

    /// Numerators that are finite and a determinant that is not: t is 0, or where the triangle's box begins.
    #[test]
    fn the_ways_agree_where_determinants_overflow() {
        let mut random = Random::new(31);
        let mut hits = 0;
        for length in [1e37, 3e37, 6e37, 1e38, 1.5e38].into_iter().cycle().take(200) {
            let mut triangle = || {
                let v = random.vector();
                [v, v + random.vector() * 3.0, v + random.vector() * 3.0]
            };
            let scene = scene_of(&[(); 8].map(|()| triangle())).unwrap();
            for _ in 0..200 {
                let (org, dir) = (random.vector(), random.vector());
                let ray = Ray32::new(org, dir / dir.abs().max_element() * length, 0.0, f32::INFINITY);
                // Alone: where a neighbour is in doubt, both are asked about with more care.
                let found = compare(&scene, &[ray], u64::MAX, &answers);
                assert_eq!(found.mismatches, 0, "{length}: {:?}", found.exhibit);
                hits += found.hits;
            }
        }
        assert!(hits > 5000, "{hits}");
    }

    /// Of a tile, all rays but one hit a wall nearby; that one begins behind it and sees another. Whichever bundle it is put
    /// into, each has its turn.
    #[test]
    fn the_ways_agree_where_one_ray_of_a_tile_sees_farther() {
        let corner = |i: usize, z: f32| Vec3::new((i % 17) as f32, (i / 17) as f32, 16.0) * (z / 16.0);
        let wall = |z: f32| {
            (0..16 * 17).filter(|i| i % 17 < 16).flat_map(move |i| {
                let [a, b, c, d] = [i, i + 1, i + 18, i + 17].map(|i| corner(i, z));
                [[a, b, c], [a, c, d]]
            })
        };
        let scene = scene_of(&wall(1.0).chain(wall(100.0)).collect::<Vec<_>>()).unwrap();
        let ray = |i: usize, t_near: f32| {
            let at = |i: usize| (i as f32 + 0.4) / 16.0;
            Ray32::new(Vec3::ZERO, Vec3::new(at(i % 16), at(i / 16), 1.0), t_near, f32::INFINITY)
        };
        for which in 0..256 {
            let rays: Vec<Ray32> = (0..256).map(|i| ray(i, if i == which { 2.0 } else { 0.0 })).collect();
            let far = scene.closest_hit(&rays[which].ray(), &mut Traversal::new(())).t;
            assert!((99.0..101.0).contains(&far), "{which}: {far}");
            let found = compare(&scene, &rays, 1, &answers);
            assert_eq!((found.mismatches, found.hits), (0, 256), "{which}: {:?}", found.exhibit);
        }
    }

    /// A wave that does not see one triangle, wherever it is in the scene.
    #[test]
    fn a_fault_is_found_and_made_small() {
        let (all, rays) = (triangles(), rays());
        let scene = scene_of(&all).unwrap();
        let blind = |scene: &Scene, by: By, query: Query, rays: &[Ray32]| -> Vec<Answer> {
            let mut answers = answers(scene, by, query, rays);
            if by == By::Stream(Way::Wave) && query == Query::Closest {
                let lost = |id: u32| scene.triangle(PrimitiveId(id)) == Some(all[7]);
                let miss = Hit::MISS;
                let miss = [miss.t, miss.u, miss.v].map(f32::to_bits);
                for answer in answers.iter_mut().filter(|a| a[3] != u32::MAX && lost(a[3])) {
                    *answer = [miss[0], miss[1], miss[2], u32::MAX];
                }
            }
            answers
        };
        let found = compare(&scene, &rays, 0, &blind);
        assert!(found.mismatches > 0);
        let exhibit = found.exhibit.expect("something to show");
        assert_eq!(exhibit.triangles, [all[7]]);
        assert_eq!(exhibit.rays.len(), 1);
        assert!(exhibit.what.starts_with("wave"), "{}", exhibit.what);
    }
}
