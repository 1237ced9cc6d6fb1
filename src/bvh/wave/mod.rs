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

use super::{
    Bvh, Child, Leaves, Node, Stream, Tally,
    cost::Cost,
    run::{RUN, Runs},
};
use crate::simd::ONE_REGISTER;
use feed::Feed;
use slot::{Met, Slot};

/// Rays in turn: with fewer, passes are short, and the end of each is a branch that is guessed wrong; more leave the
/// first-level cache.
const SLOTS: usize = 32;
/// All slots.
const ALL: u32 = u32::MAX;
/// Slots that wait at leaves, and at their ends, before these have a pass, for the same reason.
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

/// Sets of slots: a slot is at a leaf, at its end, or, if it is neither, at a node.
///
/// Which set comes next is a shift and an or, in registers: a list in memory would make each slot's turn
/// wait for the last one's, and a branch would be wrong half of the time.
#[derive(Clone, Copy, Default)]
struct Sets {
    leaves: u32,
    done: u32,
}

impl Sets {
    #[inline]
    fn insert(&mut self, slot: usize, child: Child) {
        self.leaves |= u32::from(child.is_leaf_or_absent()) << slot;
        self.done |= u32::from(child == Child::ABSENT) << slot;
    }

    /// Those of some slots that are at nodes.
    fn nodes(&self, among: u32) -> u32 {
        among & !self.leaves
    }

    /// Those that are at leaves.
    fn at_leaves(&self) -> u32 {
        self.leaves & !self.done
    }
}

/// The slots of a set, lowest first.
#[inline]
fn each(set: u32) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let slot = left.trailing_zeros() as usize;
        (left != 0).then(|| {
            left &= left - 1;
            slot % SLOTS
        })
    })
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
        let (mut nodes, mut sets) = (0, Sets { leaves: ALL, done: ALL });
        let mut fresh = true;
        let (mut steps, mut blocks, mut ended) = (0, 0, 0);
        while nodes | sets.leaves != 0 {
            steps += nodes.count_ones();
            sets = self.pass_nodes::<ANY, ASK, L, T>(leaves, slots, nodes, sets, tally);
            nodes = sets.nodes(nodes);
            let at_leaves = sets.at_leaves();
            if nodes == 0 || at_leaves.count_ones() >= AT_LEAVES {
                sets.leaves = sets.done;
                let (after, tested) =
                    self.pass_leaves::<ANY, ASK, L, T>(leaves, (slots, at_leaves), sets, runs, tally);
                sets = after;
                blocks += tested;
                nodes |= sets.nodes(at_leaves);
            }
            if nodes | sets.at_leaves() != 0 && sets.done.count_ones() < AT_ENDS {
                continue;
            }
            let done = std::mem::take(&mut sets.done);
            sets.leaves &= !done;
            let mut started = 0;
            ended += if fresh { 0 } else { done.count_ones() };
            for which in each(done) {
                let slot = &mut slots[which];
                if !fresh {
                    stream.answer(slot.index(), &slot.hit.settle::<ANY>());
                }
                if feed.next::<ANY, L, S, T>(self, leaves, stream, runs, slot, tally) {
                    started |= 1 << which;
                    sets.insert(which, slot.child);
                }
            }
            nodes |= sets.nodes(started);
            fresh = false;
            // As it goes on, not when it ends: what is learnt says whether the next run joins it.
            if ended >= RUN as u32 || nodes | sets.leaves == 0 {
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
        nodes: u32,
        mut sets: Sets,
        tally: &mut T,
    ) -> Sets {
        let mut each = each(nodes);
        // By twos: what is known of the next slot stays where it is while it becomes this one.
        let mut at = self.meet_next(slots, &mut each);
        while let Some(one) = at {
            let other = self.meet_next(slots, &mut each);
            self.step::<ANY, ASK, L, T>(leaves, slots, one, &mut sets, tally);
            let Some(other) = other else { break };
            at = self.meet_next(slots, &mut each);
            self.step::<ANY, ASK, L, T>(leaves, slots, other, &mut sets, tally);
        }
        sets
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
        sets: &mut Sets,
        tally: &mut T,
    ) {
        let slot = &mut slots[which];
        tally.node(1);
        slot.enter::<ANY>(node, met);
        if ASK {
            self.ask_for(slot.child, leaves);
        }
        sets.insert(which, slot.child);
    }

    /// Slots at leaves test a block, two at once where a register holds both. Returns how many blocks' time that took, too.
    #[inline(never)]
    fn pass_leaves<const ANY: bool, const ASK: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        (slots, at_leaves): (&mut [Slot; SLOTS], u32),
        mut sets: Sets,
        runs: &mut Runs,
        tally: &mut T,
    ) -> (Sets, u32) {
        let mut blocks = 0;
        let mut go_on = |which: usize, slot: &mut Slot| {
            let leaf = slot.child;
            let (first, count) = leaf.slots();
            tally.leaf(count, 1);
            blocks += leaves.blocks(first, count);
            slot.pop::<ANY>();
            if ANY && slot.hit.t == f32::NEG_INFINITY {
                runs.occluder.remember(leaf);
                slot.child = Child::ABSENT;
            }
            if ASK {
                self.ask_for(slot.child, leaves);
            }
            sets.insert(which, slot.child);
        };
        let mut each = each(at_leaves);
        while let Some(one) = each.next() {
            if ONE_REGISTER
                && let Some(other) = each.next()
                && let Ok([first, second]) = slots.get_disjoint_mut([one, other])
            {
                Slot::test_two::<ANY, L>([first, second], leaves);
                go_on(one, first);
                go_on(other, second);
            } else {
                slots[one].test::<ANY, L>(leaves);
                go_on(one, &mut slots[one]);
            }
        }
        (sets, blocks)
    }
}
