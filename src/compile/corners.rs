//! Corners of triangles in the order of leaves, in which nothing foretells where in memory they are: it is asked ahead.

use glam::Vec3;

use super::surfaces::{Class, Interpolate, Surfaces};
use crate::simd::prefetch;

/// Looks primitives up, of which neighbours mostly are of one shape.
pub(super) struct Corners<'a> {
    surfaces: &'a Surfaces,
    /// The last shape: its first primitive, and how many it has.
    first: u32,
    count: u32,
    /// If it has triangles, the first of them, and which column their vertices are in.
    triangles: Option<(u32, Interpolate)>,
}

impl<'a> Corners<'a> {
    pub(super) fn new(surfaces: &'a Surfaces) -> Self {
        Self { surfaces, first: 0, count: 0, triangles: None }
    }

    /// Asks memory for what says which vertices triangles have. [`u32::MAX`] is none here, as below.
    #[inline]
    pub(super) fn ask_for_indices(&mut self, ids: &[u32]) {
        for &id in ids {
            if let Some((index, _)) = self.place(id) {
                prefetch::<1>(self.surfaces.triangles.as_ptr().wrapping_add(index).cast());
            }
        }
    }

    /// Asks memory for the vertices of triangles.
    #[inline]
    pub(super) fn ask_for_vertices(&mut self, ids: &[u32]) {
        let vertices = &self.surfaces.vertices;
        for &id in ids {
            let Some((index, column)) = self.place(id) else { continue };
            for vertex in self.surfaces.triangles[index].map(|vertex| vertex as usize) {
                match column {
                    Interpolate::Vertices => {
                        prefetch::<1>(vertices.mapped.as_ptr().wrapping_add(vertex).cast());
                    }
                    Interpolate::Face => prefetch::<1>(vertices.plain.as_ptr().wrapping_add(vertex).cast()),
                }
            }
        }
    }

    /// The corners of a primitive that is a triangle.
    #[inline]
    pub(super) fn of(&mut self, id: u32) -> Option<[Vec3; 3]> {
        let (index, column) = self.place(id)?;
        Some(self.surfaces.vertices.positions(column, self.surfaces.triangles[index]))
    }

    /// The place of a primitive among triangles.
    #[inline]
    fn place(&mut self, id: u32) -> Option<(usize, Interpolate)> {
        if id.wrapping_sub(self.first) >= self.count {
            if id == u32::MAX {
                return None;
            }
            self.turn_to(id);
        }
        let (first, column) = self.triangles?;
        Some(((first + (id - self.first)) as usize, column))
    }

    fn turn_to(&mut self, id: u32) {
        let Surfaces { shape_of, shapes, .. } = self.surfaces;
        let number = shape_of[id as usize] as usize;
        let row = &shapes[number];
        let end = shapes.get(number + 1).map_or(shape_of.len() as u32, |next| next.first);
        (self.first, self.count) = (row.first, end - row.first);
        self.triangles = match row.class {
            Class::Triangles { uv, .. } => Some((row.first_in_class, uv)),
            Class::Sphere { .. } | Class::Canonical => None,
        };
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::compile::compile;
    use crate::scene::{Geometry, Material, MaterialIndex, Mesh, SceneDescription, Shape};

    #[test]
    fn corners_are_those_of_the_primitive_whatever_came_before() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let mesh = Geometry::Mesh { mesh: Arc::new(mesh), face_normals: false };
        let sphere = Geometry::Sphere { center: DVec3::ZERO, radius: 1.0 };
        let shapes = [mesh.clone(), sphere, Geometry::Rectangle, mesh].map(|geometry| Shape {
            name: "shape".into(),
            geometry,
            to_world: DAffine3::IDENTITY,
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        });
        let materials = vec![Material::default()];
        let description =
            SceneDescription { shapes: shapes.into(), materials, ..SceneDescription::default() };
        let surfaces = compile(&description).expect("it compiles").surfaces;
        let expected = |id| if id == u32::MAX { None } else { surfaces.corners(id) };
        let ids = || (0..surfaces.shape_of.len() as u32).chain([u32::MAX]);
        assert_eq!(ids().filter(|&id| expected(id).is_none()).count(), 2);
        for (before, id) in ids().flat_map(|before| ids().map(move |id| (before, id))) {
            let mut corners = Corners::new(&surfaces);
            for id in [before, id] {
                assert_eq!(corners.of(id), expected(id), "{id} after {before}");
            }
        }
    }
}
