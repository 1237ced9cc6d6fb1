//! Eight rays through the tree together.
//!
//! Where all rays of a packet point into the same octant, a node is tested twice: first the interval of
//! the whole packet against all eight boxes at once (lanes are boxes), then the eight rays against each
//! box that is left (lanes are rays). The first test never culls what the second would keep (see
//! `beam`).

use super::{Bvh, Child, HitLanes, Hitx8, Kind, Leaves, Node, Tally, Traversal, beam::Beam, cost::Cost};
use crate::geometry::{RayLanes, Rayx8, aabb};
use crate::simd::{Mask, Mask8, Mask16, Real, Vector3, f32x8, f32x16};

/// Lanes that may go as a packet: eight, or sixteen.
pub(super) trait Packet: Real {
    /// The least lane.
    fn least(self) -> f32;
    /// The greatest lane.
    fn greatest(self) -> f32;
    /// [`Leaves::intersect_packet`] or [`Leaves::intersect_bundle`].
    fn test<const ANY: bool, L: Leaves>(
        leaves: &L,
        leaf: (u32, u32),
        rays: (&RayLanes<Self>, Self::Mask),
        hit: &mut HitLanes<Self>,
    );
}

impl Packet for f32x8 {
    #[inline(always)]
    fn least(self) -> f32 {
        self.reduce_min()
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        self.reduce_max()
    }
    #[inline(always)]
    fn test<const ANY: bool, L: Leaves>(
        leaves: &L,
        (first, count): (u32, u32),
        (ray, active): (&RayLanes<Self>, Mask8),
        hit: &mut HitLanes<Self>,
    ) {
        leaves.intersect_packet::<ANY>(first, count, ray, active, hit);
    }
}

impl Packet for f32x16 {
    #[inline(always)]
    fn least(self) -> f32 {
        self.reduce_min()
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        self.reduce_max()
    }
    #[inline(always)]
    fn test<const ANY: bool, L: Leaves>(
        leaves: &L,
        (first, count): (u32, u32),
        (ray, active): (&RayLanes<Self>, Mask16),
        hit: &mut HitLanes<Self>,
    ) {
        leaves.intersect_bundle::<ANY>(first, count, ray, active, hit);
    }
}

impl Bvh {
    /// Traces the `active` rays of a packet; `hit` holds their limits in `t` and receives what is found.
    ///
    /// For `ANY`, lanes that are blocked get t = −∞. Lanes that are not active are left as they are.
    pub fn intersect_packet<const ANY: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        ray: &Rayx8,
        active: Mask8,
        hit: &mut Hitx8,
        traversal: &mut Traversal<T>,
    ) {
        if let Some(root) = self.nodes.first() {
            self.intersect_packet_from::<ANY, f32x8, L, T>(root, leaves, (ray, active), hit, traversal);
        }
    }

    /// The same from a node on, the root or an [entry](Bvh::entry). Returns what it cost.
    pub(super) fn intersect_packet_from<const ANY: bool, R: Packet, L: Leaves, T: Tally>(
        &self,
        start: &Node,
        leaves: &L,
        (ray, active): (&RayLanes<R>, R::Mask),
        hit: &mut HitLanes<R>,
        traversal: &mut Traversal<T>,
    ) -> Cost {
        let mut cost = Cost::PACKET;
        if active.none() {
            return cost;
        }
        let waiting = hit.t;
        // No box is entered before −∞: lanes without work fail every comparison by themselves.
        hit.t = R::select(active, hit.t, R::splat(f32::NEG_INFINITY));
        let beam = Beam::of_packet(ray, active);
        let Traversal { stack, blocker, tally } = traversal;
        let mut top = 0;
        let mut node = start;
        let mut farthest = hit.t.greatest();
        loop {
            tally.node(active.count());
            let below = &mut stack[top..];
            let (entered, tested) = match &beam {
                Some(beam) => (enter_together(node, ray, beam, hit.t, farthest, below), Cost::PACKET_NODE),
                None => (enter_apart(node, ray, hit.t, below), Cost::PACKET_NODE_APART),
            };
            top += entered;
            cost += tested + Cost::PACKET_CHILD * entered as u32;
            // Leaves, until there is a node again.
            node = loop {
                if top == 0 {
                    hit.t = R::select(active, hit.t, waiting);
                    return cost;
                }
                top -= 1;
                let (child, enter) = stack[top];
                if enter > farthest {
                    continue;
                }
                match child.kind() {
                    Kind::Absent => {}
                    Kind::Inner(index) => break &self.nodes[index as usize],
                    Kind::Leaf { first, count } => {
                        tally.leaf(count, active.count());
                        cost += Cost::PACKET_TEST * count;
                        R::test::<ANY, L>(leaves, (first, count), (ray, active), hit);
                        let before = farthest;
                        farthest = hit.t.greatest();
                        if ANY && farthest < before {
                            *blocker = child;
                        }
                        if ANY && farthest == f32::NEG_INFINITY {
                            top = 0;
                        }
                    }
                }
            };
        }
    }
}

/// Pushes the children that some ray enters, nearest last, and returns how many.
#[inline]
fn enter_together<R: Packet>(
    node: &Node,
    ray: &RayLanes<R>,
    beam: &Beam<f32x8>,
    t_far: R,
    farthest: f32,
    stack: &mut [(Child, f32)],
) -> usize {
    let (candidates, enters) = beam.children(node, farthest);
    let (mut candidates, enters) = (candidates.to_bitmask(), enters.to_array());
    let mut count = 0;
    while candidates != 0 {
        let place = candidates.trailing_zeros() as usize;
        candidates &= candidates - 1;
        if beam.rays(node, place, ray, t_far).any() {
            insert(stack, count, (node.children[place], enters[place]));
            count += 1;
        }
    }
    count
}

/// The same for rays that point anywhere.
#[inline]
fn enter_apart<R: Packet>(node: &Node, ray: &RayLanes<R>, t_far: R, stack: &mut [(Child, f32)]) -> usize {
    let mut count = 0;
    for place in 0..8 {
        if node.children[place] == Child::ABSENT {
            continue;
        }
        let bounds = node.child_bounds(place);
        let (low, high) = aabb::interval(
            (Vector3::splat(bounds.min), Vector3::splat(bounds.max)),
            (ray.org, ray.rdir),
            (ray.t_near, t_far),
        );
        let enters = low.le(high);
        if enters.any() {
            let first = R::select(enters, low, R::splat(f32::INFINITY)).least();
            insert(stack, count, (node.children[place], first));
            count += 1;
        }
    }
    count
}

/// Insertion into the `count` entries at the front, in order of falling distance.
#[inline]
pub(super) fn insert(stack: &mut [(Child, f32)], count: usize, entry: (Child, f32)) {
    let mut place = count;
    while place > 0 && stack[place - 1].1 < entry.1 {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = entry;
}
