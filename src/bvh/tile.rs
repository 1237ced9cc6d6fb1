//! Two hundred and fifty-six rays through the tree together: sixteen bundles into one octant.
//!
//! A node is tested by the bounds of all rays against its eight boxes (lanes are boxes), then by the bounds
//! of the sixteen bundles against each box that is left (lanes are bundles). At a leaf, the planes through a
//! triangle's edges and the common origin cull bundles, and the kernel decides about the others. A step that
//! a bundle would take sixteen times is so taken once.

use super::{
    Bvh, Child, Hitx16, Kind, Leaves, Tally, Traversal, beam::Beam, bundle::BUNDLE, cost::Cost, stream::TILE,
};
use crate::geometry::Rayx16;
use crate::simd::{Mask, Mask16, Real, f32x16};

/// Up to so many bundles, each tests a leaf's box with its rays.
const FEW: u32 = 4;

impl Bvh {
    /// Traces a tile, whose bundles the beams are around; `hits` as for [`Bvh::intersect_packet`]. `step` is called at each
    /// node and leaf. Returns what it cost.
    pub(super) fn intersect_tile<const ANY: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        (rays, beams): (&[&Rayx16; TILE], &Beam<f32x16>),
        hits: &mut [Hitx16; TILE],
        mut step: impl FnMut(),
        traversal: &mut Traversal<T>,
    ) -> Cost {
        let mut cost = Cost::TILE;
        if self.nodes.is_empty() {
            return cost;
        }
        let (all, pencils) = (beams.around(), beams.pencils());
        let Traversal { stack, tally, .. } = traversal;
        let mut farthest = f32x16::from_fn(|i| hits[i].t.reduce_max());
        let mut end = farthest.reduce_max();
        let mut masks = [0u16; super::STACK];
        stack[0] = (Child::inner(0), f32::NEG_INFINITY);
        masks[0] = u16::MAX;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            step();
            let ((child, enter), mask) = (stack[top], u32::from(masks[top]));
            if enter > end {
                continue;
            }
            let mask = mask & f32x16::splat(enter).le(farthest).to_bitmask();
            match child.kind() {
                Kind::Absent => {}
                Kind::Inner(index) => {
                    let node = &self.nodes[index as usize];
                    (0..mask.count_ones()).for_each(|_| tally.node(BUNDLE as u32));
                    let (candidates, enters, distances) = all.children_and_distances(node, end);
                    let enters = enters.to_array();
                    let mut candidates = candidates.to_bitmask();
                    cost += Cost::TILE_NODE + Cost::TILE_CHILD * candidates.count_ones();
                    let bottom = top;
                    while candidates != 0 {
                        let place = candidates.trailing_zeros() as usize;
                        candidates &= candidates - 1;
                        let meets = match pencils {
                            Some(_) => beams.beams_from_one(&distances, place, farthest),
                            None => beams.beams(node, place, farthest),
                        };
                        let mut mask = mask & meets.to_bitmask();
                        let child = node.children[place];
                        // Planes are tested once for all bundles: no box is worth it for more than a few.
                        if child.is_leaf() && (pencils.is_none() || mask.count_ones() <= FEW) {
                            mask = those_with(mask, |bundle| {
                                let (rays, t_far) = (rays[bundle], hits[bundle].t);
                                match pencils {
                                    Some(_) => distances.entered(place, rays, t_far),
                                    None => beams.rays(node, place, rays, t_far),
                                }
                            });
                        }
                        if mask != 0 {
                            self.ask_for(child, leaves);
                            let mut at = top;
                            while at > bottom && stack[at - 1].1 < enters[place] {
                                (stack[at], masks[at]) = (stack[at - 1], masks[at - 1]);
                                at -= 1;
                            }
                            (stack[at], masks[at]) = ((child, enters[place]), mask as u16);
                            top += 1;
                        }
                    }
                }
                Kind::Leaf { first, count } => {
                    let pencils = pencils.as_ref();
                    let (tests, mut nearer) =
                        leaves.intersect_tile::<ANY>((first, count), rays, pencils, mask, hits);
                    tally.leaf(tests, BUNDLE as u32);
                    cost += Cost::TILE_LEAF + Cost::TILE_PLANES * count + Cost::PACKET_TEST * tests;
                    if nearer == 0 {
                        continue;
                    }
                    let mut limits = farthest.to_array();
                    while nearer != 0 {
                        let bundle = nearer.trailing_zeros() as usize % TILE;
                        nearer &= nearer - 1;
                        limits[bundle] = hits[bundle].t.reduce_max();
                    }
                    farthest = f32x16::new(limits);
                    end = farthest.reduce_max();
                    if ANY && end == f32::NEG_INFINITY {
                        break;
                    }
                }
            }
        }
        cost
    }
}

/// Which of the bundles in `mask` have a ray that enters.
#[inline(always)]
fn those_with(mask: u32, enters: impl Fn(usize) -> Mask16) -> u32 {
    let (mut entered, mut left) = (0, mask);
    while left != 0 {
        let bundle = left.trailing_zeros() as usize % TILE;
        left &= left - 1;
        entered |= u32::from(enters(bundle).any()) << bundle;
    }
    entered
}
