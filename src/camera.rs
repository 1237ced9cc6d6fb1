//! Pixels to rays.
//!
//! Camera space looks along +z, +y is up and +x is to the **left** of the picture. A pixel position
//! (px, py) runs over [0, width) × [0, height), row 0 at the top.

use glam::{DAffine3, DVec3, Vec3};

use crate::geometry::RayLanes;
use crate::simd::{Real, Vector3};

/// A pinhole or orthographic camera.
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
    orthographic: bool,
}

impl Camera {
    /// A pinhole camera whose picture's width spans the angle with this tangent of its half.
    pub fn perspective(to_world: DAffine3, tan_half: f64, size: (u32, u32), clip: (f64, f64)) -> Self {
        Self::new(to_world, tan_half, size, clip, false)
    }

    /// Parallel rays; the picture's width spans camera x in [-1, 1].
    pub fn orthographic(to_world: DAffine3, size: (u32, u32), clip: (f64, f64)) -> Self {
        Self::new(to_world, 1.0, size, clip, true)
    }

    fn new(to_world: DAffine3, half: f64, size: (u32, u32), clip: (f64, f64), orthographic: bool) -> Self {
        let m = to_world.matrix3;
        let aspect = f64::from(size.1) / f64::from(size.0);
        Self {
            origin: to_world.translation.as_vec3(),
            axes: [m.x_axis, m.y_axis, m.z_axis].map(DVec3::as_vec3),
            half: (half as f32, (half * aspect) as f32),
            size: (size.0 as f32, size.1 as f32),
            near: clip.0 as f32,
            far: clip.1 as f32,
            orthographic,
        }
    }

    /// The rays through these pixel positions: unit directions, origins on the near plane, ends on the
    /// far plane.
    #[inline]
    pub fn rays<R: Real>(&self, px: R, py: R) -> RayLanes<R> {
        let two = R::splat(2.0);
        let x = (R::one() - px * two / R::splat(self.size.0)) * R::splat(self.half.0);
        let y = (R::one() - py * two / R::splat(self.size.1)) * R::splat(self.half.1);
        let [ax, ay, az] = self.axes.map(Vector3::splat);
        let across = ax.scale(x) + ay.scale(y);
        let origin = Vector3::splat(self.origin);
        let (near, far) = (R::splat(self.near), R::splat(self.far));
        if self.orthographic {
            return RayLanes::new(origin + across + az.scale(near), az.normalize(), R::zero(), far - near);
        }
        // The axis grows by this much from the plane at distance 1 to the unit direction.
        let slant = (x * x + y * y + R::one()).sqrt();
        let dir = (across + az).normalize();
        RayLanes::new(origin + dir.scale(near * slant), dir, R::zero(), (far - near) * slant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let corner = camera(false).rays::<f32>(0.0, 0.0);
        let want = Vec3::new(1.0, 0.5, 1.0).normalize();
        assert!((Vec3::from(corner.dir) - want).length() < 1e-6);
        assert!((Vec3::from(corner.org) - Vec3::new(0.5, 0.25, 0.5)).length() < 1e-6);
        let end = Vec3::from(corner.org) + Vec3::from(corner.dir) * corner.t_far;
        assert!((end - Vec3::new(10.0, 5.0, 10.0)).length() < 1e-5, "{end}");
    }

    #[test]
    fn orthographic_rays_are_parallel_and_span_two_units() {
        let [left, right] = [0.0f32, 4.0].map(|px| camera(true).rays(px, 1.0));
        assert_eq!(Vec3::from(left.org), Vec3::new(1.0, 0.0, 0.5));
        assert_eq!(Vec3::from(right.org), Vec3::new(-1.0, 0.0, 0.5));
        assert_eq!(Vec3::from(left.dir), Vec3::Z);
        assert_eq!(left.t_far, 9.5);
    }
}
