//! Rectangles, sampled by the solid angle that they fill \[UFK13\].
//!
//! ```text
//! p(ω) = 1/S        S = γ₀ + γ₁ + γ₂ + γ₃ − 2π
//! ```
//!
//! with the inner angles γ of the spherical quadrilateral. Of a unit of S the first random number picks the strip along
//! y whose solid angle is u S, the second the place in the strip, so that what is stratified stays so. Where the
//! rectangle is far away, S is the difference of numbers a hundred times as large; there, and where it is all around,
//! points are drawn by area, which is nearly the same.

use std::f32::consts::TAU;

use glam::Vec3;

use super::area::Drawn;
use crate::geometry::Triangle;
use crate::math::{INV_TWO_PI, acos, sin_cos_turns};
use crate::simd::{Real, Vector3};

/// Solid angles that are sampled as such, sr. Below, four roundings of acos are a ten-thousandth of S.
const LEAST: f32 = 0.03;
/// Above, the receiver is as good as on the rectangle.
const MOST: f32 = 6.2;

/// A rectangle in space.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    corner: Vec3,
    /// Unit vectors along the sides and at right angles to them.
    axes: [Vec3; 3],
    sides: [f32; 2],
}

/// A rectangle as some points see it: its sides in its own axes, about the point.
struct View<R> {
    x: [R; 2],
    y: [R; 2],
    /// −|distance| of its plane.
    z: R,
    /// Components of the unit normals of the planes through the point and the sides at y₀ and y₁.
    b: [R; 2],
    /// Solid angle.
    angle: R,
    /// 2π − γ₂ − γ₃.
    k: R,
}

impl Rectangle {
    /// The rectangle that two triangles are halves of, if they are: they share the first corner.
    pub(super) fn of([first, second]: [&Triangle; 2]) -> Option<Self> {
        let right = |a: Vec3, b: Vec3| a.dot(b).abs() <= 1e-6 * a.length() * b.length();
        let sides = [(first.e1(), second.e2()), (second.e1(), first.e2())];
        let (a, b) = sides.into_iter().find(|&(a, b)| right(a, b))?;
        let (x, y) = (a.normalize_or_zero(), b.normalize_or_zero());
        let axes = [x, y, x.cross(y)];
        Some(Self { corner: first.v0, axes, sides: [a.length(), b.length()] })
            .filter(|_| x != Vec3::ZERO && y != Vec3::ZERO)
    }

    pub(super) fn area(&self) -> f32 {
        self.sides[0] * self.sides[1]
    }

    /// Its diagonal.
    pub(super) fn span(&self) -> Vec3 {
        self.sides[0] * self.axes[0] + self.sides[1] * self.axes[1]
    }

    /// Size of it around any of its points, as of the triangles that it is hit as.
    pub(crate) fn extent(&self) -> Vec3 {
        let [a, b] = [0, 1].map(|k| self.sides[k] * self.axes[k]);
        (a + b).abs() + a.abs().max(b.abs())
    }

    pub(super) fn middle(&self) -> Vec3 {
        self.corner + 0.5 * self.span()
    }

    /// A point and the normal, uniform by area.
    #[inline]
    pub(super) fn sample_area<R: Real>(&self, (u, v): (R, R)) -> (Vector3<R>, Vector3<R>) {
        let [x, y, n] = self.axes.map(Vector3::<R>::splat);
        let [a, b] = self.sides.map(R::splat);
        (Vector3::splat(self.corner) + x.scale(u * a) + y.scale(v * b), n)
    }

    #[inline]
    fn seen_from<R: Real>(&self, from: Vector3<R>) -> View<R> {
        let to = Vector3::splat(self.corner) - from;
        let along = |k: usize| to.dot(Vector3::splat(self.axes[k]));
        let [x0, y0] = [0, 1].map(along);
        let (x1, y1) = (x0 + R::splat(self.sides[0]), y0 + R::splat(self.sides[1]));
        let z = -along(2).abs();
        let normal = |side: R| side / (side * side + z * z).sqrt();
        let n = [-normal(y0), normal(x1), normal(y1), -normal(x0)];
        let gamma = [0, 1, 2, 3].map(|i| acos(-n[i] * n[(i + 1) % 4]));
        let k = R::splat(TAU) - gamma[2] - gamma[3];
        View { x: [x0, x1], y: [y0, y1], z, b: [n[0], n[2]], angle: gamma[0] + gamma[1] - k, k }
    }

    /// In which lanes the rectangle is sampled by solid angle, and with what density.
    #[inline]
    pub(super) fn angular_pdf<R: Real>(&self, from: Vector3<R>) -> (R::Mask, R) {
        let angle = self.seen_from(from).angle;
        (is_sampled(angle), R::one() / angle)
    }

    /// A point by solid angle.
    #[inline]
    pub(super) fn sample_angle<R: Real>(&self, from: Vector3<R>, (u, v): (R, R)) -> Drawn<R> {
        let View { x: [x0, x1], y: [y0, y1], z, b: [b0, b1], angle, k } = self.seen_from(from);
        let (sin, cos) = sin_cos_turns((u * angle + k) * R::splat(INV_TWO_PI));
        let f = (cos * b0 - b1) / sin;
        let c = R::one() / (f * f + b0 * b0).sqrt();
        let c = R::select(f.lt(R::zero()), -c, c).clamp(-1.0, 1.0);
        let x = (-(c * z) / (R::one() - c * c).sqrt()).max(x0).min(x1);
        let squared = x * x + z * z;
        let height = |y: R| y / (squared + y * y).sqrt();
        let (h0, h1) = (height(y0), height(y1));
        let h = h0 + v * (h1 - h0);
        let y = (h * (squared / (R::one() - h * h).max(R::zero())).sqrt()).max(y0).min(y1);
        let [along_x, along_y, n] = self.axes.map(Vector3::<R>::splat);
        Drawn {
            lanes: is_sampled(angle),
            // From its own corner: the point lies in the plane as exactly as one that is drawn by area.
            position: Vector3::splat(self.corner) + along_x.scale(x - x0) + along_y.scale(y - y0),
            n_g: n,
            pdf: R::one() / angle,
        }
    }
}

#[inline]
fn is_sampled<R: Real>(angle: R) -> R::Mask {
    angle.gt(R::splat(LEAST)) & angle.lt(R::splat(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn rectangle() -> Rectangle {
        let (v0, a, b) = (Vec3::new(-1.0, 0.5, 2.0), Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.0, 0.0, 1.0));
        let halves = [Triangle::new(v0, v0 + a, v0 + a + b), Triangle::new(v0, v0 + a + b, v0 + b)];
        Rectangle::of([&halves[0], &halves[1]]).expect("a rectangle")
    }

    /// Points that see it well, askew, from behind and from beside.
    const POINTS: [Vec3; 5] = [
        Vec3::new(0.0, 2.0, 0.0),
        Vec3::new(-1.0, 0.5, 1.5),
        Vec3::new(-3.0, 5.0, 4.0),
        Vec3::new(2.0, 1.0, 0.5),
        Vec3::new(0.3, 2.0, 2.8),
    ];

    /// S and ∫ ω dω over it, by two million points of its area.
    fn by_area(from: Vec3) -> (f64, glam::DVec3) {
        const SIDE: u32 = 1400;
        let rectangle = rectangle();
        let mut sum = (0.0, glam::DVec3::ZERO);
        for i in 0..SIDE * SIDE {
            let place = |k: u32| (f64::from(k) + 0.5) / f64::from(SIDE);
            let (x, y) = (place(i % SIDE), place(i / SIDE));
            let [a, b, n] = rectangle.axes.map(Vec3::as_dvec3);
            let [length, width] = rectangle.sides.map(f64::from);
            let to = rectangle.corner.as_dvec3() + a * (x * length) + b * (y * width) - from.as_dvec3();
            let part = length * width / f64::from(SIDE * SIDE) * to.dot(n).abs() / to.length().powi(3);
            sum = (sum.0 + part, sum.1 + part * to.normalize());
        }
        sum
    }

    #[test]
    fn the_angle_is_that_of_the_area_seen_and_samples_fill_it_evenly() {
        for from in POINTS {
            let (angle, mean) = by_area(from);
            let (sampled, pdf) = rectangle().angular_pdf::<f32>(from.into());
            assert!(sampled, "{from}: {angle}");
            assert!((1.0 / f64::from(pdf) - angle).abs() < 2e-4 * angle, "{from}: {} {angle}", 1.0 / pdf);
            const SIDE: u32 = 64;
            let place = |k: u32| (k as f32 + 0.5) / SIDE as f32;
            let directions = (0..SIDE * SIDE).map(|i| {
                let u = (place(i % SIDE), place(i / SIDE));
                let drawn = rectangle().sample_angle::<f32>(from.into(), u);
                (Vec3::from(drawn.position) - from).as_dvec3().normalize()
            });
            let drawn = directions.sum::<glam::DVec3>() * (angle / f64::from(SIDE * SIDE));
            assert!((drawn - mean).length() < 5e-4 * angle, "{from}: {drawn} {mean}");
        }
    }

    #[test]
    fn eight_lanes_are_one() {
        let from = |i: usize| POINTS[i % 5] + Vec3::splat(0.05 * i as f32);
        let (u, v) = (|i: usize| 0.11 * i as f32, |i: usize| 0.97 - 0.1 * i as f32);
        let eight =
            rectangle().sample_angle(Vector3::<f32x8>::from_fn(from), (f32x8::from_fn(u), f32x8::from_fn(v)));
        for i in 0..8 {
            let one = rectangle().sample_angle::<f32>(from(i).into(), (u(i), v(i)));
            assert_eq!(eight.position.lane(i), Vec3::from(one.position));
            assert_eq!(eight.pdf.lane(i), one.pdf);
        }
    }

    #[test]
    fn what_is_far_away_and_what_is_no_rectangle_is_drawn_by_area() {
        let (sampled, _) = rectangle().angular_pdf::<f32>(Vec3::new(0.0, 0.0, -100.0).into());
        assert!(!sampled);
        // Within its plane nothing of it is seen.
        let (sampled, _) = rectangle().angular_pdf::<f32>(Vec3::new(-3.0, 9.0, 0.0).into());
        assert!(!sampled);
        let sheared = [
            Triangle::new(Vec3::ZERO, Vec3::X, Vec3::new(1.5, 1.0, 0.0)),
            Triangle::new(Vec3::ZERO, Vec3::new(1.5, 1.0, 0.0), Vec3::new(0.5, 1.0, 0.0)),
        ];
        assert!(Rectangle::of([&sheared[0], &sheared[1]]).is_none());
    }

    #[test]
    fn the_hemisphere_is_half_of_all() {
        let near = rectangle().middle() - 0.01 * rectangle().axes[2];
        let (_, pdf) = rectangle().angular_pdf::<f32>(near.into());
        assert!((1.0 / pdf - TAU).abs() < 0.1, "{}", 1.0 / pdf);
    }
}
