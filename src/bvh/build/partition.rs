//! References to the left or the right of a plane, in place.

use rayon::prelude::*;

use super::{
    bins::{CHUNK, Plane},
    bounds::Bounds,
    reference::Reference,
};

/// Bounds of the centres on either side: left, right.
pub(super) type Centres = [Bounds; 2];

/// Moves what is left of the plane to the front. Returns the bounds of the centres on either side.
pub(super) fn partition(references: &mut [Reference], plane: &Plane) -> Centres {
    if references.len() <= CHUNK { serial::<false>(references, plane).1 } else { parallel(references, plane) }
}

/// Returns also how many are left. `FAR`: they are among so many that not all are in a cache. Without branches on what is where, which nothing could foretell.
fn serial<const FAR: bool>(references: &mut [Reference], plane: &Plane) -> (usize, Centres) {
    let [mut left, mut right] = [Bounds::EMPTY; 2];
    let mut left_count = 0;
    for i in 0..references.len() {
        let reference = references[i];
        if FAR {
            references[i].ask_for_later();
        }
        let centre = reference.bounds().shrunk();
        let is_left = plane.is_left(centre.max());
        left = left.union_if(centre, is_left);
        right = right.union_if(centre, !is_left);
        references[i] = references[left_count];
        references[left_count] = reference;
        left_count += usize::from(is_left);
    }
    (left_count, [left, right])
}

/// Each chunk by itself, then what stands on the wrong side of the middle changes places.
fn parallel(references: &mut [Reference], plane: &Plane) -> Centres {
    let chunks: Vec<(usize, Centres)> =
        references.par_chunks_mut(CHUNK).map(|chunk| serial::<true>(chunk, plane)).collect();
    let middle: usize = chunks.iter().map(|(left_count, _)| left_count).sum();
    let (mut wrong_left, mut wrong_right) = (vec![], vec![]);
    let mut at = 0;
    let mut rest = references;
    for &(left_count, _) in &chunks {
        let (chunk, others) = rest.split_at_mut(CHUNK.min(rest.len()));
        rest = others;
        let end = at + chunk.len();
        let (left, right) = chunk.split_at_mut(left_count);
        // Lefts beyond the middle, rights before it.
        let inside = middle.saturating_sub(at).min(left.len());
        wrong_left.push(&mut left[inside..]);
        let inside = middle.saturating_sub(end - right.len()).min(right.len());
        wrong_right.push(&mut right[..inside]);
        at = end;
    }
    let mut pairs = vec![];
    let mut lefts = wrong_left.into_iter().filter(|run| !run.is_empty());
    let mut left: &mut [Reference] = &mut [];
    for mut right in wrong_right {
        while !right.is_empty() {
            if left.is_empty() {
                left = lefts.next().expect("as many lefts as rights are out of place");
            }
            let length = left.len().min(right.len());
            let (a, b) = (left.split_at_mut(length), right.split_at_mut(length));
            pairs.push((a.0, b.0));
            (left, right) = (a.1, b.1);
        }
    }
    pairs.into_par_iter().for_each(|(left, right)| left.swap_with_slice(right));
    chunks.iter().fold([Bounds::EMPTY; 2], |all, (_, each)| [all[0].union(each[0]), all[1].union(each[1])])
}
