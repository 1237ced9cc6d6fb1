//! Values that meshes bring along: at vertices, linear between them, or on faces.
//!
//! ```text
//! a(b, c) = a₀ + b (a₁ − a₀) + c (a₂ − a₀)
//! ```
//!
//! with the barycentric weights b and c of a triangle's second and third corner.

use std::sync::Arc;

use glam::Vec3;

use super::Coordinates;
use crate::simd::{Bits, MOST, Real, Vector3};

/// One attribute of every mesh that has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshAttribute {
    /// By [`Coordinates::mesh`]; `None` is 0 everywhere.
    pub columns: Vec<Option<Column>>,
}

/// The values of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// At vertices.
    Vertices {
        /// By triangle: places in `values`.
        corners: Arc<[[u32; 3]]>,
        /// By vertex.
        values: Vec<Vec3>,
    },
    /// By triangle.
    Faces(Vec<Vec3>),
}

impl Column {
    /// The values at a triangle's corners.
    fn corners(&self, face: u32) -> [Vec3; 3] {
        match self {
            Self::Vertices { corners, values } => corners[face as usize].map(|i| values[i as usize]),
            Self::Faces(values) => [values[face as usize]; 3],
        }
    }
}

impl MeshAttribute {
    /// The value where each lane looks it up, 0 off meshes that have it.
    #[inline]
    pub(super) fn fetch<R: Real>(&self, at: Coordinates<R>) -> Vector3<R> {
        let mut corners = [[Vec3::ZERO; 3]; MOST];
        for (i, corners) in corners[..R::LANES].iter_mut().enumerate() {
            if let Some(Some(column)) = self.columns.get(at.mesh.lane(i) as usize) {
                *corners = column.corners(at.face.lane(i));
            }
        }
        let value = |k: usize| Vector3::<R>::from_fn(|i| corners[i][k]);
        let (b, c) = at.weights;
        let origin = value(0);
        origin + ((value(1) - origin).scale(b) + (value(2) - origin).scale(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{f32x8, u32x8};

    #[test]
    fn vertices_are_linear_and_faces_are_what_they_are() {
        let corners: Arc<[[u32; 3]]> = [[0, 1, 2], [2, 1, 3]].into();
        let values = [1.0, 2.0, 4.0, 8.0].map(|x| Vec3::new(x, -x, 0.5)).to_vec();
        let faces = vec![Vec3::splat(0.1), Vec3::new(0.3, 0.7, 0.9)];
        let columns = vec![None, Some(Column::Vertices { corners, values }), Some(Column::Faces(faces))];
        let attribute = MeshAttribute { columns };
        let at = |mesh, face, weights| Coordinates::<f32> { u: 0.0, v: 0.0, mesh, face, weights };
        let look = |mesh, face, weights| Vec3::from(attribute.fetch(at(mesh, face, weights)));
        assert_eq!(look(1, 0, (0.25, 0.5)), Vec3::new(2.75, -2.75, 0.5));
        assert_eq!(look(1, 1, (0.0, 1.0)), Vec3::new(8.0, -8.0, 0.5));
        assert_eq!(look(2, 1, (0.3, 0.3)), Vec3::new(0.3, 0.7, 0.9));
        for nowhere in [0, 3, u32::MAX] {
            assert_eq!(look(nowhere, 0, (0.2, 0.2)), Vec3::ZERO);
        }
        let mesh = |i: usize| [1, 2, 0, u32::MAX][i % 4];
        let (b, c) = (|i: usize| 0.1 * i as f32, |i: usize| 0.3 - 0.04 * i as f32);
        let eight = attribute.fetch(Coordinates::<f32x8> {
            u: f32x8::zero(),
            v: f32x8::zero(),
            mesh: u32x8::from_fn(mesh),
            face: u32x8::from_fn(|i| i as u32 % 2),
            weights: (f32x8::from_fn(b), f32x8::from_fn(c)),
        });
        for i in 0..8 {
            assert_eq!(eight.lane(i), look(mesh(i), i as u32 % 2, (b(i), c(i))), "{i}");
        }
    }
}
