//! Subtrees taken out of the binary tree and put back where they cost less \[MB18\].
//!
//! Moving a subtree changes the areas of its old and its new ancestors and nothing else, so what a move
//! gains is known from the areas on the way. Each pass looks for the best moves of the largest nodes in
//! parallel, on a tree that does not change meanwhile, and makes them one by one, the greatest gain
//! first; a move that touches what an earlier one has touched is left out. Neither part depends on the
//! number of threads.

use rayon::prelude::*;

use super::{
    binary::Packed,
    links::{Links, ROOT},
    reference::Reference,
};

/// The first pass tries one node in 2^(`PASSES` − 1), the largest, and each after it twice as many, the
/// last one all.
const PASSES: u32 = 7;

/// Optimises the tree; references follow it into leaf order.
pub(super) fn reinsert(nodes: Vec<Packed>, references: &mut Vec<Reference>) -> Vec<Packed> {
    let mut links = Links::new(&nodes);
    drop(nodes);
    for share in (0..PASSES).rev() {
        pass(&mut links, 1 << share);
    }
    let (nodes, ordered) = links.lay_out(references);
    *references = ordered;
    nodes
}

/// A subtree that becomes the sibling of another one.
#[derive(Clone, Copy, Debug)]
struct Move {
    from: u32,
    to: u32,
    gain: f32,
}

/// Tries one node in `share`.
fn pass(links: &mut Links, share: usize) {
    let largest = largest(links, share);
    let stack = || Vec::with_capacity(64);
    let found = largest.par_iter().map_init(stack, |stack, &from| best_move(links, from, stack));
    let mut moves: Vec<Move> = found.flatten().collect();
    moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
    let mut touched = vec![false; links.nodes.len()];
    for Move { from, to, .. } in moves {
        let involved =
            [from, to, links.sibling(from), links.parent(from), links.parent(to)].map(|node| node as usize);
        // An earlier move may have put the target below what moves.
        if involved.iter().any(|&node| touched[node]) || links.is_below(to, from) {
            continue;
        }
        for node in involved {
            touched[node] = true;
        }
        links.reinsert(from, to);
    }
}

/// The largest nodes, one in `share` of all.
fn largest(links: &Links, share: usize) -> Vec<u32> {
    let count = links.nodes.len() as u32;
    let mut sized: Vec<(f32, u32)> =
        (1..count).into_par_iter().map(|i| (links.bounds(i).half_area(), i)).collect();
    let tried = (sized.len() / share).max(sized.len().min(64));
    let order = |a: &(f32, u32), b: &(f32, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if tried < sized.len() {
        sized.select_nth_unstable_by(tried, order);
        sized.truncate(tried);
    }
    sized.par_sort_unstable_by(order);
    sized.into_iter().map(|(_, i)| i).collect()
}

/// The move of a subtree that takes the most area out of the tree; none if it stands well.
fn best_move(links: &Links, from: u32, stack: &mut Vec<(f32, u32)>) -> Option<Move> {
    let bounds = links.bounds(from);
    let area = bounds.half_area();
    let parent = links.parent(from);
    let mut best = Move { from, to: from, gain: 0.0 };
    // What is gained before anything is put back: the parent goes, and ancestors shrink.
    let mut gain = links.bounds(parent).half_area();
    let mut pivot = parent;
    let mut sibling = links.sibling(from);
    let mut without = links.bounds(sibling);
    loop {
        stack.push((gain, sibling));
        while let Some((gain, to)) = stack.pop() {
            // The new parent is no smaller than what moves.
            if gain - area <= best.gain {
                continue;
            }
            let there = links.bounds(to);
            let left = gain - there.union(bounds).half_area();
            if left > best.gain {
                best = Move { from, to, gain: left };
            }
            if let Some([a, b]) = links.children(to) {
                let gain = left + there.half_area();
                stack.extend([(gain, a), (gain, b)]);
            }
        }
        if pivot == ROOT {
            break;
        }
        if pivot != parent {
            without = without.union(links.bounds(sibling));
            gain += links.bounds(pivot).half_area() - without.half_area();
        }
        sibling = links.sibling(pivot);
        pivot = links.parent(pivot);
    }
    let moved = best.to != from && best.to != links.sibling(from) && best.to != parent;
    moved.then_some(best)
}
