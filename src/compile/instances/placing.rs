//! An instance's maps and its box.

use glam::{DAffine3, DMat3, DVec3};

use crate::bvh::{Bvh, Kind, Node};
use crate::geometry::{Aabb, Affine, Placement};

/// Boxes that together hold all of a group's tree: up to 64, from the second level of nodes, so that a turned
/// instance has a box not much larger than what is in it.
pub(super) fn parts(bvh: &Bvh) -> Vec<Aabb> {
    let boxes =
        |node: &Node| [0, 1, 2, 3, 4, 5, 6, 7].map(|i| (node.child_bounds(i), node.children[i].kind()));
    let Some(root) = bvh.nodes().first() else { return vec![] };
    let below = boxes(root).into_iter().flat_map(|(bounds, kind)| match kind {
        Kind::Absent => vec![],
        Kind::Leaf { .. } => vec![bounds],
        Kind::Inner(index) => {
            let there = |(bounds, kind)| (kind != Kind::Absent).then_some(bounds);
            boxes(&bvh.nodes()[index as usize]).into_iter().filter_map(there).collect()
        }
    });
    below.collect()
}

/// Ulps of |M| |p| + |m|, taken back to the world, by which the box is wider than the group's parts: five
/// roundings take a point to the group's space, and M and m are rounded themselves.
const SLACK: f64 = 4.0 * f32::EPSILON as f64;

/// The farthest that coordinates, and factors of scale, may go: what is squared stays within 32-bit floats.
const LIMIT: f64 = 1e18;

/// Where a group that is in `parts` stands; `None` beyond what 32-bit floats can hold.
pub(super) fn place(to_world: &DAffine3, parts: &[Aabb]) -> Option<Placement> {
    let inverse = to_world.inverse();
    let (forth, back) = (abs(to_world.matrix3), abs(inverse.matrix3));
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for part in parts {
        let (low, high) = (part.min.as_dvec3(), part.max.as_dvec3());
        let centre = to_world.transform_point3((low + high) * 0.5);
        let half = forth * ((high - low) * 0.5);
        (min, max) = (min.min(centre - half), max.max(centre + half));
    }
    let reach = if parts.is_empty() { DVec3::ZERO } else { min.abs().max(max.abs()) };
    let slack = forth * (back * reach + inverse.translation.abs()) * SLACK + reach * f64::from(f32::EPSILON);
    let bounds = Aabb { min: (min - slack).as_vec3(), max: (max + slack).as_vec3() };
    let sizes = [forth, back].map(|m| m.x_axis.max(m.y_axis).max(m.z_axis).max_element());
    let shifts = [to_world, &inverse].map(|map| map.translation.abs().max_element());
    let greatest = sizes.into_iter().chain(shifts).fold((reach + slack).max_element(), f64::max);
    // NaN is not less than anything.
    let holds =
        greatest < LIMIT && (reach + slack).is_finite() && shifts.iter().all(|shift| shift.is_finite());
    holds.then(|| Placement { to_group: Affine::from(&inverse), to_world: Affine::from(to_world), bounds })
}

fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_the_corners_of_its_parts_and_little_more() {
        let unit = Aabb { min: glam::Vec3::splat(-1.0), max: glam::Vec3::ONE };
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.7, 1.0, 0.0), DVec3::new(-0.2, 0.4, 1.0));
        for scale in [DVec3::ONE, DVec3::new(-1.0, 2.0, 0.5), DVec3::splat(1e-3), DVec3::splat(1e6)] {
            for shift in [0.0, 3.0, -1e5] {
                let map = DAffine3::from_translation(DVec3::new(shift, 1.0, -shift))
                    * DAffine3::from_mat3(shear)
                    * DAffine3::from_rotation_z(0.3)
                    * DAffine3::from_scale(scale);
                let bounds = place(&map, &[unit]).unwrap().bounds;
                let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                for i in 0..8 {
                    let side = |bit: i32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                    let corner = map.transform_point3(DVec3::new(side(0), side(1), side(2)));
                    (min, max) = (min.min(corner), max.max(corner));
                }
                let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
                assert!(low.cmple(min).all() && high.cmpge(max).all(), "{map:?}");
                let reach = max.abs().max(min.abs()).max_element();
                let room = 1e-4 * ((max - min).max_element() + reach);
                assert!((min - low).max((high - max).abs()).max_element() < room, "{map:?}: {bounds:?}");
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let unit = [Aabb { min: glam::Vec3::splat(-1.0), max: glam::Vec3::ONE }];
        for scale in [1e-19, 1e19, 0.0, f64::NAN] {
            assert!(place(&DAffine3::from_scale(DVec3::splat(scale)), &unit).is_none(), "{scale}");
        }
        assert!(place(&DAffine3::from_translation(DVec3::X * 1e30), &unit).is_none());
        assert!(place(&DAffine3::IDENTITY, &[]).is_some());
    }
}
