//! Shapes made of triangles, in world space.

use std::iter::repeat;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, vec2};

use super::{
    surfaces::{Interpolate, Surfaces},
    vertices::{Mapped, Vertex},
};
use crate::math::acos;
use crate::scene::Mesh;

/// What a shape's triangles get from their vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolated {
    pub(super) uv: Interpolate,
    pub(super) normal: Interpolate,
}

/// Adds a loaded mesh. Without normals of its own it gets smooth ones. Nothing is held twice: a mesh may be
/// as big as memory allows.
pub(super) fn add_mesh(
    surfaces: &mut Surfaces,
    mesh: &Mesh,
    to_world: &DAffine3,
    face_normals: bool,
) -> Interpolated {
    let normals = normal_matrix(to_world);
    let vertex = |i: usize, p: &Vec3| {
        let position = to_world.transform_point3(p.as_dvec3()).as_vec3();
        let given = mesh.normals.get(i).filter(|_| !face_normals);
        let normal = given.map_or(Vec3::ZERO, |n| (normals * n.as_dvec3()).normalize_or_zero().as_vec3());
        Vertex { position, normal }
    };
    let vertices = mesh.positions.iter().enumerate().map(|(i, p)| vertex(i, p));
    let smoothed = (!face_normals && mesh.normals.is_empty()).then_some(mesh.triangles.as_slice());
    let uv = if mesh.uvs.is_empty() { Interpolate::Face } else { Interpolate::Vertices };
    let first = match uv {
        Interpolate::Face => add_vertices(&mut surfaces.vertices.plain, vertices, smoothed),
        Interpolate::Vertices => {
            let uvs = mesh.uvs.iter().copied().chain(repeat(Vec2::ZERO));
            let mapped = vertices.zip(uvs).map(|(vertex, uv)| Mapped { vertex, uv });
            add_vertices(&mut surfaces.vertices.mapped, mapped, smoothed)
        }
    };
    surfaces.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    Interpolated { uv, normal: if face_normals { Interpolate::Face } else { Interpolate::Vertices } }
}

/// Adds vertices to their column, and smooth normals if they are to be had from triangles. Returns where the first is.
fn add_vertices<V: AsRef<Vertex> + AsMut<Vertex>>(
    column: &mut Vec<V>,
    vertices: impl Iterator<Item = V>,
    smoothed: Option<&[[u32; 3]]>,
) -> u32 {
    let first = column.len();
    column.extend(vertices);
    if let Some(triangles) = smoothed {
        smooth_normals(&mut column[first..], triangles);
    }
    first as u32
}

/// The inverse transpose: what takes normals into the world.
pub(super) fn normal_matrix(to_world: &DAffine3) -> DMat3 {
    to_world.matrix3.inverse().transpose()
}

/// Sums of face normals, weighted by the angle of the corner, so that how a face is cut into triangles
/// does not matter (Thürmer & Wüthrich 1998).
fn smooth_normals<V: AsRef<Vertex> + AsMut<Vertex>>(vertices: &mut [V], triangles: &[[u32; 3]]) {
    for corners in triangles {
        let p = corners.map(|i| vertices[i as usize].as_ref().position);
        let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for k in 0..3 {
            let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let cos = a.normalize_or_zero().dot(b.normalize_or_zero());
            vertices[corners[k] as usize].as_mut().normal += face * acos(cos);
        }
    }
    for vertex in vertices {
        let vertex = vertex.as_mut();
        vertex.normal = vertex.normal.normalize_or_zero();
    }
}

/// A quadrilateral: centre, two half edges along which u and v grow, and the side it is seen from.
struct Face {
    centre: DVec3,
    du: DVec3,
    dv: DVec3,
    normal: DVec3,
}

/// [-1, 1]² in xy.
pub(super) fn add_rectangle(surfaces: &mut Surfaces, to_world: &DAffine3) -> Interpolated {
    faces(surfaces, to_world, &[Face { centre: DVec3::ZERO, du: DVec3::X, dv: DVec3::Y, normal: DVec3::Z }])
}

/// [-1, 1]³; the directions of uv are those of the format's table.
pub(super) fn add_cube(surfaces: &mut Surfaces, to_world: &DAffine3) -> Interpolated {
    let face = |normal: DVec3, du, dv| Face { centre: normal, du, dv, normal };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    faces(
        surfaces,
        to_world,
        &[face(x, y, -z), face(-x, y, z), face(y, -x, -z), face(-y, z, x), face(z, y, x), face(-z, -y, x)],
    )
}

fn faces(surfaces: &mut Surfaces, to_world: &DAffine3, faces: &[Face]) -> Interpolated {
    let mirrored = to_world.matrix3.determinant() < 0.0;
    for face in faces {
        let vertices = &mut surfaces.vertices.mapped;
        let first = vertices.len() as u32;
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let local = face.centre + face.du * (2.0 * s - 1.0) + face.dv * (2.0 * t - 1.0);
            let position = to_world.transform_point3(local).as_vec3();
            let vertex = Vertex { position, normal: Vec3::ZERO };
            vertices.push(Mapped { vertex, uv: vec2(s as f32, t as f32) });
        }
        // The winding makes e₁ × e₂ the normal, in the world too.
        let agrees = (face.du.cross(face.dv).dot(face.normal) > 0.0) != mirrored;
        let corners = if agrees { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
        surfaces.triangles.extend(corners.map(|t| t.map(|i| i + first)));
    }
    Interpolated { uv: Interpolate::Vertices, normal: Interpolate::Face }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_look_outward_even_when_mirrored() {
        for scale in [DVec3::ONE, DVec3::new(-1.0, 2.0, 1.0)] {
            let mut mesh = Surfaces::default();
            add_cube(&mut mesh, &DAffine3::from_scale(scale));
            assert_eq!(mesh.triangles.len(), 12);
            for t in &mesh.triangles {
                let [a, b, c] = mesh.vertices.positions(Interpolate::Vertices, *t);
                assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
            }
        }
    }

    #[test]
    fn smooth_normals_do_not_depend_on_the_diagonal() {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let mut positions: Vec<Vec3> = corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect();
        positions.push(Vec3::new(-1.0, -1.0, 2.0));
        positions.push(Vec3::new(1.0, -1.0, 2.0));
        let wall = [[0, 4, 5], [0, 5, 1]];
        let floor = |diagonal: [[u32; 3]; 2]| -> Vec<Vec3> {
            let mut vertices: Vec<Vertex> =
                positions.iter().map(|&position| Vertex { position, normal: Vec3::ZERO }).collect();
            smooth_normals(&mut vertices, &[wall.as_slice(), &diagonal].concat());
            vertices.iter().map(|v| v.normal).collect()
        };
        let (a, b) = (floor([[0, 1, 2], [0, 2, 3]]), floor([[0, 1, 3], [1, 2, 3]]));
        for (a, b) in a.iter().zip(&b) {
            assert!((*a - *b).length() < 1e-6, "{a} {b}");
        }
        assert!((a[0] - Vec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-6, "{}", a[0]);
    }
}
