//! Does a ray cross a triangle? Asked again, where rounding could decide.
//!
//! Two triangles that share an edge must not both say that a ray is outside of it. Here each vertex is sheared
//! into the ray's frame by itself, so that it lands on the same point in every triangle that has it, and an
//! edge is the cross product of two such points, which changes its sign exactly when they change places
//! \[WBW13\]. Rounding is monotone: a difference of rounded products never has the wrong sign, it is at worst
//! zero, and zero belongs to both sides. So what is decided is decided as in exact arithmetic on points that
//! the triangles have in common, and there is nothing between them.
//!
//! In double precision the points are within 2⁻⁵⁰ of where they should be, relative to their distance: a box
//! around the triangle is touched too, with the room that [`aabb`](super::aabb) has.

use glam::{DVec3, Vec3};

/// (t, u, v) where the line through `org` along `dir` crosses a triangle, its edges included.
#[cold]
#[inline(never)]
pub(super) fn crossing(org: Vec3, dir: Vec3, vertices: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let (org, dir) = (org.as_dvec3(), dir.as_dvec3());
    let size = dir.abs();
    // Along z, the greatest component, lies the ray.
    let z = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let (slope_x, slope_y) = (dir[x] / dir[z], dir[y] / dir[z]);
    let [a, b, c] = vertices.map(|vertex| {
        let p = vertex.as_dvec3() - org;
        DVec3::new(p[x] - slope_x * p[z], p[y] - slope_y * p[z], p[z])
    });
    let edge = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
    let (w, u, v) = (edge(b, c), edge(c, a), edge(a, b));
    let inside = (w >= 0.0 && u >= 0.0 && v >= 0.0) || (w <= 0.0 && u <= 0.0 && v <= 0.0);
    let det = w + u + v;
    let t = (w * a.z + u * b.z + v * c.z) / det / dir[z];
    (inside && det != 0.0).then_some((t as f32, (u / det) as f32, (v / det) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::seeds::Random;

    #[test]
    fn a_fan_around_a_vertex_has_no_gap() {
        let mut random = Random::new(17);
        for _ in 0..20_000 {
            let centre = random.vector();
            let ring: Vec<Vec3> = (0..7)
                .map(|i| {
                    let angle = i as f32 * 0.9;
                    centre + Vec3::new(angle.cos(), angle.sin(), 0.3 * random.signed()) * 0.01
                })
                .collect();
            let org = centre + Vec3::new(random.signed(), random.signed(), 3.0);
            // At the vertex, and at a point of an edge.
            for target in [centre, centre + (ring[2] - centre) * 0.3] {
                let crossed = (0..7)
                    .any(|i| crossing(org, target - org, [centre, ring[i], ring[(i + 1) % 7]]).is_some());
                assert!(crossed, "{org} {target} {ring:?}");
            }
        }
    }

    #[test]
    fn winding_does_not_matter_and_flat_triangles_are_missed() {
        let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let (org, dir) = (Vec3::new(0.25, 0.5, 2.0), -Vec3::Z);
        assert_eq!(crossing(org, dir, [a, b, c]), Some((2.0, 0.25, 0.5)));
        assert_eq!(crossing(org, dir, [a, c, b]), Some((2.0, 0.5, 0.25)));
        assert_eq!(crossing(org, dir * 4.0, [a, b, c]), Some((0.5, 0.25, 0.5)));
        assert_eq!(crossing(org, dir, [a, b, b * 2.0]), None);
        assert_eq!(crossing(org, Vec3::X, [a, b, c]), None);
        assert_eq!(crossing(org, dir, [a + 1.0, b, c]), None);
        // Along each axis, where all other components are 0.
        for turn in 0..3 {
            let turned = |v: Vec3| Vec3::from_array(std::array::from_fn(|i| v[(i + turn) % 3]));
            let [a, b, c] = [turned(a), turned(b), turned(c)];
            assert_eq!(crossing(turned(org), turned(dir), [a, b, c]), Some((2.0, 0.25, 0.5)), "{turn}");
        }
    }

    /// Rays along every axis, and between them, through points that are known, inside and outside.
    #[test]
    fn points_are_found_whatever_the_greatest_component() {
        let mut random = Random::new(23);
        let mut crossed = 0;
        for _ in 0..20_000 {
            let [a, b, c, org] = std::array::from_fn(|_| random.vector());
            let (u, v) = (random.signed(), random.signed());
            let (e1, e2) = (b - a, c - a);
            let dir = (a + e1 * u + e2 * v - org) * (1.5 + random.signed());
            // Neither flat nor edge-on, and not so near to an edge that rounding would tell.
            let steep = e1.cross(e2).dot(dir).abs() > 0.05 * e1.length() * e2.length() * dir.length();
            let least = u.min(v).min(1.0 - u - v);
            if !steep || dir.length() < 0.1 || least.abs() < 1e-3 {
                continue;
            }
            let want = DVec3::new(
                f64::from((a + e1 * u + e2 * v - org).length() / dir.length()),
                u.into(),
                v.into(),
            );
            let got = crossing(org, dir, [a, b, c]).map(|(t, u, v)| Vec3::new(t, u, v).as_dvec3());
            assert_eq!(got.is_some(), least > 0.0, "{got:?} {want}");
            if let Some(got) = got {
                crossed += 1;
                assert!(got.abs_diff_eq(want, 1e-4 * want.x.max(1.0)), "{got} {want}");
            }
        }
        assert!(crossed > 1000, "{crossed}");
    }
}
