//! A binary tree whose nodes know their parents, so that subtrees can change places.

use super::{
    binary::{self, Binary, Packed},
    binned,
    bounds::Bounds,
    reference::Reference,
};
use crate::geometry::Aabb;

/// The root's index.
pub(super) const ROOT: u32 = 0;

/// A node. Siblings stand side by side, behind the root: 1 and 2, 3 and 4.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    bounds: Aabb,
    parent: u32,
    below: Below,
}

/// What a node holds.
#[derive(Clone, Copy, Debug)]
enum Below {
    /// The first of two children.
    Pair(u32),
    /// References.
    Leaf { first: u32, count: u32 },
}

/// The tree.
#[derive(Debug)]
pub(super) struct Links {
    pub(super) nodes: Vec<Link>,
}

impl Links {
    pub(super) fn new(packed: &[Packed]) -> Self {
        let mut links = Self { nodes: Vec::with_capacity(packed.len()) };
        links.nodes.push(Link {
            bounds: Aabb::EMPTY,
            parent: ROOT,
            below: Below::Leaf { first: 0, count: 0 },
        });
        // Places whose links are still to be made, with where they stand in the run.
        let mut open = vec![(ROOT, 0)];
        while let Some((index, at)) = open.pop() {
            let node = Binary::unpack(&packed[at]);
            links.nodes[index as usize].bounds = node.bounds.aabb();
            links.nodes[index as usize].below = if node.is_leaf() {
                Below::Leaf { first: node.first, count: node.leaf_count() as u32 }
            } else {
                let pair = links.nodes.len() as u32;
                let child = Link { parent: index, ..links.nodes[index as usize] };
                links.nodes.extend([child, child]);
                open.extend([(pair + 1, at + node.right()), (pair, at + 1)]);
                Below::Pair(pair)
            };
        }
        links
    }

    #[inline]
    pub(super) fn bounds(&self, node: u32) -> Bounds {
        self.nodes[node as usize].bounds.into()
    }

    /// The root is its own.
    #[inline]
    pub(super) fn parent(&self, node: u32) -> u32 {
        self.nodes[node as usize].parent
    }

    /// Not of the root.
    #[inline]
    pub(super) fn sibling(&self, node: u32) -> u32 {
        ((node - 1) ^ 1) + 1
    }

    #[inline]
    pub(super) fn children(&self, node: u32) -> Option<[u32; 2]> {
        match self.nodes[node as usize].below {
            Below::Pair(pair) => Some([pair, pair + 1]),
            Below::Leaf { .. } => None,
        }
    }

    /// Is `node` the same as `top` or somewhere below it?
    pub(super) fn is_below(&self, mut node: u32, top: u32) -> bool {
        while node != top && node != ROOT {
            node = self.parent(node);
        }
        node == top
    }

    /// Makes `from` the sibling of `to`. The sibling that it leaves takes their parent's place.
    pub(super) fn reinsert(&mut self, from: u32, to: u32) {
        let (sibling, parent) = (self.sibling(from), self.parent(from));
        let (left_behind, target) = (self.nodes[sibling as usize], self.nodes[to as usize]);
        self.put(sibling, target);
        self.put(parent, left_behind);
        self.nodes[to as usize].below = Below::Pair(from.min(sibling));
        self.nodes[sibling as usize].parent = to;
        self.nodes[from as usize].parent = to;
        self.refit(to);
        self.refit(self.parent(parent));
    }

    /// Puts a node's contents into another place, whose parent stays.
    fn put(&mut self, place: u32, link: Link) {
        self.nodes[place as usize].bounds = link.bounds;
        self.nodes[place as usize].below = link.below;
        for child in self.children(place).into_iter().flatten() {
            self.nodes[child as usize].parent = place;
        }
    }

    /// Bounds of a node and of all above it.
    fn refit(&mut self, mut node: u32) {
        loop {
            if let Some([a, b]) = self.children(node) {
                self.nodes[node as usize].bounds = self.bounds(a).union(self.bounds(b)).aabb();
            }
            if node == ROOT {
                return;
            }
            node = self.parent(node);
        }
    }

    /// The tree depth first again, with the references in its order.
    pub(super) fn lay_out(&self, references: &[Reference]) -> (Vec<Packed>, Vec<Reference>) {
        let mut packed = binary::places(references.len());
        let mut ordered = Vec::with_capacity(references.len());
        let taken = self.lay_out_below(ROOT, 0, references, &mut packed, &mut ordered);
        packed.truncate(taken);
        (packed, ordered)
    }

    /// Returns how many places were taken.
    fn lay_out_below(
        &self,
        node: u32,
        depth: u32,
        from: &[Reference],
        packed: &mut [Packed],
        ordered: &mut Vec<Reference>,
    ) -> usize {
        let first = ordered.len();
        match self.nodes[node as usize].below {
            Below::Leaf { first: old, count } => {
                ordered.extend_from_slice(&from[old as usize..][..count as usize]);
                packed[0] = Binary::leaf(self.bounds(node), first as u32, count as usize).pack();
                1
            }
            Below::Pair(_) if depth >= binned::SAH_DEPTH => {
                self.gather(node, from, ordered);
                binned::halves(&mut ordered[first..], first as u32, packed)
            }
            Below::Pair(pair) => {
                let right = 1 + self.lay_out_below(pair, depth + 1, from, &mut packed[1..], ordered);
                packed[0] = Binary::inner(self.bounds(node), first as u32, right).pack();
                right + self.lay_out_below(pair + 1, depth + 1, from, &mut packed[right..], ordered)
            }
        }
    }

    /// The references below a node, left to right.
    fn gather(&self, node: u32, from: &[Reference], ordered: &mut Vec<Reference>) {
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            match self.nodes[node as usize].below {
                Below::Pair(pair) => open.extend([pair + 1, pair]),
                Below::Leaf { first, count } => {
                    ordered.extend_from_slice(&from[first as usize..][..count as usize]);
                }
            }
        }
    }
}
