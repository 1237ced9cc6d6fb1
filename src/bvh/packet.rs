//! Eight rays through the tree together.
//!
//! Where all rays of a packet point into the same octant, a node is tested twice: first the interval of
//! the whole packet against all eight boxes at once (lanes are boxes), then the eight rays against each
//! box that is left (lanes are rays). The first test never culls what the second would keep (see
//! `beam`).

use super::{Bvh, Child, Hitx8, Kind, Leaves, Node, Tally, Traversal, beam::Beam, cost::Cost};
use crate::geometry::{Rayx8, aabb};
use crate::simd::{Mask, Mask8, Real, Vector3, f32x8};

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
            let ray = ray.within(self.reach());
            self.intersect_packet_from::<ANY, L, T>(root, leaves, (&ray, active), hit, traversal);
        }
    }

    /// The same from a node on, the root or an [entry](Bvh::entry). Returns what it cost.
    pub(super) fn intersect_packet_from<const ANY: bool, L: Leaves, T: Tally>(
        &self,
        start: &Node,
        leaves: &L,
        (ray, active): (&Rayx8, Mask8),
        hit: &mut Hitx8,
        traversal: &mut Traversal<T>,
    ) -> Cost {
        let mut cost = Cost::PACKET;
        if active.none() {
            return cost;
        }
        let waiting = hit.t;
        // No box is entered before −∞: lanes without work fail every comparison by themselves.
        hit.t = f32x8::select(active, hit.t, f32x8::splat(f32::NEG_INFINITY));
        let beam = Beam::of_packet(ray, active);
        let Traversal { stack, blocker, tally } = traversal;
        let mut top = 0;
        let mut node = start;
        let mut farthest = hit.t.reduce_max();
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
                    hit.t = f32x8::select(active, hit.t, waiting);
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
                        leaves.intersect_packet::<ANY>(first, count, ray, active, hit);
                        let before = farthest;
                        farthest = hit.t.reduce_max();
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
fn enter_together(
    node: &Node,
    ray: &Rayx8,
    beam: &Beam,
    t_far: f32x8,
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
fn enter_apart(node: &Node, ray: &Rayx8, t_far: f32x8, stack: &mut [(Child, f32)]) -> usize {
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
            let first = f32x8::select(enters, low, f32x8::splat(f32::INFINITY)).reduce_min();
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
