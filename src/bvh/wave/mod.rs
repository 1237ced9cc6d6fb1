//! Rays that have nothing in common: thirty-two of them, each on its own way, in turn.
//!
//! A single ray is a chain of steps that wait for one another: which node is next is known only when the
//! last one has been tested. Thirty-two rays that take the same step in turn, without a branch that depends
//! on the ray, hide each other's waiting; while one works, the others' next nodes are on their way from
//! memory.
//!
//! Rays come from a [`Feed`], which makes them ready in runs of neighbours, and wait and work in [`Slot`]s.

mod feed;
mod slot;
mod tags;

use std::hint::select_unpredictable;

use super::{
    Bvh, Child, Leaves, Node, Stream, Tally,
    cost::Cost,
    run::{RUN, Runs},
};
use crate::simd::{Groups, ONE_REGISTER, f32x8, f32x16};
use feed::Feed;
use slot::{Met, Slot};
use tags::{SLOTS, Slots, Tags, each, only, take};

/// Slots that wait at leaves, and at their ends, before these have a pass: with fewer, passes are short, and the end of each is a branch that
/// is guessed wrong.
const AT_LEAVES: u32 = 16;
const AT_ENDS: u32 = 6;

/// Slots of a wave and the rays that wait for one, kept from stream to stream.
pub(super) struct Wave {
    /// [`SLOTS`] of them, made in their place: an array would be made on the stack first.
    slots: Vec<Slot>,
    feed: Feed,
}

impl Default for Wave {
    fn default() -> Self {
        Self { slots: (0..SLOTS).map(|_| Slot::new()).collect(), feed: Feed::default() }
    }
}

impl Bvh {
    /// Traces the runs of a stream up to one that goes another way.
    pub(super) fn intersect_wave<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        runs: &mut Runs,
        wave: &mut Wave,
        tally: &mut T,
    ) {
        // Occlusion rays take short steps: asking for what is near costs them more than waiting.
        if !self.is_far() {
            self.in_turn::<ANY, false, L, S, T>(leaves, stream, runs, wave, tally);
        } else {
            self.in_turn::<ANY, true, L, S, T>(leaves, stream, runs, wave, tally);
        }
    }

    /// `ASK` says whether nodes and blocks are asked for ahead of time.
    fn in_turn<const ANY: bool, const ASK: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        runs: &mut Runs,
        wave: &mut Wave,
        tally: &mut T,
    ) {
        let Wave { slots, feed } = wave;
        let Some(slots) = slots.first_chunk_mut() else { return };
        feed.begin();
        let (mut nodes, mut at): (Slots, _) = (0, Tags::DONE);
        let mut fresh = true;
        let (mut steps, mut blocks, mut ended) = (0, 0, 0);
        while nodes != 0 || !at.is_empty() {
            steps += nodes.count_ones();
            at = self.pass_nodes::<ANY, ASK, L, T>(leaves, slots, nodes, at, tally);
            nodes = at.nodes(nodes);
            let at_leaves = at.leaves();
            if nodes == 0 || at_leaves.count_ones() >= AT_LEAVES {
                let (after, tested) = self.pass_leaves::<ANY, ASK, L, T>(leaves, slots, at, runs, tally);
                at = after;
                blocks += tested;
                nodes |= at.nodes(at_leaves);
            }
            let done = at.done();
            if nodes | at.leaves() != 0 && done.count_ones() < AT_ENDS {
                continue;
            }
            at.remove(done);
            let mut started = 0;
            ended += if fresh { 0 } else { done.count_ones() };
            for which in each(done) {
                let slot = &mut slots[which];
                if !fresh {
                    stream.answer(slot.index(), &slot.hit.settle::<ANY>());
                }
                if feed.next::<ANY, L, S, T>(self, leaves, stream, runs, slot, tally) {
                    started |= only(which);
                    at.insert(which, slot.child);
                }
            }
            nodes |= at.nodes(started);
            fresh = false;
            // As it goes on, not when it ends: what is learnt says whether the next run joins it.
            if ended >= RUN as u32 || nodes == 0 && at.is_empty() {
                let cost = Cost::RAY_NODE * steps + Cost::RAY_BLOCK * blocks;
                feed.tell::<ANY>(runs, ended, cost);
                (steps, blocks, ended) = (0, 0, 0);
            }
        }
    }

    /// Slots at nodes take a step.
    ///
    /// The boxes of the next slot's node are tested before a slot goes on from its own: what it then needs has been begun
    /// long enough ago, and does not fill the processor's scheduler with what waits.
    // By itself, as is the next: what the sets need are registers, and of those a loop among others gets few.
    #[inline(never)]
    fn pass_nodes<const ANY: bool, const ASK: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        slots: &mut [Slot; SLOTS],
        nodes: Slots,
        mut at: Tags,
        tally: &mut T,
    ) -> Tags {
        let mut each = each(nodes);
        // By twos: what is known of the next slot stays where it is while it becomes this one.
        let mut next = self.meet_next(slots, &mut each);
        while let Some(one) = next {
            let other = self.meet_next(slots, &mut each);
            self.step::<ANY, ASK, L, T>(leaves, slots, one, &mut at, tally);
            let Some(other) = other else { break };
            next = self.meet_next(slots, &mut each);
            self.step::<ANY, ASK, L, T>(leaves, slots, other, &mut at, tally);
        }
        at
    }

    /// Tests the boxes of the next slot's node.
    #[inline(always)]
    fn meet_next(
        &self,
        slots: &[Slot; SLOTS],
        each: &mut impl Iterator<Item = usize>,
    ) -> Option<(usize, &Node, Met)> {
        let which = each.next()?;
        let node = &self.nodes[slots[which].child.index()];
        Some((which, node, slots[which].meet(node)))
    }

    /// A slot takes the step whose boxes are tested.
    #[inline(always)]
    fn step<const ANY: bool, const ASK: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        slots: &mut [Slot; SLOTS],
        (which, node, met): (usize, &Node, Met),
        at: &mut Tags,
        tally: &mut T,
    ) {
        let slot = &mut slots[which];
        tally.node(1);
        slot.enter::<ANY>(node, met);
        if ASK {
            self.ask_for(slot.child, leaves);
        }
        at.insert(which, slot.child);
    }

    /// Slots at leaves test them: where a register holds sixteen lanes, small ones four at once and others two, where it
    /// holds eight, small ones two at once. Returns how many blocks' time that took, too.
    #[inline(never)]
    fn pass_leaves<const ANY: bool, const ASK: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        slots: &mut [Slot; SLOTS],
        mut at: Tags,
        runs: &mut Runs,
        tally: &mut T,
    ) -> (Tags, u32) {
        let (mut left, mut small, mut blocks) = (at.leaves(), at.small_leaves(), 0);
        at.remove(left);
        let mut blocker = Child::ABSENT;
        let mut go_on = |which: usize, slot: &mut Slot| {
            let leaf = slot.child;
            tally.leaf(leaf.slots().1, 1);
            slot.pop::<ANY>();
            if ANY {
                let blocked = slot.hit.t == f32::NEG_INFINITY;
                blocker = select_unpredictable(blocked, leaf, blocker);
                slot.child = select_unpredictable(blocked, Child::ABSENT, slot.child);
            }
            if ASK {
                self.ask_for(slot.child, leaves);
            }
            at.insert(which, slot.child);
        };
        left &= !small;
        if ONE_REGISTER {
            while small.count_ones() >= 4 {
                blocks += test_group::<ANY, 4, f32x16, L>(leaves, slots, &mut small, &mut go_on);
            }
            left |= small;
            while left.count_ones() >= 2 {
                blocks += test_group::<ANY, 2, f32x16, L>(leaves, slots, &mut left, &mut go_on);
            }
        } else {
            // Where memory is asked for, occlusion rays are faster one by one.
            while !(ANY && ASK) && small.count_ones() >= 2 {
                blocks += test_group::<ANY, 2, f32x8, L>(leaves, slots, &mut small, &mut go_on);
            }
            left |= small;
        }
        while left != 0 {
            blocks += test_group::<ANY, 1, f32x8, L>(leaves, slots, &mut left, &mut go_on);
        }
        if blocker != Child::ABSENT {
            runs.occluder.remember(blocker);
        }
        (at, blocks)
    }
}

/// The first slots of a set test their leaves together, and go on. Returns how many blocks' time that took.
#[inline(always)]
fn test_group<const ANY: bool, const N: usize, R: Groups<N>, L: Leaves>(
    leaves: &L,
    slots: &mut [Slot; SLOTS],
    set: &mut Slots,
    mut go_on: impl FnMut(usize, &mut Slot),
) -> u32 {
    let mut group = [0; N];
    for which in &mut group {
        *which = take(set).unwrap_or_default();
    }
    let Ok(mut slots) = slots.get_disjoint_mut(group) else { return 0 };
    let mut blocks = N as u32;
    if !Slot::test::<ANY, N, R, L>(&mut slots, leaves) {
        blocks = 0;
        for slot in &mut slots {
            blocks += slot.test_with_care::<ANY, L>(leaves);
        }
    }
    for (which, slot) in group.into_iter().zip(slots) {
        go_on(which, slot);
    }
    blocks
}
