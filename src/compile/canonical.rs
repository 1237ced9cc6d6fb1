//! Spheres, disks and cylinders, in world space.

use glam::{DAffine3, DMat3, DVec3};

use super::surfaces::{CanonicalRow, SphereRow};
use crate::geometry::{Aabb, Affine, Canonical, CanonicalKind, Sphere};

/// A sphere under a similarity.
pub(super) fn sphere(to_world: &DAffine3, center: DVec3, radius: f64) -> SphereRow {
    let m = to_world.matrix3;
    let scale = m.x_axis.length();
    let rotation = DMat3::from_cols(m.x_axis / scale, m.y_axis / scale, m.z_axis / scale);
    SphereRow {
        sphere: Sphere {
            center: to_world.transform_point3(center).as_vec3(),
            radius: (radius * scale) as f32,
        },
        // Rows of the inverse of a rotation are its columns.
        to_local: [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(DVec3::as_vec3),
    }
}

/// The unit disk under an affine map.
pub(super) fn disk(to_world: &DAffine3) -> CanonicalRow {
    row(CanonicalKind::Disk, to_world)
}

/// The canonical cylinder, taken to `p0`, `p1` and `radius`, then to the world.
///
/// About an axis that is not +z, the zero angle is along the first tangent of the branchless basis
/// \[DBC17\].
pub(super) fn cylinder(to_world: &DAffine3, p0: DVec3, p1: DVec3, radius: f64) -> CanonicalRow {
    let n = (p1 - p0).normalize();
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let s = DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let t = DVec3::new(b, sign + n.y * n.y * a, -n.y);
    let placed = DAffine3 { matrix3: DMat3::from_cols(s * radius, t * radius, p1 - p0), translation: p0 };
    row(CanonicalKind::Cylinder, &(*to_world * placed))
}

fn row(kind: CanonicalKind, to_world: &DAffine3) -> CanonicalRow {
    let (m, origin) = (to_world.matrix3, to_world.translation);
    // A circle reaches √(x² + y²) along each world axis, x and y the images of its radii.
    let reach = |i: usize| m.x_axis[i].hypot(m.y_axis[i]);
    let reach = DVec3::new(reach(0), reach(1), reach(2));
    let ends = match kind {
        CanonicalKind::Disk => vec![origin],
        CanonicalKind::Cylinder => vec![origin, origin + m.z_axis],
    };
    let corners = ends.iter().flat_map(|&end| [end - reach, end + reach]);
    let bounds = Aabb::of_points(corners.map(DVec3::as_vec3));
    // Rounding outwards: the surface is inside, however its corners rounded.
    let slack = (bounds.min.abs().max(bounds.max.abs())) * f32::EPSILON;
    let bounds = Aabb { min: bounds.min - slack, max: bounds.max + slack };
    CanonicalRow {
        surface: Canonical { kind, to_canonical: Affine::from(&to_world.inverse()), bounds },
        axes: [m.x_axis, m.y_axis, m.z_axis].map(DVec3::as_vec3),
        origin: origin.as_vec3(),
        normal: super::mesh::normal_matrix(to_world).z_axis.normalize().as_vec3(),
    }
}
