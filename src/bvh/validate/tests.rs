use glam::Vec3;

use super::*;
use crate::bvh::{Child, Node, Reference};

fn boxes() -> Vec<Aabb> {
    let corner = |i: usize| Vec3::new((i % 10) as f32, (i / 10) as f32, (i * 7 % 5) as f32);
    (0..100).map(|i| Aabb { min: corner(i), max: corner(i) + 0.5 }).collect()
}

fn tree(boxes: &[Aabb]) -> Bvh {
    let reference = |(i, &bounds): (usize, &Aabb)| Reference::new(bounds, i as u32, 0);
    Bvh::build(boxes.iter().enumerate().map(reference).collect())
}

/// The first child that satisfies.
fn find(bvh: &Bvh, wanted: impl Fn(Kind) -> bool) -> (usize, usize) {
    let places = (0..bvh.nodes.len()).flat_map(|node| (0..8).map(move |place| (node, place)));
    places
        .into_iter()
        .find(|&(node, place)| wanted(bvh.nodes[node].children[place].kind()))
        .expect("there is one")
}

fn is_leaf(kind: Kind) -> bool {
    matches!(kind, Kind::Leaf { count: 2.., .. })
}

fn is_inner(kind: Kind) -> bool {
    matches!(kind, Kind::Inner(_))
}

#[test]
fn a_sound_tree_is_sound() {
    let boxes = boxes();
    let shape = tree(&boxes).validate(&boxes).unwrap();
    assert_eq!(shape.primitives, 100);
    assert!(shape.depth >= 2 && shape.leaves >= 25, "{shape:?}");
}

#[test]
fn a_box_that_is_too_small_is_found() {
    let boxes = boxes();
    for wanted in [is_leaf, is_inner] {
        for row in 0..6 {
            let mut bvh = tree(&boxes);
            let (node, place) = find(&bvh, wanted);
            let bound = &mut bvh.nodes[node].bounds[row / 2][row % 2][place];
            *bound = if row % 2 == 0 { bound.next_up() } else { bound.next_down() };
            assert!(matches!(bvh.validate(&boxes), Err(Defect::SticksOut { .. })), "row {row}");
        }
    }
}

#[test]
fn a_moved_primitive_is_found() {
    let mut boxes = boxes();
    let bvh = tree(&boxes);
    boxes[42].max.y += 100.0;
    assert!(matches!(bvh.validate(&boxes), Err(Defect::SticksOut { .. })));
}

#[test]
fn a_lost_primitive_is_found() {
    let boxes = boxes();
    let mut bvh = tree(&boxes);
    let (node, place) = find(&bvh, is_leaf);
    let Kind::Leaf { first, count } = bvh.nodes[node].children[place].kind() else { unreachable!() };
    bvh.nodes[node].children[place] = Child::leaf(first, count - 1);
    assert!(matches!(bvh.validate(&boxes), Err(Defect::Reached { what: "primitive", times: 0, .. })));
    // A whole leaf, and one that is in nobody's list.
    bvh.nodes[node].children[place] = Child::ABSENT;
    assert!(matches!(bvh.validate(&boxes), Err(Defect::Reached { what: "primitive", times: 0, .. })));
    let mut more = boxes.clone();
    more.push(boxes[0]);
    assert_eq!(
        tree(&boxes).validate(&more),
        Err(Defect::Reached { what: "primitive", index: 100, times: 0 })
    );
}

#[test]
fn a_primitive_in_two_leaves_is_found() {
    let boxes = vec![boxes()[0]; 100];
    let mut bvh = tree(&boxes);
    bvh.slots[0] = bvh.slots[1];
    assert!(matches!(bvh.validate(&boxes), Err(Defect::Reached { what: "primitive", .. })));
}

#[test]
fn leaves_across_blocks_with_padding_or_past_the_end_are_found() {
    let boxes = boxes();
    for word in [Child::leaf(6, 4), Child::leaf(10_000, 1)] {
        let mut bvh = tree(&boxes);
        let (node, place) = find(&bvh, is_leaf);
        bvh.nodes[node].children[place] = word;
        assert_eq!(bvh.validate(&boxes), Err(Defect::BadLeaf { node, place }), "{word:?}");
    }
    let mut bvh = tree(&boxes);
    let (node, place) = find(&bvh, is_leaf);
    let Kind::Leaf { first, .. } = bvh.nodes[node].children[place].kind() else { unreachable!() };
    bvh.slots[first as usize] = u32::MAX;
    assert_eq!(bvh.validate(&boxes), Err(Defect::BadLeaf { node, place }));
}

#[test]
fn nodes_reached_twice_never_or_in_a_circle_are_found() {
    let boxes = boxes();
    let mut bvh = tree(&boxes);
    bvh.nodes.push(Node::EMPTY);
    let index = bvh.nodes.len() - 1;
    assert_eq!(bvh.validate(&boxes), Err(Defect::Reached { what: "node", index, times: 0 }));
    let mut bvh = tree(&boxes);
    let (node, place) = find(&bvh, is_inner);
    bvh.nodes[node].children[place] = Child::inner(0);
    // Everything is in the root: the circle is found before, or as, a box that is too small.
    assert!(bvh.validate(&boxes).is_err());
    let whole = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
    bvh.nodes[node].set(place, whole, Child::inner(0));
    assert_eq!(bvh.validate(&boxes), Err(Defect::Reached { what: "node", index: 0, times: 2 }));
}
