//! What an integrator is to the two pipelines.
//!
//! An integrator says what one vertex of a path does: what it adds to the picture, which shadow rays it
//! asks for, and which rays go on. It says so once, for any number of lanes; the wavefront calls it with
//! eight and the reference with one. It never sees a queue, a tile or a thread.

use super::aov;
use super::vertex::Vertex;
use crate::compile::Scene;
use crate::math::Sampler;
use crate::simd::{Real, Vector3};

/// Paths in lanes, as they arrive at a vertex or leave the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<R: Real> {
    /// Throughput: what radiance along the ray is worth to the pixel.
    pub(super) beta: Vector3<R>,
    /// Density per solid angle with which the ray was drawn; +∞ from the camera and from mirrors.
    pub(super) pdf: R,
    /// Product of the squared ratios of refraction so far, which Russian roulette takes out of `beta`.
    pub(super) eta2: R,
    /// [`PathKey`](crate::math::PathKey)s.
    pub(super) key: R::Bits,
    /// Vertices before this one; the same for all paths of a round.
    pub(super) depth: u32,
    /// Samples of their pixels.
    pub(super) sample: R::Bits,
}

impl<R: Real> Path<R> {
    /// A path that starts at the camera.
    pub(super) fn start(key: R::Bits, sample: R::Bits) -> Self {
        let (one, infinite) = (R::one(), R::splat(f32::INFINITY));
        Self { beta: Vector3 { x: one, y: one, z: one }, pdf: infinite, eta2: one, key, depth: 0, sample }
    }

    /// Random numbers: the `index`-th of at most `count` pairs that the integrator uses at a vertex.
    #[inline]
    pub(super) fn random(&self, count: u32, index: u32) -> (R, R) {
        let [pair] = self.randoms(count, [index]);
        pair
    }

    /// Several of these pairs, in less time than one after the other.
    #[inline]
    pub(super) fn randoms<const N: usize>(&self, count: u32, indices: [u32; N]) -> [(R, R); N] {
        // Pair 0 is the position in the pixel: `on_film`.
        let pairs = indices.map(|index| 1 + self.depth * count + index);
        Sampler::<R>::new(self.key, self.sample).pairs(pairs)
    }
}

impl<R: Real> Path<R> {
    /// Random numbers for the position in the pixel, or for what stands in its place.
    #[inline]
    pub(super) fn on_film(&self) -> (R, R) {
        Sampler::<R>::new(self.key, self.sample).pair(0)
    }
}

/// (org, dir) of rays.
pub(super) type Line<R> = (Vector3<R>, Vector3<R>);

/// Where a vertex puts what it has to say. `lanes` of a call that are false say nothing.
pub(super) trait Outgoing<R: Real> {
    /// The vertex adds `value` to a channel of the pixel. At most once a channel.
    fn add(&mut self, channel: usize, value: R);

    /// The same for the channels R, G and B, which are the first.
    #[inline]
    fn add_rgb(&mut self, color: Vector3<R>) {
        self.add(0, color.x);
        self.add(1, color.y);
        self.add(2, color.z);
    }

    /// The vertex adds `radiance` if nothing is between `org` and `org + dir·t_far`. `index` numbers the
    /// shadow rays of a vertex from 0.
    fn shadow(
        &mut self,
        index: usize,
        lanes: R::Mask,
        ray: (Vector3<R>, Vector3<R>, R),
        radiance: Vector3<R>,
    );

    /// The path goes on along a ray. `index` numbers the branches from 0.
    fn next(&mut self, index: usize, lanes: R::Mask, ray: (Vector3<R>, Vector3<R>), path: &Path<R>);

    /// Paths in `lanes` would go on, and don't: for those who count.
    #[inline]
    fn end(&mut self, _: End, _: R::Mask) {}
}

/// Why a path ends that light would still follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// It is as long as the integrator allows, or its last ray could find no light.
    Depth,
    /// It lost at Russian roulette.
    Roulette,
}

/// How light is transported, vertex by vertex.
pub(super) trait Integrator: Sync {
    /// Names of the picture's channels.
    fn channels(&self) -> Vec<String> {
        ["R", "G", "B"].map(String::from).to_vec()
    }

    /// [`channels`](Self::channels), and those of the layers beside the picture.
    fn all_channels(&self, scene: &Scene) -> Vec<String> {
        self.channels().into_iter().chain(aov::layers(&scene.aovs)).collect()
    }

    /// Shadow rays of a vertex, at most.
    fn shadow_rays(&self, scene: &Scene) -> usize;

    /// Rays that go on from a vertex, at most.
    fn branches(&self) -> usize {
        1
    }

    /// Do paths begin elsewhere than at the camera, in [`begin`](Self::begin)?
    fn begins(&self) -> bool {
        false
    }

    /// Paths that begin elsewhere, at depth 0.
    fn begin<R: Real>(&self, _: &Scene, _: &Path<R>, _: &mut impl Outgoing<R>) {}

    /// Rays that leave the scene.
    fn miss<R: Real>(&self, scene: &Scene, path: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>);

    /// Rays that have hit something.
    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_drawn_twice_on_a_path() {
        const PAIRS: u32 = 3;
        let mut path = Path::<f32>::start(77, 5);
        let mut seen = vec![path.on_film()];
        for depth in 0..6 {
            path.depth = depth;
            for index in 0..PAIRS {
                let pair = path.random(PAIRS, index);
                assert!(!seen.contains(&pair), "pair {index} at depth {depth}");
                seen.push(pair);
            }
        }
    }
}
