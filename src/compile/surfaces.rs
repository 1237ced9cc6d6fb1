//! What is known about each primitive besides where it is: normals, texture coordinates, material, light.

use glam::Vec3;

use super::{Asked, vertices::Vertices};
use crate::geometry::{Canonical, CanonicalKind, Sphere};
use crate::light::LightId;
use crate::material::MaterialId;
use crate::math::{Frame, INV_PI, INV_TWO_PI, acos, atan2};
use crate::simd::{Bits, MOST, Mask, Real, Vector3, vector3};
use crate::texture::Coordinates;

pub(super) mod partials;

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
    Triangles {
        uv: Interpolate,
        normal: Interpolate,
    },
    Sphere {
        /// Does its material look at (u, v)? If not, and nobody else does, they need not be worked out.
        mapped: bool,
    },
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
    /// Its number among meshes with attributes, or [`attributes::NONE`](super::attributes::NONE).
    pub(super) mesh: u32,
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
    pub(super) vertices: Vertices,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) spheres: Vec<SphereRow>,
    pub(super) canonicals: Vec<CanonicalRow>,
    /// Does any shape have attributes?
    pub(super) attributed: bool,
}

/// Points on surfaces, ready to be shaded.
#[derive(Clone, Copy, Debug)]
pub struct Surface<R: Real> {
    /// World space.
    pub position: Vector3<R>,
    /// Size of the surface around it in world space, for [`offset_origin`](crate::geometry::offset_origin).
    pub extent: Vector3<R>,
    /// Geometric normal as the surface stores it, in world space, unit length.
    pub n_g: Vector3<R>,
    /// The shading normal in world space, with tangents: the first along ∂p/∂u where that was asked for, else any.
    pub frame: Frame<R>,
    /// ∂p/∂u and ∂p/∂v in world space where they were asked for, else zero.
    pub partials: [Vector3<R>; 2],
    /// Where textures are looked up.
    pub uv: Coordinates<R>,
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
            uv: Coordinates::select(mask, a.uv, b.uv),
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
    /// must name a primitive.
    #[inline]
    pub(super) fn at<R: Real>(
        &self,
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
        asked: Asked,
    ) -> Surface<R> {
        let shape = |i: usize| self.shape_of[primitive.lane(i) as usize];
        let first = shape(0);
        let one = (!primitive.equal(R::Bits::splat(primitive.lane(0)))).none();
        let (part, side, light) = if one || (1..R::LANES).all(|i| shape(i) == first) {
            let row = &self.shapes[first as usize];
            let part = self.of_one_shape(row, (org, dir), (t, u, v), primitive, asked.mapped);
            (part, R::splat(row.side), R::Bits::splat(row.light.0))
        } else {
            let rows: [&ShapeRow; MOST] =
                std::array::from_fn(|i| &self.shapes[shape(if i < R::LANES { i } else { 0 }) as usize]);
            let part = self.of_several_shapes(&rows, (org, dir), (t, u, v), primitive);
            (part, R::from_fn(|i| rows[i].side), R::Bits::from_fn(|i| rows[i].light.0))
        };
        let (n_g, n_s) = (part.n_g.scale(side), part.n_s.scale(side));
        let (mut frame, mut moves) = (Frame::around(n_s), [Vector3::zero(); 2]);
        if asked.oriented {
            let mut lanes = [[Vec3::ZERO; 2]; MOST];
            for (i, lane) in lanes[..R::LANES].iter_mut().enumerate() {
                *lane = self.partials(primitive.lane(i), part.position.lane(i), part.n_g.lane(i));
            }
            moves = [0, 1].map(|k| Vector3::from_fn(|i| lanes[i][k]));
            frame = partials::frame_along(n_s, moves[0]);
        }
        let mut coordinates = Coordinates::from(part.uv);
        if self.attributed {
            let row = |i: usize| &self.shapes[shape(i) as usize];
            coordinates.mesh = R::Bits::from_fn(|i| row(i).mesh);
            coordinates.face = R::Bits::from_fn(|i| primitive.lane(i).wrapping_sub(row(i).first));
            coordinates.weights = (u, v);
        }
        Surface {
            position: part.position,
            extent: part.extent,
            n_g,
            frame,
            partials: moves,
            uv: coordinates,
            light,
        }
    }

    #[inline]
    fn of_one_shape<R: Real>(
        &self,
        row: &ShapeRow,
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
        asked: bool,
    ) -> Part<R> {
        let place = row.first_in_class as usize;
        match row.class {
            Class::Triangles { uv, normal } => {
                let all = |this| if this == Interpolate::Vertices { (1u32 << R::LANES) - 1 } else { 0 };
                let index = |i: usize| (primitive.lane(i) - row.first) as usize + place;
                self.triangles(index, (all(normal), all(uv)), (u, v))
            }
            Class::Sphere { mapped } => {
                let SphereRow { sphere, to_local } = &self.spheres[place];
                let (center, radius) = (Vector3::splat(sphere.center), R::splat(sphere.radius));
                let to_local = (mapped || asked).then(|| to_local.map(Vector3::splat));
                on_sphere((center, radius), to_local, org + dir.scale(t))
            }
            Class::Canonical => self.canonicals[place].at(org + dir.scale(t)),
        }
    }

    fn of_several_shapes<R: Real>(
        &self,
        rows: &[&ShapeRow; MOST],
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
    ) -> Part<R> {
        let index = |i: usize| (primitive.lane(i) - rows[i].first + rows[i].first_in_class) as usize;
        let (mut triangles, mut spheres, mut canonicals) = (0u32, 0u32, 0u32);
        let (mut smooth, mut mapped) = (0, 0);
        for (i, row) in rows[..R::LANES].iter().enumerate() {
            match row.class {
                Class::Triangles { uv, normal } => {
                    triangles |= 1 << i;
                    smooth |= u32::from(normal == Interpolate::Vertices) << i;
                    mapped |= u32::from(uv == Interpolate::Vertices) << i;
                }
                Class::Sphere { .. } => spheres |= 1 << i,
                Class::Canonical => canonicals |= 1 << i,
            }
        }

        let mut part = if triangles != 0 {
            // Lanes of other classes read the first triangle there is, and are replaced below.
            let lane = triangles.trailing_zeros() as usize;
            mapped |= if mapped >> lane & 1 != 0 { !triangles & ((1 << R::LANES) - 1) } else { 0 };
            let safe = |i: usize| index(if triangles >> i & 1 != 0 { i } else { lane });
            self.triangles(safe, (smooth, mapped), (u, v))
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
            let row = |i: usize| &self.spheres[index(if spheres >> i & 1 != 0 { i } else { lane })];
            let center = Vector3::<R>::from_fn(|i| row(i).sphere.center);
            let radius = R::from_fn(|i| row(i).sphere.radius);
            let axes = [0, 1, 2].map(|k| Vector3::<R>::from_fn(|i| row(i).to_local[k]));
            replace(spheres, on_sphere((center, radius), Some(axes), point));
        }
        let mut rest = canonicals;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            let same = (0..R::LANES).filter(|&i| primitive.lane(i) == primitive.lane(lane));
            let same = same.fold(0, |bits, i| bits | 1 << i);
            rest &= !same;
            replace(same, self.canonicals[index(lane)].at(point));
        }
        part
    }

    /// Triangles whose normals and uv, in these lanes, are their vertices'.
    #[inline]
    fn triangles<R: Real>(
        &self,
        index: impl Fn(usize) -> usize,
        (smooth, mapped): (u32, u32),
        (u, v): (R, R),
    ) -> Part<R> {
        let mut corners = [[0; 3]; MOST];
        for (i, corner) in corners[..R::LANES].iter_mut().enumerate() {
            *corner = self.triangles[index(i)];
        }
        let row = |i: usize, k: usize| self.vertices.row(mapped >> i & 1 != 0, corners[i][k]);
        let one_column = mapped == 0 || mapped == (1 << R::LANES) - 1;
        let [p0, p1, p2] = if one_column && corners[1..R::LANES].iter().all(|corner| *corner == corners[0]) {
            let splat = |row: [f32; 8]| std::array::from_fn(|n| R::splat(row[n]));
            [splat(row(0, 0)), splat(row(0, 1)), splat(row(0, 2))]
        } else {
            [0, 1, 2].map(|k| R::from_rows(|i| row(i, k)))
        };
        let position = |[x, y, z, ..]: [R; 8]| vector3(x, y, z);
        let (v0, e1, e2) = (position(p0), position(p1) - position(p0), position(p2) - position(p0));
        let n_g = e1.cross(e2).normalize_or(vector3(R::zero(), R::zero(), R::one()));
        let w = R::one() - u - v;
        let mut n_s = n_g;
        if smooth != 0 {
            let normal = |p: [R; 8]| vector3(p[3], p[4], p[5]);
            let n = normal(p0).scale(w) + normal(p1).scale(u) + normal(p2).scale(v);
            n_s = Vector3::select(R::Mask::from_bitmask(smooth), n.normalize_or(n_g), n_g);
        }
        let mut uv = (u, v);
        if mapped != 0 {
            let along = |k: usize| p0[k] * w + p1[k] * u + p2[k] * v;
            let mapped = R::Mask::from_bitmask(mapped);
            uv = (R::select(mapped, along(6), u), R::select(mapped, along(7), v));
        }
        Part { position: v0 + (e1.scale(u) + e2.scale(v)), extent: e1.abs() + e2.abs(), n_g, n_s, uv }
    }
}

/// Spheres, with their poles if (u, v) are asked for; the point is put back onto them, so that its error no longer grows with t.
#[inline]
fn on_sphere<R: Real>(
    (center, radius): (Vector3<R>, R),
    to_local: Option<[Vector3<R>; 3]>,
    point: Vector3<R>,
) -> Part<R> {
    let n = (point - center).normalize_or(vector3(R::zero(), R::zero(), R::one()));
    let uv = to_local.map(|[x, y, z]| (turns(y.dot(n), x.dot(n)), acos(z.dot(n)) * R::splat(INV_PI)));
    Part {
        position: center + n.scale(radius),
        extent: vector3(radius, radius, radius),
        n_g: n,
        n_s: n,
        uv: uv.unwrap_or((R::zero(), R::zero())),
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
