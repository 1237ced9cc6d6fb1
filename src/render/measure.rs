//! A class of rays through a scene, timed or counted.
//!
//! Timed is the way from the array of rays to the array of results and nothing else, on the current rayon
//! pool. Counting is not timed. Both hand out the rays in the same chunks, so what is counted is what was
//! timed, however many threads there are.

use std::{
    cell::RefCell,
    ops::AddAssign,
    time::{Duration, Instant},
};

use rayon::prelude::*;

use crate::{
    bvh::{Tally, Tracer, Traversal, Way},
    compile::Scene,
    geometry::{Hit, PrimitiveId, Ray32},
    simd::LANES,
};

use super::{Query, RayClass};

/// Rays that a thread takes at a time.
const CHUNK: usize = 4096;

/// Results of the rays and the best time.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Rays that hit, or are blocked.
    pub hits: u64,
    /// Sum of the hits' t, in lengths of their rays' directions, in the order of the rays; 0 for any-hit.
    pub t_sum: f64,
    /// Wall time of the best of the runs after the warm-up.
    pub best: Duration,
}

/// What a traversal did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Nodes that rays were tested against, summed over rays.
    pub nodes: u64,
    /// Primitives likewise.
    pub primitives: u64,
    /// Tests of either that were run, however many rays took part.
    pub tests: u64,
}

impl Counts {
    /// The share of lanes that took part, if each test was eight wide.
    pub fn lane_use(&self) -> f64 {
        let lanes = self.tests * LANES as u64;
        if lanes == 0 { 0.0 } else { (self.nodes + self.primitives) as f64 / lanes as f64 }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.primitives += other.primitives;
        self.tests += other.tests;
    }
}

impl Tally for Counts {
    fn node(&mut self, rays: u32) {
        self.nodes += u64::from(rays);
        self.tests += u64::from(rays.div_ceil(8));
    }

    fn leaf(&mut self, primitives: u32, rays: u32) {
        self.primitives += u64::from(primitives) * u64::from(rays);
        self.tests += u64::from(primitives) * u64::from(rays.div_ceil(8));
    }
}

/// Times the fast way: the best of `repeat` runs after a warm-up.
pub fn packets(scene: &Scene, class: &RayClass, repeat: u32) -> Timed {
    packets_by(scene, class, Way::Chosen, repeat)
}

/// [`packets`] by a way of the caller's choice.
pub fn packets_by(scene: &Scene, class: &RayClass, way: Way, repeat: u32) -> Timed {
    thread_local! {
        static TRACER: RefCell<Tracer> = RefCell::new(Tracer::new(()));
    }
    match class.query {
        Query::Closest => closest(class, repeat, |rays, hits| {
            TRACER.with_borrow_mut(|tracer| scene.closest_hits_by(rays, hits, way, tracer));
        }),
        Query::Any => any(class, repeat, |rays, blocked| {
            TRACER.with_borrow_mut(|tracer| scene.occluded_stream_by(rays, blocked, way, tracer));
        }),
    }
}

/// Times one ray at a time, from the scalar kernels.
pub fn singles(scene: &Scene, class: &RayClass, repeat: u32) -> Timed {
    match class.query {
        Query::Closest => closest(class, repeat, |rays, hits| {
            let mut traversal = Traversal::new(());
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = scene.closest_hit(&ray.ray(), &mut traversal);
            }
        }),
        Query::Any => any(class, repeat, |rays, blocked| {
            let mut traversal = Traversal::new(());
            for (ray, blocked) in rays.iter().zip(blocked) {
                *blocked = u8::from(scene.occluded(&ray.ray(), &mut traversal));
            }
        }),
    }
}

/// Counts what a way through the tree does; [`Way::Chosen`] is what [`packets`] times.
pub fn count_packets(scene: &Scene, class: &RayClass, way: Way) -> Counts {
    count(class, |rays, tracer| match class.query {
        Query::Closest => scene.closest_hits_by(rays, &mut vec![Hit::MISS; rays.len()], way, tracer),
        Query::Any => scene.occluded_stream_by(rays, &mut vec![0; rays.len()], way, tracer),
    })
}

/// Counts what single rays do.
pub fn count_singles(scene: &Scene, class: &RayClass) -> Counts {
    count(class, |rays, tracer| {
        let traversal = &mut tracer.traversal;
        for ray in rays {
            match class.query {
                Query::Closest => drop(scene.closest_hit(&ray.ray(), traversal)),
                Query::Any => drop(scene.occluded(&ray.ray(), traversal)),
            }
        }
    })
}

fn count(class: &RayClass, trace: impl Fn(&[Ray32], &mut Tracer<Counts>) + Sync) -> Counts {
    let chunk = |rays: &[Ray32]| {
        let mut tracer = Tracer::new(Counts::default());
        trace(rays, &mut tracer);
        tracer.traversal.tally
    };
    let add = |mut sum: Counts, chunk| {
        sum += chunk;
        sum
    };
    class.rays.par_chunks(CHUNK).map(chunk).reduce(Counts::default, add)
}

fn closest(class: &RayClass, repeat: u32, trace: impl Fn(&[Ray32], &mut [Hit]) + Sync) -> Timed {
    let (results, best) = timed(&class.rays, Hit::MISS, repeat, trace);
    let found = results.iter().filter(|hit| hit.primitive != PrimitiveId::NONE);
    let (hits, t_sum) = found.fold((0, 0.0), |(hits, sum), hit| (hits + 1, sum + f64::from(hit.t)));
    Timed { hits, t_sum, best }
}

fn any(class: &RayClass, repeat: u32, trace: impl Fn(&[Ray32], &mut [u8]) + Sync) -> Timed {
    let (results, best) = timed(&class.rays, 0, repeat, trace);
    Timed { hits: results.iter().map(|&blocked| u64::from(blocked)).sum(), t_sum: 0.0, best }
}

/// The results, and the best time after a warm-up.
fn timed<T: Copy + Send + Sync>(
    rays: &[Ray32],
    empty: T,
    repeat: u32,
    trace: impl Fn(&[Ray32], &mut [T]) + Sync,
) -> (Vec<T>, Duration) {
    let mut results = vec![empty; rays.len()];
    let mut run = || {
        let start = Instant::now();
        rays.par_chunks(CHUNK)
            .zip(results.par_chunks_mut(CHUNK))
            .for_each(|(rays, results)| trace(rays, results));
        start.elapsed()
    };
    run();
    let best = (0..repeat).map(|_| run()).min().unwrap_or_default();
    (results, best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_those_of_the_tests_that_were_run() {
        let mut counts = Counts::default();
        assert_eq!(counts.lane_use(), 0.0);
        // Three of eight, seven of eight, two of eight: twelve of twenty-four.
        counts.node(3);
        counts.node(7);
        counts += Counts { nodes: 0, primitives: 2, tests: 1 };
        assert_eq!(counts.lane_use(), 0.5);
    }
}
