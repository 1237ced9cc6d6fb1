//! Pixels to rays.
//!
//! Camera space looks along +z, +y is up and +x is to the **left** of the picture. A pixel position
//! (px, py) runs over [0, width) × [0, height), row 0 at the top.

use glam::{DAffine3, DVec3, Vec3};

use crate::geometry::RayLanes;
use crate::math::warp;
use crate::simd::{Real, Vector3};

/// A pinhole, a thin lens, or parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// World position of camera space's origin.
    origin: Vec3,
    /// World images of camera space's axes.
    axes: [Vec3; 3],
    /// Half width and half height of the film at z = 1.
    half: (f32, f32),
    /// Columns and rows.
    size: (f32, f32),
    near: f32,
    far: f32,
    projection: Projection,
}

/// Where rays come from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Projection {
    Pinhole,
    /// A disc about the origin, across the axis, that images the plane z = `focus` sharply.
    Lens {
        radius: f32,
        focus: f32,
    },
    Parallel,
}

impl Camera {
    /// A pinhole camera whose picture's width spans the angle with this tangent of its half.
    pub fn perspective(to_world: DAffine3, tan_half: f64, size: (u32, u32), clip: (f64, f64)) -> Self {
        Self::new(to_world, tan_half, size, clip, Projection::Pinhole)
    }

    /// A thin lens, whose picture's width spans the angle with this tangent of its half as seen from
    /// its centre. `lens` is the radius of the aperture and the distance of the plane in focus, both
    /// positive: all rays of a pixel position meet in that plane \[CPC84\].
    pub fn thin_lens(
        to_world: DAffine3,
        tan_half: f64,
        size: (u32, u32),
        clip: (f64, f64),
        lens: (f64, f64),
    ) -> Self {
        let lens = Projection::Lens { radius: lens.0 as f32, focus: lens.1 as f32 };
        Self::new(to_world, tan_half, size, clip, lens)
    }

    /// Parallel rays; the picture's width spans camera x in [-1, 1].
    pub fn orthographic(to_world: DAffine3, size: (u32, u32), clip: (f64, f64)) -> Self {
        Self::new(to_world, 1.0, size, clip, Projection::Parallel)
    }

    fn new(
        to_world: DAffine3,
        half: f64,
        size: (u32, u32),
        clip: (f64, f64),
        projection: Projection,
    ) -> Self {
        let m = to_world.matrix3;
        let aspect = f64::from(size.1) / f64::from(size.0);
        Self {
            origin: to_world.translation.as_vec3(),
            axes: [m.x_axis, m.y_axis, m.z_axis].map(DVec3::as_vec3),
            half: (half as f32, (half * aspect) as f32),
            size: (size.0 as f32, size.1 as f32),
            near: clip.0 as f32,
            far: clip.1 as f32,
            projection,
        }
    }

    /// The rays through these pixel positions: unit directions, origins on the near plane, ends on the
    /// far plane. `lens` is asked for the two random numbers that choose a point of the lens, if there is
    /// one; a point is worth the same wherever it lies, so radiance arrives unchanged.
    #[inline]
    pub fn rays<R: Real>(&self, px: R, py: R, lens: impl FnOnce() -> (R, R)) -> RayLanes<R> {
        let two = R::splat(2.0);
        let x = (R::one() - px * two / R::splat(self.size.0)) * R::splat(self.half.0);
        let y = (R::one() - py * two / R::splat(self.size.1)) * R::splat(self.half.1);
        let [ax, ay, az] = self.axes.map(Vector3::splat);
        let across = ax.scale(x) + ay.scale(y);
        let origin = Vector3::splat(self.origin);
        let (near, far) = (R::splat(self.near), R::splat(self.far));
        match self.projection {
            Projection::Parallel => {
                RayLanes::new(origin + across + az.scale(near), az.normalize(), R::zero(), far - near)
            }
            Projection::Pinhole => {
                // The axis grows by this much from the plane at distance 1 to the unit direction.
                let slant = (x * x + y * y + R::one()).sqrt();
                let dir = (across + az).normalize();
                RayLanes::new(origin + dir.scale(near * slant), dir, R::zero(), (far - near) * slant)
            }
            Projection::Lens { radius, focus } => {
                let (u, v) = lens();
                let (disk_x, disk_y) = warp::disk(u, v);
                let (lens_x, lens_y) = (disk_x * R::splat(radius), disk_y * R::splat(radius));
                // Slopes of the line from the point of the lens to the point in focus.
                let (dx, dy) = (x - lens_x / R::splat(focus), y - lens_y / R::splat(focus));
                let slant = (dx * dx + dy * dy + R::one()).sqrt();
                let dir = (ax.scale(dx) + ay.scale(dy) + az).normalize();
                let start = origin + ax.scale(lens_x) + ay.scale(lens_y);
                RayLanes::new(start + dir.scale(near * slant), dir, R::zero(), (far - near) * slant)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn no_lens() -> (f32, f32) {
        panic!("there is no lens")
    }

    fn camera(orthographic: bool) -> Camera {
        let to_world = DAffine3::IDENTITY;
        if orthographic {
            Camera::orthographic(to_world, (4, 2), (0.5, 10.0))
        } else {
            Camera::perspective(to_world, 1.0, (4, 2), (0.5, 10.0))
        }
    }

    #[test]
    fn left_of_the_picture_is_plus_x_and_its_top_is_plus_y() {
        let corner = camera(false).rays::<f32>(0.0, 0.0, no_lens);
        let want = Vec3::new(1.0, 0.5, 1.0).normalize();
        assert!((Vec3::from(corner.dir) - want).length() < 1e-6);
        assert!((Vec3::from(corner.org) - Vec3::new(0.5, 0.25, 0.5)).length() < 1e-6);
        let end = Vec3::from(corner.org) + Vec3::from(corner.dir) * corner.t_far;
        assert!((end - Vec3::new(10.0, 5.0, 10.0)).length() < 1e-5, "{end}");
    }

    #[test]
    fn orthographic_rays_are_parallel_and_span_two_units() {
        let [left, right] = [0.0f32, 4.0].map(|px| camera(true).rays(px, 1.0, no_lens));
        assert_eq!(Vec3::from(left.org), Vec3::new(1.0, 0.0, 0.5));
        assert_eq!(Vec3::from(right.org), Vec3::new(-1.0, 0.0, 0.5));
        assert_eq!(Vec3::from(left.dir), Vec3::Z);
        assert_eq!(left.t_far, 9.5);
    }

    const RADIUS: f32 = 0.25;
    const FOCUS: f32 = 4.0;

    fn lens() -> Camera {
        let lens = (f64::from(RADIUS), f64::from(FOCUS));
        Camera::thin_lens(DAffine3::IDENTITY, 1.0, (4, 2), (0.5, 10.0), lens)
    }

    #[test]
    fn rays_of_a_pixel_meet_in_the_plane_in_focus_and_nowhere_else() {
        let pinhole = camera(false).rays::<f32>(0.75, 1.5, no_lens);
        let at = |ray: &RayLanes<f32>, z: f32| {
            let (org, dir) = (Vec3::from(ray.org), Vec3::from(ray.dir));
            org + dir * ((z - org.z) / dir.z)
        };
        for (u, v) in [(0.1, 0.2), (0.9, 0.4), (0.5, 0.5), (0.0, 0.999)] {
            let ray = lens().rays::<f32>(0.75, 1.5, || (u, v));
            assert!((at(&ray, FOCUS) - at(&pinhole, FOCUS)).length() < 1e-6, "{u} {v}");
            let (x, y) = warp::disk(u, v);
            assert!((at(&ray, 0.0) - Vec3::new(x, y, 0.0) * RADIUS).length() < 1e-6, "{u} {v}");
            assert!((Vec3::from(ray.org).z - 0.5).abs() < 1e-6);
            let end = Vec3::from(ray.org) + Vec3::from(ray.dir) * ray.t_far;
            assert!((end.z - 10.0).abs() < 1e-5);
        }
    }

    #[test]
    fn lanes_have_the_scalar_bits() {
        let numbers = |i: usize| [0.4, 1.1, 0.3, 0.8].map(|step| (i as f32 * step) % 1.0);
        let lane = |k: usize| f32x8::from_fn(|i| numbers(i)[k]);
        for camera in [camera(false), camera(true), lens()] {
            let eight = camera.rays(lane(0), lane(1), || (lane(2), lane(3)));
            for i in 0..8 {
                let [px, py, u, v] = numbers(i);
                let one = camera.rays(px, py, || (u, v));
                let bits = |v: Vec3| v.to_array().map(f32::to_bits);
                assert_eq!(bits(eight.lane(i).org), bits(one.lane(0).org));
                assert_eq!(bits(eight.lane(i).dir), bits(one.lane(0).dir));
                assert_eq!(eight.t_far.lane(i).to_bits(), one.t_far.to_bits());
            }
        }
    }
}
