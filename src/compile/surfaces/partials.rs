//! How a point moves with its texture coordinates: ∂p/∂u and ∂p/∂v, for materials that have a grain or a
//! relief.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Class, Interpolate, Surfaces};
use crate::geometry::CanonicalKind;
use crate::math::Frame;
use crate::simd::{Real, Vector3};

impl Surfaces {
    /// ∂p/∂u and ∂p/∂v of a point of a primitive; `n` is its unit normal before it is turned. Zero where
    /// texture coordinates don't move.
    pub(super) fn partials(&self, primitive: u32, position: Vec3, n: Vec3) -> [Vec3; 2] {
        let shape = self.shape(primitive);
        let index = (primitive - shape.first + shape.first_in_class) as usize;
        match shape.class {
            Class::Triangles { uv, .. } => self.triangle_partials(index, uv),
            Class::Sphere { .. } => {
                let row = &self.spheres[index];
                let [x, y, z] = row.to_local.map(|axis| axis.dot(n));
                let rim = (x * x + y * y).sqrt();
                let (cos, sin) = if rim > 0.0 { (x / rim, y / rim) } else { (1.0, 0.0) };
                let radius = row.sphere.radius;
                let to_world =
                    |v: Vec3| row.to_local[0] * v.x + row.to_local[1] * v.y + row.to_local[2] * v.z;
                [
                    to_world(Vec3::new(-y, x, 0.0)) * (TAU * radius),
                    to_world(Vec3::new(z * cos, z * sin, -rim)) * (PI * radius),
                ]
            }
            Class::Canonical => {
                let row = &self.canonicals[index];
                let [x_axis, y_axis, z_axis] = row.axes;
                let local = Vec3::from(row.surface.to_canonical(Vector3::<f32>::from(position)));
                let radius = (local.x * local.x + local.y * local.y).sqrt();
                let (cos, sin) = if radius > 0.0 { (local.x / radius, local.y / radius) } else { (1.0, 0.0) };
                let outward = x_axis * cos + y_axis * sin;
                let around = y_axis * cos - x_axis * sin;
                match row.surface.kind {
                    CanonicalKind::Disk => [outward, around * (TAU * radius)],
                    CanonicalKind::Cylinder => [around * TAU, z_axis],
                }
            }
        }
    }

    fn triangle_partials(&self, index: usize, uv: Interpolate) -> [Vec3; 2] {
        let corners = self.triangles[index];
        let [v0, v1, v2] = self.vertices.positions(uv, corners);
        let (e1, e2) = (v1 - v0, v2 - v0);
        if uv == Interpolate::Face {
            return [e1, e2];
        }
        let [uv0, uv1, uv2] = corners.map(|i| self.vertices.mapped[i as usize].uv);
        let (Vec2 { x: du1, y: dv1 }, Vec2 { x: du2, y: dv2 }) = (uv1 - uv0, uv2 - uv0);
        let determinant = du1 * dv2 - dv1 * du2;
        if determinant == 0.0 {
            return [Vec3::ZERO; 2];
        }
        let partials = [(e1 * dv2 - e2 * dv1) / determinant, (e2 * du1 - e1 * du2) / determinant];
        if partials.iter().all(|p| p.is_finite()) { partials } else { [Vec3::ZERO; 2] }
    }
}

/// A frame about `n` whose first tangent is `along`, as far as it can be.
#[inline]
pub(in crate::compile) fn frame_along<R: Real>(n: Vector3<R>, along: Vector3<R>) -> Frame<R> {
    let any = Frame::around(n);
    let s = (along - n.scale(n.dot(along))).normalize_or(any.s);
    Frame { s, t: n.cross(s), n }
}
