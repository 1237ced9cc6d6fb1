//! The builder: sound trees whatever the boxes, the same for any number of threads, and not worse than
//! splitting at the median.

#![allow(missing_docs)]

use glam::Vec3;
use packlight::bvh::{BLOCK, Bvh, Kind, MAX_LEAF, Quality, Reference, Shape};
use packlight::geometry::Aabb;

/// A repeatable sequence.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Deeper than this the traversal's stack could not hold what waits.
const DEPTH: usize = 76;

fn references(boxes: &[Aabb], class: impl Fn(usize) -> u8) -> Vec<Reference> {
    let reference = |(i, &bounds): (usize, &Aabb)| Reference::new(bounds, i as u32, class(i));
    boxes.iter().enumerate().map(reference).collect()
}

const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Medium, Quality::High];

/// Builds by every quality and checks all that a tree promises. Returns the tree of medium quality.
fn sound(boxes: &[Aabb], class: impl Fn(usize) -> u8) -> (Bvh, Shape) {
    let [_, medium, _] = QUALITIES.map(|quality| sound_by(quality, boxes, &class));
    medium
}

fn sound_by(quality: Quality, boxes: &[Aabb], class: impl Fn(usize) -> u8) -> (Bvh, Shape) {
    let bvh = Bvh::build_with(references(boxes, &class), quality);
    let shape = bvh.validate(boxes).unwrap_or_else(|defect| panic!("{} boxes: {defect}", boxes.len()));
    assert_eq!(shape.primitives, boxes.len());
    assert_eq!(shape.nodes, bvh.nodes().len());
    assert!(shape.depth < DEPTH, "{} deep", shape.depth);
    let slots = bvh.slots();
    assert!(slots.len().is_multiple_of(BLOCK));
    let filled = slots.iter().filter(|&&slot| slot != u32::MAX).count();
    assert_eq!(filled, boxes.len());
    // Blocks are of one class, classes ascend.
    let mut last = 0;
    for block in slots.chunks(BLOCK) {
        let first = class(block[0] as usize);
        assert!(block.iter().all(|&slot| slot == u32::MAX || class(slot as usize) == first));
        assert!(last <= first);
        last = first;
    }
    for node in bvh.nodes() {
        for child in node.children {
            match child.kind() {
                Kind::Leaf { count, .. } => assert!((1..=MAX_LEAF as u32).contains(&count)),
                Kind::Inner(index) => assert!(index > 0 && (index as usize) < bvh.nodes().len()),
                Kind::Absent => {}
            }
        }
    }
    (bvh, shape)
}

fn random_boxes(count: usize, size: f32, random: &mut Random) -> Vec<Aabb> {
    let mut next = || {
        let centre = random.vector();
        Aabb::of_points([centre, centre + random.vector() * size])
    };
    (0..count).map(|_| next()).collect()
}

#[test]
fn random_boxes_of_every_number_make_sound_trees() {
    let mut random = Random(1);
    for count in (1..=70).chain([100, 127, 128, 129, 500, 999, 1000, 2000]) {
        for size in [0.0, 0.01, 1.0] {
            sound(&random_boxes(count, size, &mut random), |_| 0);
        }
    }
}

#[test]
fn nothing_makes_an_empty_tree() {
    let bvh = Bvh::build(vec![]);
    assert!(bvh.nodes().is_empty() && bvh.slots().is_empty());
    assert_eq!(bvh.validate(&[]), Ok(Shape::default()));
}

#[test]
fn equal_boxes_make_shallow_trees() {
    for count in [1, 2, 4, 5, 8, 9, 64, 1000, 5000] {
        let point = Aabb { min: Vec3::ONE, max: Vec3::ONE };
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        for bounds in [point, unit] {
            let (_, shape) = sound(&vec![bounds; count], |_| 0);
            assert!(shape.depth <= 14, "{count} equal boxes are {} deep", shape.depth);
        }
    }
}

#[test]
fn concentric_boxes_make_sound_trees() {
    let boxes: Vec<_> =
        (1..2000).map(|i| Aabb { min: Vec3::splat(-(i as f32)), max: Vec3::splat(i as f32) }).collect();
    sound(&boxes, |_| 0);
}

#[test]
fn coordinates_of_all_sizes_make_sound_trees() {
    let mut random = Random(2);
    for (least, greatest) in [(-38, 18), (-45, -37), (10, 17), (-20, 0)] {
        let boxes: Vec<_> = (0..2000)
            .map(|i| {
                let scale = 10f64
                    .powf(f64::from(random.unit()) * f64::from(greatest - least) + f64::from(least))
                    as f32;
                let centre = (random.vector() - 0.5) * scale;
                let size = random.vector() * if i % 3 == 0 { 0.0 } else { scale };
                Aabb::of_points([centre, centre + size])
            })
            .collect();
        sound(&boxes, |i| (i % 3) as u8);
    }
}

/// Areas of such boxes are finite, and their sums are not.
#[test]
fn costs_that_overflow_make_sound_trees() {
    let mut random = Random(7);
    for (count, scale) in [(60, 9.9e17), (100, 9.9e17), (2000, 9.9e17), (20_000, 3e17), (20_000, 3e16)] {
        let mut corner = || (random.vector() * 2.0 - 1.0) * scale;
        let boxes: Vec<_> = (0..count).map(|_| Aabb::of_points([corner(), corner()])).collect();
        sound(&boxes, |_| 0);
    }
}

#[test]
fn distances_that_double_do_not_make_deep_trees() {
    // Each split by bins would cut off the last few: geometric series are the worst case of SAH.
    for base in [1.1f64, 1.5, 2.0, 4.0] {
        let boxes: Vec<_> = (0..2000)
            .map(|i| {
                let x = base.powf(f64::from(i) % (100.0 / base.log10() / 2.0) - 60.0 / base.log2()) as f32;
                Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x, 0.0, 0.0) }
            })
            .filter(|b| b.max.x.is_finite() && b.max.x < 1e18)
            .collect();
        assert!(boxes.len() > 100);
        sound(&boxes, |_| 0);
    }
}

#[test]
fn classes_never_share_a_leaf() {
    let mut random = Random(3);
    for count in [1, 2, 3, 4, 7, 8, 9, 100, 1000] {
        let boxes = random_boxes(count, 0.1, &mut random);
        sound(&boxes, |i| (i % 3) as u8);
        sound(&boxes, |i| u8::from(i == 0));
        sound(&vec![boxes[0]; count], |i| (i % 2) as u8);
        sound(&boxes, |i| [0, 2][i % 2]);
    }
}

/// Σ area·cost of the tree that splits the longest axis of the centres at the median, three times a node.
fn median_cost(boxes: &mut [Aabb], root_area: f64) -> f64 {
    let bounds = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
    let area = f64::from(bounds.half_area()) / root_area;
    if boxes.len() <= MAX_LEAF {
        return area * boxes.len() as f64;
    }
    let mut parts = vec![boxes];
    for _ in 0..3 {
        parts = parts
            .into_iter()
            .flat_map(|part| {
                if part.len() <= MAX_LEAF {
                    return vec![part];
                }
                let centres = Aabb::of_points(part.iter().map(|b| b.centre()));
                let size = centres.max - centres.min;
                let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).expect("three axes");
                part.sort_by(|a, b| a.centre()[axis].total_cmp(&b.centre()[axis]));
                let (left, right) = part.split_at_mut(part.len() / 2);
                vec![left, right]
            })
            .collect();
    }
    2.0 * area + parts.into_iter().map(|part| median_cost(part, root_area)).sum::<f64>()
}

#[test]
fn the_tree_is_cheaper_than_median_splits() {
    let mut random = Random(4);
    // Uniform, and clustered as scenes are.
    let uniform = random_boxes(2000, 0.05, &mut random);
    let mut clustered = random_boxes(1000, 0.002, &mut random);
    for _ in 0..10 {
        let (corner, scale) = (random.vector() * 100.0, random.unit());
        let part = random_boxes(100, 0.05, &mut random);
        clustered
            .extend(part.iter().map(|b| Aabb { min: b.min * scale + corner, max: b.max * scale + corner }));
    }
    for (mut boxes, factor) in [(uniform, 1.0), (clustered, 0.8)] {
        let (_, shape) = sound(&boxes, |_| 0);
        let root_area = f64::from(boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b)).half_area());
        let (cost, median) =
            (2.0 * shape.node_cost + shape.primitive_cost, median_cost(&mut boxes, root_area));
        println!("cost {cost:.3}, median splits {median:.3}, {shape:?}");
        assert!(cost < factor * median, "{cost} is not below {factor} of {median}");
        assert!(cost.is_finite() && cost > 0.0);
    }
}

#[test]
fn threads_do_not_change_the_tree() {
    let mut random = Random(5);
    // Enough for the parallel branches of every pass, in several chunks.
    let boxes = random_boxes(50_000, 0.02, &mut random);
    QUALITIES.into_iter().for_each(|quality| threads_do_not_change(&boxes, quality));
}

fn bits(bounds: [[[f32; 8]; 2]; 3]) -> [[[u32; 8]; 2]; 3] {
    bounds.map(|sides| sides.map(|side| side.map(f32::to_bits)))
}

fn threads_do_not_change(boxes: &[Aabb], quality: Quality) {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| Bvh::build_with(references(boxes, |i| u8::from(i % 7 == 0)), quality))
    };
    let one = build(1);
    one.validate(boxes).expect("a sound tree");
    for threads in [2, 3] {
        let other = build(threads);
        assert_eq!(one.slots(), other.slots());
        assert_eq!(one.nodes().len(), other.nodes().len());
        for (a, b) in one.nodes().iter().zip(other.nodes()) {
            assert_eq!(bits(a.bounds), bits(b.bounds));
            assert_eq!(a.children, b.children);
        }
    }
}

/// Boxes of a generated mesh's triangles.
fn mesh_boxes(spec: &str) -> Vec<Aabb> {
    let mesh = packlight::load::generate::mesh(spec).expect("a mesh that can be made");
    let corners = |triangle: &[u32; 3]| triangle.map(|i| mesh.positions[i as usize]);
    mesh.triangles.iter().map(|triangle| Aabb::of_points(corners(triangle))).collect()
}

/// What builders make small.
fn cost(shape: &Shape) -> f64 {
    2.0 * shape.node_cost + shape.leaf_cost + 0.3 * shape.primitive_cost
}

#[test]
fn quality_buys_a_cheaper_tree() {
    let mut random = Random(6);
    // Long boxes that lie across each other, as walls and beams do.
    let beams: Vec<_> = (0..5000)
        .map(|i| {
            let mut size = Vec3::splat(0.01);
            size[i % 3] = random.unit() * random.unit();
            let corner = random.vector();
            Aabb { min: corner, max: corner + size }
        })
        .collect();
    // (least of fast / medium, most of it, most of high / medium)
    for (boxes, least, most, high_most) in [
        (beams, 1.0, 1.5, 0.95),
        (mesh_boxes("soup:20k"), 1.0, 1.1, 0.99),
        (mesh_boxes("hair:20k"), 1.0, 1.1, 0.985),
    ] {
        let [fast, medium, high] = QUALITIES.map(|quality| cost(&sound_by(quality, &boxes, |_| 0).1));
        println!("fast {:.4}, high {:.4} of medium {medium:.3}", fast / medium, high / medium);
        assert!((least..most).contains(&(fast / medium)), "fast {fast}, medium {medium}");
        assert!(high / medium < high_most, "high {high}, medium {medium}");
    }
}

#[test]
fn a_triangle_takes_85_bytes_at_most() {
    for spec in ["soup:50k", "terrain:50k", "spheres:50k", "hair:50k"] {
        let boxes = mesh_boxes(spec);
        for quality in [Quality::Medium, Quality::High] {
            let bvh = Bvh::build_with(references(&boxes, |_| 0), quality);
            // A block of eight triangles has nine floats and an id for each.
            let bytes = size_of_val(bvh.nodes()) + bvh.slots().len() * 40;
            let each = bytes as f64 / boxes.len() as f64;
            assert!(each <= 85.0, "{spec}, {quality:?}: {each} bytes a triangle");
        }
    }
}

#[test]
fn a_tree_says_how_deep_it_is_and_what_a_line_through_it_meets() {
    let path = std::path::Path::new("gen:terrain:10k");
    let loaded =
        packlight::load::load(path, &packlight::load::LoadOptions::default()).expect("it is made here");
    let shape = packlight::compile::compile(&loaded.description).expect("it compiles").tree_shape();
    assert!((3..20).contains(&shape.depth), "{shape:?}");
    assert!(shape.node_cost > 1.0 && shape.primitive_cost > 0.5, "{shape:?}");
    assert!(shape.leaves > 1000, "{shape:?}");
}
