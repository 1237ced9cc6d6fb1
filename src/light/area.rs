//! Shapes that emit.
//!
//! The same radiance in all directions, on the side of the normal. A sphere that shines outward is sampled by
//! the cone it is seen in (density 1/(2π(1 − cos θ_max))), a rectangle by its solid angle, everything else
//! uniformly by area; seen from
//! distance d under the angle θ' at the light, a density 1/A per area is d²/(A cos θ') per solid angle.

use std::f32::consts::PI;

use glam::Vec3;

use super::{LightSample, Reach, rectangle::Rectangle};
use crate::geometry::{Aabb, CanonicalKind, Sphere, Triangle, offset_origin};
use crate::math::{Frame, sin_cos_turns, warp};
use crate::simd::{MOST, Mask, Real, Vector3, vector3};

/// A shape with an emission.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// W/(m² sr).
    pub radiance: Vec3,
    /// Where it comes from.
    pub shape: Emitting,
    /// +1 if the shape's own normal is the side that emits, −1 if it is the other.
    pub side: f32,
    /// Size of the surface around any of its points, in world space, for [`offset_origin`].
    pub extent: Vec3,
    /// Around all that shines, as rays meet it; world space.
    pub bounds: Aabb,
}

/// The geometry of an emitter.
#[derive(Clone, Debug)]
pub enum Emitting {
    /// A sphere, its own normal outward.
    Sphere(Sphere),
    /// Triangles, with the running sum of their areas.
    Triangles {
        /// Normal e₁ × e₂.
        triangles: Vec<Triangle>,
        /// The normals as unit vectors.
        normals: Vec<Vec3>,
        /// `sums[i]` is the area of triangles 0..=i.
        sums: Vec<f32>,
    },
    /// A rectangle, its normal x × y.
    Rectangle(Rectangle),
    /// A disk or a cylinder: the image of the canonical one.
    Canonical {
        /// Which.
        kind: CanonicalKind,
        /// Images of the canonical axes; orthogonal, x and y of one length.
        axes: [Vec3; 3],
        /// Image of the canonical origin.
        origin: Vec3,
        /// Its area.
        area: f32,
    },
}

/// A point on a light, as a ray found it.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<R> {
    /// World space.
    pub position: Vector3<R>,
    /// Geometric normal of the shape, world space, unit length.
    pub n_g: Vector3<R>,
}

impl Emitting {
    /// Triangles, degenerate ones included: they are never drawn.
    pub fn triangles(triangles: Vec<Triangle>) -> Self {
        let mut sum = 0.0;
        let area = |t: &Triangle| 0.5 * t.e1().cross(t.e2()).length();
        let sums = triangles
            .iter()
            .map(|t| {
                sum += area(t);
                sum
            })
            .collect();
        let up = vector3(0.0, 0.0, 1.0);
        let normal = |t: &Triangle| Vector3::from(t.e1().cross(t.e2())).normalize_or(up).into();
        Self::Triangles { normals: triangles.iter().map(normal).collect(), triangles, sums }
    }

    /// A rectangle's two triangles, or whatever else they are.
    pub fn quadrilateral(triangles: Vec<Triangle>) -> Self {
        match triangles.as_slice() {
            [first, second] => Rectangle::of([first, second]).map(Self::Rectangle),
            _ => None,
        }
        .unwrap_or_else(|| Self::triangles(triangles))
    }

    fn area(&self) -> f32 {
        match self {
            Self::Rectangle(rectangle) => rectangle.area(),
            Self::Sphere(sphere) => 4.0 * PI * sphere.radius * sphere.radius,
            Self::Triangles { sums, .. } => sums.last().copied().unwrap_or(0.0),
            Self::Canonical { area, .. } => *area,
        }
    }

    /// (middle, radius) of a ball that holds the shape.
    pub(super) fn ball(&self) -> (Vec3, f32) {
        match self {
            Self::Rectangle(rectangle) => (rectangle.middle(), 0.5 * rectangle.span().length()),
            Self::Sphere(sphere) => (sphere.center, sphere.radius),
            Self::Triangles { triangles, .. } => {
                let bounds = triangles.iter().fold(Aabb::EMPTY, |bounds, t| bounds.union(t.bounds()));
                (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min).length())
            }
            Self::Canonical { kind, axes: [x, y, z], origin, .. } => {
                let along = if *kind == CanonicalKind::Cylinder { *z } else { Vec3::ZERO };
                (
                    *origin + 0.5 * along,
                    (x.length_squared().max(y.length_squared()) + 0.25 * along.length_squared()).sqrt(),
                )
            }
        }
    }

    /// A point and its normal, uniform by area.
    #[inline]
    pub(crate) fn sample_area<R: Real>(&self, (u, v): (R, R)) -> (Vector3<R>, Vector3<R>) {
        match self {
            Self::Rectangle(rectangle) => rectangle.sample_area((u, v)),
            Self::Sphere(sphere) => {
                let n = warp::sphere(u, v);
                (Vector3::splat(sphere.center) + n.scale(R::splat(sphere.radius)), n)
            }
            Self::Triangles { triangles, normals, sums } => {
                let target = u * R::splat(sums.last().copied().unwrap_or(0.0));
                let picked = Picked::new(triangles, normals, sums, target);
                // What is left of u within its triangle is a new uniform number.
                let rest = (target - picked.below) / (picked.end - picked.below);
                let (b, c) = warp::triangle(rest.clamp(0.0, 1.0), v);
                (picked.v0 + picked.e1.scale(b) + picked.e2.scale(c), picked.n_g)
            }
            Self::Canonical { kind, axes, origin, .. } => {
                let [x, y, z] = axes.map(Vector3::<R>::splat);
                let origin = Vector3::splat(*origin);
                match kind {
                    CanonicalKind::Disk => {
                        let (a, b) = warp::disk(u, v);
                        (origin + x.scale(a) + y.scale(b), x.cross(y).normalize())
                    }
                    CanonicalKind::Cylinder => {
                        let (sin, cos) = sin_cos_turns(u);
                        let around = x.scale(cos) + y.scale(sin);
                        (origin + around + z.scale(v), around.normalize())
                    }
                }
            }
        }
    }
}

/// Up to so many triangles are gone through by all lanes together.
const FEW: usize = 8;

/// A triangle a lane, and the shares of the area at which it begins and ends.
struct Picked<R> {
    v0: Vector3<R>,
    e1: Vector3<R>,
    e2: Vector3<R>,
    n_g: Vector3<R>,
    below: R,
    end: R,
}

impl<R: Real> Picked<R> {
    /// The triangles in whose share of the running sums `target` lies. There must be one.
    #[inline]
    fn new(triangles: &[Triangle], normals: &[Vec3], sums: &[f32], target: R) -> Self {
        if triangles.len() > FEW {
            return Self::among_many(triangles, normals, sums, target);
        }
        let every = |k: usize| {
            let below = if k == 0 { 0.0 } else { sums[k - 1] };
            (triangles[k], normals[k], R::splat(below), R::splat(sums[k]))
        };
        let (first, n_g, below, end) = every(0);
        let mut picked = Self {
            v0: Vector3::splat(first.v0),
            e1: Vector3::splat(first.e1()),
            e2: Vector3::splat(first.e2()),
            n_g: Vector3::splat(n_g),
            below,
            end,
        };
        for k in 1..triangles.len() {
            let (triangle, n_g, below, end) = every(k);
            let here = below.le(target);
            let replace = |with: Vec3, old| Vector3::select(here, Vector3::splat(with), old);
            picked = Self {
                v0: replace(triangle.v0, picked.v0),
                e1: replace(triangle.e1(), picked.e1),
                e2: replace(triangle.e2(), picked.e2),
                n_g: replace(n_g, picked.n_g),
                below: R::select(here, below, picked.below),
                end: R::select(here, end, picked.end),
            };
        }
        picked
    }

    /// By bisection, lane by lane.
    fn among_many(triangles: &[Triangle], normals: &[Vec3], sums: &[f32], target: R) -> Self {
        let mut picked = [0; MOST];
        for (lane, place) in picked[..R::LANES].iter_mut().enumerate() {
            *place = sums.partition_point(|&sum| sum <= target.lane(lane)).min(sums.len() - 1);
        }
        Self {
            v0: Vector3::from_fn(|lane| triangles[picked[lane]].v0),
            e1: Vector3::from_fn(|lane| triangles[picked[lane]].e1()),
            e2: Vector3::from_fn(|lane| triangles[picked[lane]].e2()),
            n_g: Vector3::from_fn(|lane| normals[picked[lane]]),
            below: R::from_fn(|lane| if picked[lane] == 0 { 0.0 } else { sums[picked[lane] - 1] }),
            end: R::from_fn(|lane| sums[picked[lane]]),
        }
    }
}

impl AreaLight {
    /// π A L, W.
    pub(super) fn power(&self) -> Vec3 {
        PI * self.shape.area() * self.radiance
    }

    /// Draws a point of the light as seen from `from`.
    #[inline]
    pub fn sample<R: Real>(&self, from: Vector3<R>, u: (R, R)) -> LightSample<R> {
        let by_angle = match self.seen_by_angle() {
            Some(Angular::Cone(sphere)) => Some(sample_cone(sphere, from, u)),
            Some(Angular::Rectangle(rectangle)) => Some(rectangle.sample_angle(from, u)),
            None => None,
        };
        let (mut position, mut n_g) = self.shape.sample_area(u);
        let mut angular_pdf = R::zero();
        let mut lanes = R::Mask::splat(false);
        if let Some(drawn) = by_angle {
            lanes = drawn.lanes;
            position = Vector3::select(lanes, drawn.position, position);
            n_g = Vector3::select(lanes, drawn.n_g, n_g);
            angular_pdf = drawn.pdf;
        }
        let to = position - from;
        let squared = to.dot(to);
        let wi = to.scale(R::one() / squared.sqrt());
        let cos = -wi.dot(n_g) * R::splat(self.side);
        let pdf = R::select(lanes, angular_pdf, squared / (cos * R::splat(self.shape.area())));
        let valid = cos.gt(R::zero()) & pdf.gt(R::zero()) & pdf.lt(R::splat(f32::INFINITY));
        LightSample {
            wi,
            target: offset_origin(position, Vector3::splat(self.extent), n_g, -wi),
            reach: Reach::Target,
            weight: Vector3::splat(self.radiance).scale(R::one() / pdf),
            pdf,
            valid,
        }
    }

    /// Density per solid angle with which `sample` from `from` draws the direction of `point`.
    #[inline]
    pub fn pdf<R: Real>(&self, from: Vector3<R>, point: &SurfacePoint<R>) -> R {
        let to = point.position - from;
        let squared = to.dot(to);
        let cos = (to.dot(point.n_g) / squared.sqrt()).abs();
        let by_area = squared / (cos * R::splat(self.shape.area()));
        let (lanes, angular_pdf) = match self.seen_by_angle() {
            Some(Angular::Cone(sphere)) => {
                let (outside, one_minus_cos_max) = seen_from(sphere, from);
                (outside, warp::cone_pdf(one_minus_cos_max))
            }
            Some(Angular::Rectangle(rectangle)) => rectangle.angular_pdf(from),
            None => return by_area,
        };
        R::select(lanes, angular_pdf, by_area)
    }

    /// Not the sphere that shines inward: it lights its own inside, whose points are outside of it as often as
    /// rounding has it so.
    fn seen_by_angle(&self) -> Option<Angular<'_>> {
        match &self.shape {
            Emitting::Sphere(sphere) if self.side > 0.0 => Some(Angular::Cone(sphere)),
            Emitting::Rectangle(rectangle) => Some(Angular::Rectangle(rectangle)),
            _ => None,
        }
    }
}

/// What is sampled by solid angle.
enum Angular<'l> {
    Cone(&'l Sphere),
    Rectangle(&'l Rectangle),
}

/// Points drawn by solid angle.
pub(super) struct Drawn<R: Real> {
    /// Where they are; elsewhere they are to be drawn by area.
    pub(super) lanes: R::Mask,
    pub(super) position: Vector3<R>,
    pub(super) n_g: Vector3<R>,
    pub(super) pdf: R,
}

/// (is the point outside, 1 − cos θ_max). The cosine itself would lose a small sphere's bits.
#[inline]
fn seen_from<R: Real>(sphere: &Sphere, from: Vector3<R>) -> (R::Mask, R) {
    let to = Vector3::splat(sphere.center) - from;
    let sin2 = R::splat(sphere.radius * sphere.radius) / to.dot(to);
    let outside = sin2.lt(R::one());
    let cos = (R::one() - sin2).max(R::zero()).sqrt();
    (outside, sin2 / (R::one() + cos))
}

/// A direction within the cone that the sphere fills, and where it meets the near side.
#[inline]
fn sample_cone<R: Real>(sphere: &Sphere, from: Vector3<R>, (u, v): (R, R)) -> Drawn<R> {
    let (outside, one_minus_cos_max) = seen_from(sphere, from);
    let to = Vector3::splat(sphere.center) - from;
    let distance = to.length();
    let radius = R::splat(sphere.radius);
    let local = warp::cone(u, v, one_minus_cos_max);
    let sin2 = local.x * local.x + local.y * local.y;
    // Along the ray: distance·cos θ − √(r² − distance² sin²θ); at the rim the root may round below 0.
    let reach = distance * local.z - (radius * radius - distance * distance * sin2).max(R::zero()).sqrt();
    let axis = to.scale(R::one() / distance);
    let dir = Frame::around(axis).to_world(local);
    let n_g = (from + dir.scale(reach) - Vector3::splat(sphere.center)).normalize_or(-axis);
    Drawn {
        lanes: outside,
        position: Vector3::splat(sphere.center) + n_g.scale(radius),
        n_g,
        pdf: warp::cone_pdf(one_minus_cos_max),
    }
}
