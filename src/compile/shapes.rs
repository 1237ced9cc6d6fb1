//! Shapes to columns: primitives numbered in the order of the description.

use glam::Vec3;

use super::{
    CompileError, MAX_PRIMITIVES, References,
    attributes::{self, Numbers},
    canonical,
    mesh::{self, Interpolated},
    primitives::{CANONICAL, Primitive, SPHERE, TRIANGLE},
    surfaces::{CanonicalRow, Class, Interpolate, ShapeRow, Surfaces},
};
use crate::bvh::Reference;
use crate::geometry::{Aabb, CanonicalKind, Triangle};
use crate::light::{AreaLight, Emitting, Light, LightId};
use crate::material::MaterialId;
use crate::scene::{Geometry, GroupIndex, Shape};
use crate::simd::{Real, Vector3};

/// What shapes name by number.
#[derive(Clone, Copy)]
pub(super) struct Named<'a> {
    /// By place in the description: which material, and whether it is different at other (u, v).
    pub(super) materials: &'a [(MaterialId, bool)],
    /// Of meshes with attributes.
    pub(super) meshes: &'a Numbers,
    /// Place of the shape whose irradiance is measured.
    pub(super) metered: Option<u32>,
}

/// Triangles of a shape that have no area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Degenerate {
    /// The group that the shape is in; `None` in the world.
    pub group: Option<GroupIndex>,
    /// Place of the shape in its list.
    pub shape: u32,
    /// How many.
    pub triangles: u64,
}

impl Degenerate {
    /// In all shapes together.
    pub(super) fn total(all: &[Self]) -> u64 {
        all.iter().map(|one| one.triangles).sum()
    }
}

/// What the shapes of a description become.
pub(super) struct Shapes {
    pub(super) surfaces: Surfaces,
    pub(super) references: References,
    /// Triangles without area: they keep their numbers and are in no leaf.
    pub(super) degenerate: Vec<Degenerate>,
    /// The shape that was asked for, if it can be hit.
    pub(super) metered: Option<Metered>,
}

/// A shape whose irradiance is measured.
#[derive(Debug)]
pub(crate) struct Metered {
    shape: Emitting,
    side: f32,
    /// Size of the surface around any of its points.
    pub(crate) extent: Vec3,
}

impl Metered {
    /// A point, uniform by area, and the normal on the side that is measured.
    #[inline]
    pub(crate) fn sample<R: Real>(&self, u: (R, R)) -> (Vector3<R>, Vector3<R>) {
        let (position, n) = self.shape.sample_area(u);
        (position, n.scale(R::splat(self.side)))
    }
}

/// Compiles the shapes, and adds the area lights to `lights`. A mesh that nobody else holds is given back as soon as
/// it is in columns.
pub(super) fn compile(
    shapes: Vec<Shape>,
    named: &Named,
    lights: &mut Vec<Light>,
) -> Result<Shapes, CompileError> {
    let mut all =
        Shapes { surfaces: Surfaces::default(), references: vec![], degenerate: vec![], metered: None };
    all.reserve(&shapes);
    for (shape, place) in shapes.into_iter().zip(0..) {
        let count = all.surfaces.shape_of.len() as u64 + primitive_count(&shape.geometry);
        if count > MAX_PRIMITIVES {
            return Err(CompileError::TooManyPrimitives(count));
        }
        all.add(shape, named, named.metered == Some(place), lights)?;
    }
    Ok(all)
}

fn primitive_count(geometry: &Geometry) -> u64 {
    match geometry {
        Geometry::Mesh { mesh, .. } => mesh.triangles.len() as u64,
        Geometry::Cube => 12,
        Geometry::Rectangle => 2,
        Geometry::Sphere { .. } | Geometry::Disk | Geometry::Cylinder { .. } => 1,
    }
}

impl Shapes {
    /// Room for all meshes at once: columns that double as they grow would leave half of it empty.
    fn reserve(&mut self, shapes: &[Shape]) {
        let meshes = || {
            shapes.iter().filter_map(|shape| match &shape.geometry {
                Geometry::Mesh { mesh, .. } => Some(mesh),
                _ => None,
            })
        };
        let triangles = meshes().map(|mesh| mesh.triangles.len()).sum();
        let vertices = |mapped| {
            let column = meshes().filter(move |mesh| mesh.uvs.is_empty() != mapped);
            column.map(|mesh| mesh.positions.len()).sum()
        };
        self.surfaces.vertices.plain.reserve_exact(vertices(false));
        self.surfaces.vertices.mapped.reserve_exact(vertices(true));
        self.surfaces.triangles.reserve_exact(triangles);
        self.surfaces.shape_of.reserve_exact(triangles);
        self.references.reserve_exact(triangles);
    }

    fn add(
        &mut self,
        shape: Shape,
        named: &Named,
        metered: bool,
        lights: &mut Vec<Light>,
    ) -> Result<(), CompileError> {
        let to_world = &shape.to_world;
        let mesh = match &shape.geometry {
            Geometry::Mesh { mesh, .. } => named.meshes.of(mesh),
            _ => attributes::NONE,
        };
        let first = self.surfaces.shape_of.len() as u32;
        let references = self.references.len();
        let (material, varies) = named.materials[shape.material.0 as usize];
        let is_drawn_from = metered || shape.radiance.is_some();
        let (class, first_in_class, emitting) = match shape.geometry {
            Geometry::Rectangle => {
                let add = |all: &mut Surfaces| mesh::add_rectangle(all, to_world);
                self.add_triangles(is_drawn_from, add, Emitting::quadrilateral)
            }
            Geometry::Cube => {
                let add = |all: &mut Surfaces| mesh::add_cube(all, to_world);
                self.add_triangles(is_drawn_from, add, Emitting::triangles)
            }
            Geometry::Mesh { mesh, face_normals } => {
                // The mesh is the closure's, and gone before there are references.
                let add = move |all: &mut Surfaces| mesh::add_mesh(all, &mesh, to_world, face_normals);
                self.add_triangles(is_drawn_from, add, Emitting::triangles)
            }
            Geometry::Sphere { center, radius } => {
                let row = canonical::sphere(to_world, center, radius);
                self.refer(row.sphere.bounds(), SPHERE);
                self.surfaces.spheres.push(row);
                (
                    Class::Sphere { mapped: varies },
                    self.surfaces.spheres.len() - 1,
                    Emitting::Sphere(row.sphere),
                )
            }
            Geometry::Disk => self.add_canonical(canonical::disk(to_world)),
            Geometry::Cylinder { p0, p1, radius } => {
                self.add_canonical(canonical::cylinder(to_world, p0, p1, radius))
            }
        };
        let bounds = self.references[references..].iter().fold(Aabb::EMPTY, |b, r| b.union(r.aabb()));
        // Extents are squared in areas; half the exponent range is the end of it.
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        if self.references.len() > references && !(reach.is_finite() && reach < 1e18) {
            return Err(CompileError::OutOfRange { shape: shape.name });
        }
        let side = if shape.flip_normals { -1.0 } else { 1.0 };
        let extent = emitter_extent(&emitting);
        if metered && self.references.len() > references {
            self.metered = Some(Metered { shape: emitting.clone(), side, extent });
        }
        let light = match shape.radiance {
            Some(radiance) if self.references.len() > references => {
                lights.push(Light::Area(AreaLight { radiance, shape: emitting, side, extent, bounds }));
                LightId(lights.len() as u32 - 1)
            }
            _ => LightId::NONE,
        };
        self.surfaces.attributed |= mesh != attributes::NONE;
        self.surfaces.shapes.push(ShapeRow {
            first,
            first_in_class: first_in_class as u32,
            class,
            material,
            light,
            side,
            mesh,
        });
        Ok(())
    }

    /// Numbers a primitive and, if it can be hit, hands it to the tree.
    fn refer(&mut self, bounds: Aabb, class: u8) {
        let index = self.number();
        self.references.push(Reference::new(bounds, index, class));
    }

    fn number(&mut self) -> u32 {
        let index = self.surfaces.shape_of.len() as u32;
        self.surfaces.shape_of.push(self.surfaces.shapes.len() as u32);
        index
    }

    /// Numbers the triangles that `add` adds. Those of a shape of which points are drawn are kept for that, too.
    fn add_triangles(
        &mut self,
        is_drawn_from: bool,
        add: impl FnOnce(&mut Surfaces) -> Interpolated,
        together: fn(Vec<Triangle>) -> Emitting,
    ) -> (Class, usize, Emitting) {
        let first = self.surfaces.triangles.len();
        let Interpolated { uv, normal } = add(&mut self.surfaces);
        let (mut emitting, mut degenerate) = (Vec::new(), 0);
        for index in first..self.surfaces.triangles.len() {
            let triangle = self.surfaces.triangle(index, uv);
            if triangle.e1().cross(triangle.e2()) == Vec3::ZERO {
                // Its determinant would be noise: a hit where there is nothing.
                self.number();
                degenerate += 1;
            } else {
                self.refer(triangle.bounds(), TRIANGLE);
                if is_drawn_from {
                    emitting.push(triangle);
                }
            }
        }
        if degenerate > 0 {
            let shape = self.surfaces.shapes.len() as u32;
            self.degenerate.push(Degenerate { group: None, shape, triangles: degenerate });
        }
        (Class::Triangles { uv, normal }, first, together(emitting))
    }

    fn add_canonical(&mut self, row: CanonicalRow) -> (Class, usize, Emitting) {
        self.refer(row.surface.bounds, CANONICAL);
        let [x, y, z] = row.axes;
        let area = match row.surface.kind {
            CanonicalKind::Disk => std::f32::consts::PI * x.cross(y).length(),
            CanonicalKind::Cylinder => std::f32::consts::TAU * x.length() * z.length(),
        };
        let emitting =
            Emitting::Canonical { kind: row.surface.kind, axes: row.axes, origin: row.origin, area };
        self.surfaces.canonicals.push(row);
        (Class::Canonical, self.surfaces.canonicals.len() - 1, emitting)
    }
}

fn emitter_extent(emitting: &Emitting) -> Vec3 {
    match emitting {
        Emitting::Sphere(sphere) => Vec3::splat(sphere.radius),
        Emitting::Rectangle(rectangle) => rectangle.extent(),
        Emitting::Triangles { triangles, .. } => {
            triangles.iter().fold(Vec3::ZERO, |extent, t| extent.max(t.e1().abs() + t.e2().abs()))
        }
        Emitting::Canonical { axes, .. } => axes.iter().fold(Vec3::ZERO, |sum, axis| sum + axis.abs()),
    }
}

impl Surfaces {
    #[inline]
    fn triangle(&self, index: usize, uv: Interpolate) -> Triangle {
        let [v0, v1, v2] = self.vertices.positions(uv, self.triangles[index]);
        Triangle::new(v0, v1, v2)
    }

    /// The vertices of a primitive that is a triangle.
    pub(super) fn corners(&self, id: u32) -> Option<[Vec3; 3]> {
        let shape = self.shape(id);
        let index = (id - shape.first + shape.first_in_class) as usize;
        match shape.class {
            Class::Triangles { uv, .. } => Some(self.vertices.positions(uv, self.triangles[index])),
            Class::Sphere { .. } | Class::Canonical => None,
        }
    }

    /// What the kernels need of a primitive.
    #[inline]
    pub(super) fn primitive(&self, id: u32) -> Primitive {
        let shape = self.shape(id);
        let index = (id - shape.first + shape.first_in_class) as usize;
        match shape.class {
            Class::Triangles { uv, .. } => Primitive::Triangle(self.triangle(index, uv)),
            Class::Sphere { .. } => Primitive::Sphere(self.spheres[index].sphere),
            Class::Canonical => Primitive::Canonical(self.canonicals[index].surface),
        }
    }
}
