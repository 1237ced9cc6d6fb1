//! What is known about each primitive besides where it is: normals, texture coordinates, material, light.

use glam::{Vec2, Vec3};

use crate::geometry::{Canonical, CanonicalKind, Sphere};
use crate::light::LightId;
use crate::material::MaterialId;
use crate::math::{Frame, INV_PI, INV_TWO_PI, acos, atan2};
use crate::simd::{Bits, Mask, Real, Vector3, vector3};

pub(super) mod partials;

/// A vertex in world space: 32 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Vertex {
    pub(super) position: Vec3,
    pub(super) u: f32,
    pub(super) normal: Vec3,
    pub(super) v: f32,
}

/// What a triangle's uv and shading normal are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolate {
    /// The vertices'.
    Vertices,
    /// Nothing is known: barycentric uv, or the geometric normal.
    Face,
}

/// How a shape's primitives are looked up.
#[derive(Clone, Copy, Debug)]
pub(super) enum Class {
    Triangles { uv: Interpolate, normal: Interpolate },
    Sphere,
    Canonical,
}

/// A shape: the primitives from `first` on.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapeRow {
    pub(super) first: u32,
    /// The place of the first primitive among those of its class.
    pub(super) first_in_class: u32,
    pub(super) class: Class,
    pub(super) material: MaterialId,
    pub(super) light: LightId,
    /// −1 where `flip_normals` is set.
    pub(super) side: f32,
}

/// A sphere's poles: rows of the rotation from world to its own axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphereRow {
    pub(super) sphere: Sphere,
    pub(super) to_local: [Vec3; 3],
}

/// A disk or cylinder with its way back into the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct CanonicalRow {
    pub(super) surface: Canonical,
    pub(super) axes: [Vec3; 3],
    pub(super) origin: Vec3,
    /// Unit normal of a disk.
    pub(super) normal: Vec3,
}

/// Columns of shading data.
#[derive(Debug, Default)]
pub(super) struct Surfaces {
    /// For each primitive its shape.
    pub(super) shape_of: Vec<u32>,
    pub(super) shapes: Vec<ShapeRow>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) spheres: Vec<SphereRow>,
    pub(super) canonicals: Vec<CanonicalRow>,
}

/// Points on surfaces, ready to be shaded.
#[derive(Clone, Copy, Debug)]
pub struct Surface<R: Real> {
    /// World space.
    pub position: Vector3<R>,
    /// Size of the surface around it, for [`offset_origin`](crate::geometry::offset_origin).
    pub extent: Vector3<R>,
    /// Geometric normal as the surface stores it, unit length.
    pub n_g: Vector3<R>,
    /// The shading normal, with tangents: the first along ∂p/∂u where that was asked for, else any.
    pub frame: Frame<R>,
    /// ∂p/∂u and ∂p/∂v in world space where they were asked for, else zero.
    pub partials: [Vector3<R>; 2],
    /// Texture coordinates.
    pub uv: (R, R),
    /// [`LightId`] of the shape.
    pub light: R::Bits,
}

impl<R: Real> Surface<R> {
    /// `if mask { a } else { b }`, lane by lane.
    #[inline]
    pub(super) fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        let select = |a, b| Vector3::select(mask, a, b);
        let frame = Frame {
            s: select(a.frame.s, b.frame.s),
            t: select(a.frame.t, b.frame.t),
            n: select(a.frame.n, b.frame.n),
        };
        Self {
            position: select(a.position, b.position),
            extent: select(a.extent, b.extent),
            n_g: select(a.n_g, b.n_g),
            frame,
            partials: [0, 1].map(|k| select(a.partials[k], b.partials[k])),
            uv: (R::select(mask, a.uv.0, b.uv.0), R::select(mask, a.uv.1, b.uv.1)),
            light: R::Bits::select(mask, a.light, b.light),
        }
    }
}

/// A part of the answer: what one class of surface contributes.
struct Part<R> {
    position: Vector3<R>,
    extent: Vector3<R>,
    n_g: Vector3<R>,
    n_s: Vector3<R>,
    uv: (R, R),
}

impl Surfaces {
    /// How many spheres, disks and cylinders there are.
    pub(super) fn quadrics(&self) -> u64 {
        (self.spheres.len() + self.canonicals.len()) as u64
    }

    #[inline]
    pub(super) fn shape(&self, primitive: u32) -> &ShapeRow {
        &self.shapes[self.shape_of[primitive as usize] as usize]
    }

    /// The points where rays with direction `dir` from `org` met `primitive` at (t, u, v). Every lane
    /// must name a primitive. `oriented` asks for what has to do with the direction of u and v.
    #[inline]
    pub(super) fn at<R: Real>(
        &self,
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
        oriented: bool,
    ) -> Surface<R> {
        let rows: [&ShapeRow; 8] =
            std::array::from_fn(|i| self.shape(primitive.lane(if i < R::LANES { i } else { 0 })));
        let index = |i: usize| (primitive.lane(i) - rows[i].first + rows[i].first_in_class) as usize;
        let which =
            |f: fn(&Class) -> bool| (0..R::LANES).fold(0, |bits, i| bits | u32::from(f(&rows[i].class)) << i);
        let all = (1u32 << R::LANES) - 1;
        let spheres = which(|class| matches!(class, Class::Sphere));
        let canonicals = which(|class| matches!(class, Class::Canonical));
        let triangles = all & !spheres & !canonicals;

        let mut part = if triangles != 0 {
            // Lanes of other classes read the first triangle there is, and are replaced below.
            let lane = triangles.trailing_zeros() as usize;
            let safe = |i: usize| if triangles >> i & 1 != 0 { i } else { lane };
            self.triangles(&rows, |i| index(safe(i)), safe, u, v)
        } else {
            Part {
                position: Vector3::zero(),
                extent: Vector3::zero(),
                n_g: Vector3::zero(),
                n_s: Vector3::zero(),
                uv: (R::zero(), R::zero()),
            }
        };
        let mut replace = |lanes: u32, other: Part<R>| {
            let mask = R::Mask::from_bitmask(lanes);
            part.position = Vector3::select(mask, other.position, part.position);
            part.extent = Vector3::select(mask, other.extent, part.extent);
            part.n_g = Vector3::select(mask, other.n_g, part.n_g);
            part.n_s = Vector3::select(mask, other.n_s, part.n_s);
            part.uv = (R::select(mask, other.uv.0, part.uv.0), R::select(mask, other.uv.1, part.uv.1));
        };
        let point = org + dir.scale(t);
        if spheres != 0 {
            let lane = spheres.trailing_zeros() as usize;
            let safe = |i: usize| index(if spheres >> i & 1 != 0 { i } else { lane });
            replace(spheres, self.spheres(safe, point));
        }
        let mut rest = canonicals;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            let same = (0..R::LANES).filter(|&i| primitive.lane(i) == primitive.lane(lane));
            let same = same.fold(0, |bits, i| bits | 1 << i);
            rest &= !same;
            replace(same, self.canonicals[index(lane)].at(point));
        }
        let side = R::from_fn(|i| rows[i].side);
        let (n_g, n_s) = (part.n_g.scale(side), part.n_s.scale(side));
        let (mut frame, mut moves) = (Frame::around(n_s), [Vector3::zero(); 2]);
        if oriented {
            let mut lanes = [[Vec3::ZERO; 2]; 8];
            for (i, lane) in lanes[..R::LANES].iter_mut().enumerate() {
                *lane = self.partials(primitive.lane(i), part.position.lane(i), part.n_g.lane(i));
            }
            moves = [0, 1].map(|k| Vector3::from_fn(|i| lanes[i][k]));
            frame = partials::frame_along(n_s, moves[0]);
        }
        Surface {
            position: part.position,
            extent: part.extent,
            n_g,
            frame,
            partials: moves,
            uv: part.uv,
            light: R::Bits::from_fn(|i| rows[i].light.0),
        }
    }

    #[inline]
    fn triangles<R: Real>(
        &self,
        rows: &[&ShapeRow; 8],
        index: impl Fn(usize) -> usize,
        safe: impl Fn(usize) -> usize,
        u: R,
        v: R,
    ) -> Part<R> {
        let mut corners = [[&self.vertices[0]; 3]; 8];
        let mut smooth = 0;
        let mut mapped = 0;
        for (i, corner) in corners[..R::LANES].iter_mut().enumerate() {
            *corner = self.triangles[index(i)].map(|vertex| &self.vertices[vertex as usize]);
            if let Class::Triangles { uv, normal } = rows[safe(i)].class {
                smooth |= u32::from(normal == Interpolate::Vertices) << i;
                mapped |= u32::from(uv == Interpolate::Vertices) << i;
            }
        }
        let position = |k: usize| Vector3::<R>::from_fn(|i| corners[i][k].position);
        let p0 = position(0);
        let (e1, e2) = (position(1) - p0, position(2) - p0);
        let n_g = e1.cross(e2).normalize_or(vector3(R::zero(), R::zero(), R::one()));
        let mut n_s = n_g;
        if smooth != 0 {
            let normal = |k: usize| Vector3::<R>::from_fn(|i| corners[i][k].normal);
            let n = normal(0).scale(R::one() - u - v) + normal(1).scale(u) + normal(2).scale(v);
            n_s = Vector3::select(R::Mask::from_bitmask(smooth), n.normalize_or(n_g), n_g);
        }
        let mut uv = (u, v);
        if mapped != 0 {
            let along = |f: fn(&Vertex) -> f32| {
                let c = |k: usize| R::from_fn(|i| f(corners[i][k]));
                c(0) * (R::one() - u - v) + c(1) * u + c(2) * v
            };
            let mapped = R::Mask::from_bitmask(mapped);
            uv = (R::select(mapped, along(|c| c.u), u), R::select(mapped, along(|c| c.v), v));
        }
        Part { position: p0 + (e1.scale(u) + e2.scale(v)), extent: e1.abs() + e2.abs(), n_g, n_s, uv }
    }

    #[inline]
    fn spheres<R: Real>(&self, index: impl Fn(usize) -> usize, point: Vector3<R>) -> Part<R> {
        let rows: [&SphereRow; 8] =
            std::array::from_fn(|i| &self.spheres[index(if i < R::LANES { i } else { 0 })]);
        let center = Vector3::<R>::from_fn(|i| rows[i].sphere.center);
        let radius = R::from_fn(|i| rows[i].sphere.radius);
        // The point is put back onto the sphere: its error no longer grows with t.
        let n = (point - center).normalize_or(vector3(R::zero(), R::zero(), R::one()));
        let axis = |k: usize| Vector3::<R>::from_fn(|i| rows[i].to_local[k]).dot(n);
        let (x, y, z) = (axis(0), axis(1), axis(2));
        Part {
            position: center + n.scale(radius),
            extent: vector3(radius, radius, radius),
            n_g: n,
            n_s: n,
            uv: (turns(y, x), acos(z) * R::splat(INV_PI)),
        }
    }
}

impl CanonicalRow {
    #[inline]
    fn at<R: Real>(&self, point: Vector3<R>) -> Part<R> {
        let [x, y, z] = self.axes.map(Vector3::<R>::splat);
        let local = self.surface.to_canonical(point);
        let radius = (local.x * local.x + local.y * local.y).sqrt();
        let angle = turns(local.y, local.x);
        let extent = x.abs() + y.abs() + z.abs();
        let origin = Vector3::splat(self.origin);
        match self.surface.kind {
            CanonicalKind::Disk => {
                let n = Vector3::splat(self.normal);
                let position = origin + (x.scale(local.x) + y.scale(local.y));
                Part { position, extent, n_g: n, n_s: n, uv: (radius, angle) }
            }
            CanonicalKind::Cylinder => {
                let around = x.scale(local.x / radius) + y.scale(local.y / radius);
                let n = around.normalize();
                Part {
                    position: origin + (around + z.scale(local.z)),
                    extent,
                    n_g: n,
                    n_s: n,
                    uv: (angle, local.z),
                }
            }
        }
    }
}

/// atan2 as a fraction of a turn in [0, 1).
#[inline]
fn turns<R: Real>(y: R, x: R) -> R {
    let angle = atan2(y, x) * R::splat(INV_TWO_PI);
    R::select(angle.lt(R::zero()), angle + R::one(), angle).min(R::splat(1.0 - f32::EPSILON / 2.0))
}

impl Vertex {
    pub(super) fn new(position: Vec3, normal: Vec3, uv: Vec2) -> Self {
        Self { position, u: uv.x, normal, v: uv.y }
    }
}
