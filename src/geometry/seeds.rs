//! What the tests of the kernels have in common: seeds expanded to every lane, under masks, in both
//! uses of the lanes, and random ones after them.

use std::fmt::Debug;

use glam::Vec3;

use super::{Aabb, Ray, RayLanes, Rayx8};
use crate::simd::{Mask, Mask8, Real, Vector3, f32x8};

/// A repeatable sequence.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub(crate) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (self.0 ^ self.0 >> 22) >> (22 + (self.0 >> 61));
        x as u32
    }

    pub(crate) fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }

    /// In [−1, 1).
    pub(crate) fn signed(&mut self) -> f32 {
        (self.bits() >> 8) as f32 * (2.0 / 16_777_216.0) - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Integers from −3 to 3, and −0: coincidences are the point.
    pub(crate) fn grid(&mut self) -> Vec3 {
        let mut coordinate = || [-3.0, -2.0, -1.0, -0.0, 0.0, 1.0, 2.0, 3.0][self.below(8) as usize];
        Vec3::new(coordinate(), coordinate(), coordinate())
    }

    /// Grid points, but never the null vector.
    pub(crate) fn grid_direction(&mut self) -> Vec3 {
        loop {
            let d = self.grid();
            if d != Vec3::ZERO {
                return d;
            }
        }
    }
}

/// A surface with a scalar kernel and a kernel in lanes.
pub(super) trait Kernel: Copy + Debug {
    fn bounds(&self) -> Aabb;
    /// (t, u, v), or (t, 0, 0).
    fn scalar(&self, ray: &Ray) -> Option<[f32; 3]>;
    /// Lane `i` of the rays against `surfaces[i]`; `None` if the kernel has no such use.
    fn lanes(surfaces: &[Self; 8], rays: &Rayx8, active: Mask8) -> Option<(Mask8, [f32x8; 3])>;
}

pub(crate) fn packet(rays: &[Ray; 8]) -> Rayx8 {
    RayLanes {
        rdir: Vector3::from_fn(|i| rays[i].rdir),
        ..RayLanes::new(
            Vector3::from_fn(|i| rays[i].org),
            Vector3::from_fn(|i| rays[i].dir),
            f32x8::from_fn(|i| rays[i].t_near),
            f32x8::from_fn(|i| rays[i].t_far),
        )
    }
}

/// The scalar answer, which must be in the ray's range and in the box whatever it is.
fn sound<K: Kernel>(surface: &K, ray: &Ray) -> Option<[f32; 3]> {
    let hit = surface.scalar(ray);
    if let Some([t, ..]) = hit {
        let all = Ray { t_near: f32::NEG_INFINITY, t_far: f32::INFINITY, ..*ray };
        let (low, high) = surface.bounds().interval(&all);
        assert!(ray.t_near < t && t <= ray.t_far, "{t} is out of range: {ray:?} {surface:?}");
        assert!(low <= t && t <= high, "{t} is out of the box, {low} to {high}: {ray:?} {surface:?}");
    }
    hit
}

/// Eight lanes against eight scalars. An inactive lane never hits.
fn compare<K: Kernel>(rays: &[Ray; 8], surfaces: &[K; 8], active: u32) {
    let Some((hit, values)) = K::lanes(surfaces, &packet(rays), Mask8::from_bitmask(active)) else {
        return;
    };
    for lane in 0..8 {
        let want = sound(&surfaces[lane], &rays[lane]).filter(|_| active >> lane & 1 != 0);
        let got = hit.lane(lane).then(|| values.map(|v| v.lane(lane)));
        assert_eq!(
            got.map(|v| v.map(f32::to_bits)),
            want.map(|v| v.map(f32::to_bits)),
            "lane {lane} of {active:08b} gives {got:?}, scalar {want:?}: {:?} {:?}",
            rays[lane],
            surfaces[lane]
        );
    }
}

/// Each with its own, eight rays against the first surface, the first ray against eight surfaces.
fn compare_uses<K: Kernel>(pairs: &[(Ray, K); 8], first: usize, active: u32) {
    let (rays, surfaces) = (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1));
    compare(&rays, &surfaces, active);
    compare(&rays, &[surfaces[first]; 8], active);
    compare(&[rays[first]; 8], &surfaces, active);
}

/// Every seed in every lane, other seeds beside it, under eight kinds of mask.
pub(super) fn in_every_lane<K: Kernel>(seeds: &[(Ray, K)]) {
    let mut random = Random::new(7);
    for seed in 0..seeds.len() {
        for lane in 0..8 {
            let mut pairs = [seeds[seed]; 8];
            for (i, pair) in pairs.iter_mut().enumerate().filter(|&(i, _)| i != lane) {
                *pair = seeds[(seed + 1 + i + random.below(seeds.len() as u32) as usize) % seeds.len()];
            }
            for active in [0xff, 1 << lane, 0xff ^ 1 << lane, 0, 0x55, 0xaa, 0x0f, random.below(256)] {
                compare_uses(&pairs, lane, active);
            }
        }
    }
}

/// `count` rays and surfaces as `next` draws them.
pub(super) fn at_random<K: Kernel>(count: usize, mut next: impl FnMut(&mut Random) -> (Ray, K)) {
    let mut random = Random::new(11);
    for i in 0..count.div_ceil(8) {
        let pairs = std::array::from_fn(|_| next(&mut random));
        compare_uses(&pairs, i % 8, if i % 4 == 0 { random.below(256) } else { 0xff });
    }
}

/// A ray with NaN in any one place hits nothing, alone or in a lane.
pub(super) fn nan_misses<K: Kernel>(ray: Ray, surface: K) {
    assert!(surface.scalar(&ray).is_some(), "the ray itself hits");
    for place in 0..8 {
        let mut broken = ray;
        match place {
            0..3 => broken.org[place] = f32::NAN,
            3..6 => broken.dir[place - 3] = f32::NAN,
            6 => broken.t_near = f32::NAN,
            _ => broken.t_far = f32::NAN,
        }
        let broken = Ray::new(broken.org, broken.dir, broken.t_near, broken.t_far);
        assert_eq!(surface.scalar(&broken), None, "{broken:?}");
        in_every_lane(&[(ray, surface), (broken, surface)]);
    }
}

/// The ray, and others that end or begin at its hit: `t_far` is included, `t_near` is not.
pub(super) fn with_ends<K: Kernel>(seeds: &[(Ray, K)]) -> Vec<(Ray, K)> {
    let mut all = seeds.to_vec();
    for &(ray, surface) in seeds {
        let Some([t, ..]) = surface.scalar(&ray) else { continue };
        let until = |t_far: f32| Ray { t_far, ..ray };
        let from = |t_near: f32| Ray { t_near, ..ray };
        assert_eq!(surface.scalar(&until(t)).map(|hit| hit[0].to_bits()), Some(t.to_bits()), "{ray:?}");
        assert_eq!(surface.scalar(&until(t.next_down())), None, "{ray:?}");
        assert!(surface.scalar(&from(t)).is_none_or(|hit| hit[0] > t), "{ray:?}");
        assert_eq!(
            surface.scalar(&from(t.next_down())).map(|hit| hit[0].to_bits()),
            Some(t.to_bits()),
            "{ray:?}"
        );
        for ray in [
            until(t),
            until(t.next_down()),
            until(t.next_up()),
            from(t),
            from(t.next_down()),
            from(t.next_up()),
        ] {
            all.push((ray, surface));
        }
    }
    all
}
