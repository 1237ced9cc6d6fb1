//! Which rays may find a light by chance.
//!
//! A path's last ray carries nothing but what a light sends along it. What such a ray hits lies within the slabs
//! of the surface's box, and a box that holds that one never has the smaller interval: a ray that misses
//! the boxes of all lights need not be traced, and no picture shows whether it was.

use super::Light;
use crate::geometry::{Aabb, aabb::interval};
use crate::simd::{Mask, Real, Vector3};

/// More boxes than this are put into one.
const MOST: usize = 8;

/// Where lights are.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    /// Some light is seen by whatever leaves the scene.
    everywhere: bool,
    boxes: Vec<Aabb>,
}

impl Sight {
    /// Of these lights.
    pub fn new(lights: &[Light]) -> Self {
        let bounds = |light: &Light| match light {
            Light::Area(area) => Some(area.bounds),
            _ => None,
        };
        let mut boxes: Vec<Aabb> = lights.iter().filter_map(bounds).collect();
        if boxes.len() > MOST {
            boxes = vec![boxes.into_iter().fold(Aabb::EMPTY, Aabb::union)];
        }
        Self { everywhere: lights.iter().any(Light::is_environment), boxes }
    }

    /// Which rays (org, dir), from t = 0 on, may find one; false is certain.
    #[inline]
    pub fn may_find<R: Real>(&self, (org, dir): (Vector3<R>, Vector3<R>)) -> R::Mask {
        if self.everywhere {
            return R::Mask::splat(true);
        }
        let rdir = dir.map(|d| R::one() / d);
        let range = (R::zero(), R::splat(f32::INFINITY));
        self.boxes.iter().fold(R::Mask::splat(false), |found, bounds| {
            let planes = (Vector3::splat(bounds.min), Vector3::splat(bounds.max));
            let (low, high) = interval(planes, (org, rdir), range);
            found | !high.lt(low)
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Sphere;
    use crate::light::{AreaLight, Emitting};
    use crate::simd::{Vec3x8, f32x8};

    fn lamp(center: Vec3) -> Light {
        let sphere = Sphere { center, radius: 1.0 };
        Light::Area(AreaLight {
            radiance: Vec3::ONE,
            shape: Emitting::Sphere(sphere),
            side: 1.0,
            extent: Vec3::ONE,
            bounds: sphere.bounds(),
        })
    }

    #[test]
    fn rays_at_a_light_may_find_it_and_others_do_not() {
        let sight = Sight::new(&[lamp(Vec3::ZERO), lamp(10.0 * Vec3::X)]);
        let from = |x: f32, dir: Vec3| sight.may_find::<f32>((Vec3::new(x, 0.0, 5.0).into(), dir.into()));
        assert!(from(0.0, -Vec3::Z) && from(10.5, -Vec3::Z));
        assert!(!from(5.0, -Vec3::Z) && !from(0.0, Vec3::Z));
        let dirs = Vec3x8::from_fn(|i| Vec3::new((i as f32 - 3.5) * 0.2, 0.0, -1.0));
        let eight = sight.may_find((Vec3x8::splat(5.0 * Vec3::Z), dirs));
        for i in 0..8 {
            assert_eq!(eight.lane(i), from(0.0, dirs.lane(i)), "{i}");
        }
    }

    #[test]
    fn many_lights_are_one_box_and_a_sky_is_everywhere() {
        let many: Vec<Light> = (0..=MOST).map(|i| lamp(i as f32 * 10.0 * Vec3::X)).collect();
        let between = (Vec3::new(5.0, 0.0, 5.0).into(), (-Vec3::Z).into());
        assert!(Sight::new(&many).may_find::<f32>(between));
        assert!(!Sight::new(&many[1..]).may_find::<f32>(between));
        let sky = Light::Constant { radiance: Vec3::ONE };
        let up = (Vec3x8::splat(Vec3::ZERO), Vec3x8::splat(Vec3::Y));
        assert!(Sight::new(&[sky]).may_find::<f32x8>(up).all());
        assert!(Sight::new(&[]).may_find::<f32x8>(up).none());
    }
}
