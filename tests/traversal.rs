//! Packets and single rays find what testing every primitive finds: the same hit, t, u, v and id, to the
//! bit, and are blocked where it finds anything.

#![allow(missing_docs)]

#[path = "traversal/placed.rs"]
mod placed;
#[path = "traversal/scenes.rs"]
mod scenes;

use glam::Vec3;
use packlight::bvh::{Tracer, Traversal, Way};
use packlight::compile::{Asked, Scene, compile};
use packlight::geometry::{Hit, PrimitiveId, Ray, Ray32, RayLanes, Rayx8};
use packlight::scene::{Aov, AovChannel, Instance, SceneDescription};
use packlight::simd::{Mask8, Real, Vector3, f32x8};
use packlight::verify::aim::{Random, rays_at};

use scenes::{shared, targets};

fn bits(hit: Hit) -> (u32, u32, u32, PrimitiveId) {
    (hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive)
}

fn packet(rays: &[Ray; 8]) -> Rayx8 {
    RayLanes {
        rdir: Vector3::from_fn(|i| rays[i].rdir),
        ..RayLanes::new(
            Vector3::from_fn(|i| rays[i].org),
            Vector3::from_fn(|i| rays[i].dir),
            f32x8::from_fn(|i| rays[i].t_near),
            f32x8::from_fn(|i| rays[i].t_far),
        )
    }
}

/// What one run of comparisons saw, so that a test can say that it was not about nothing.
#[derive(Default, Debug)]
struct Seen {
    rays: usize,
    hits: usize,
}

/// All queries about these rays against brute force.
fn agree(scene: &Scene, rays: &[Ray]) -> Seen {
    let mut traversal = Traversal::new(());
    let mut seen = Seen::default();
    let want: Vec<Hit> = rays.iter().map(|ray| scene.brute_force(ray)).collect();
    for (ray, want) in rays.iter().zip(&want) {
        let got = scene.closest_hit(ray, &mut traversal);
        assert_eq!(bits(got), bits(*want), "single {got:?}, brute force {want:?}: {ray:?}");
        let hits = want.primitive != PrimitiveId::NONE;
        assert_eq!(scene.occluded(ray, &mut traversal), hits, "{want:?}: {ray:?}");
        assert!(!hits || ray.t_near < want.t && want.t <= ray.t_far, "{want:?}: {ray:?}");
        seen.rays += 1;
        seen.hits += usize::from(hits);
    }
    let mut random = Random::new(rays.len() as u64);
    // Neighbours together (coherent, if the rays came so), strangers together, and one origin or ray eight times.
    let neighbours =
        (0..rays.len()).map(|i| std::array::from_fn(|lane| (i / 8 * 8 + lane) % rays.len())).step_by(8);
    let strangers = (0..rays.len().div_ceil(8)).map(|_| [(); 8].map(|()| random.below(rays.len())));
    let strangers: Vec<[usize; 8]> = strangers.collect();
    let same = (0..rays.len()).step_by(31).map(|i| [i; 8]);
    for (i, group) in neighbours.chain(strangers).chain(same).enumerate() {
        let active = [0xff, 0xff, 0xff, 0x01, 0x80, 0x5a, 0, 0x7f, 0x0f, 0x33][i % 10];
        compare_packet(scene, group.map(|i| rays[i]), group.map(|i| want[i]), active, &mut traversal);
    }
    every_way(scene, rays, &want);
    seen
}

/// Streams by each way, in the order given and by octant, so that tiles are whole and of one octant.
fn every_way(scene: &Scene, rays: &[Ray], want: &[Hit]) {
    let octant = |i: &usize| {
        let negative = rays[*i].rdir.cmplt(Vec3::ZERO);
        (negative.x, negative.y, negative.z)
    };
    let given: Vec<usize> = (0..rays.len()).collect();
    let mut by_octant = given.clone();
    by_octant.sort_by_key(octant);
    // Rays that end at their hits hit the same; and segments with an end are what occlusion rays are.
    let ends = |i: usize| {
        let (ray, hit) = (&rays[i], &want[i]);
        let end = if hit.primitive == PrimitiveId::NONE { ray.t_near.max(1.0) * 4.0 } else { hit.t };
        end.min(ray.t_far)
    };
    let all = |i: usize| rays[i].t_far;
    let orders =
        [(&given, &all as &dyn Fn(usize) -> f32), (&by_octant, &all), (&given, &ends), (&by_octant, &ends)];
    for (order, t_far) in orders {
        let stream: Vec<Ray32> =
            order.iter().map(|&i| Ray32::new(rays[i].org, rays[i].dir, rays[i].t_near, t_far(i))).collect();
        for way in [Way::Chosen, Way::Tile, Way::Packet, Way::Wave] {
            let mut tracer = Tracer::new(());
            let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![9; rays.len()]);
            scene.closest_hits_by(&stream, &mut hits, way, &mut tracer);
            scene.occluded_stream_by(&stream, &mut blocked, way, &mut tracer);
            for ((&i, got), blocked) in order.iter().zip(hits).zip(blocked) {
                assert_eq!(bits(got), bits(want[i]), "{way:?}: {got:?}, {:?}: {:?}", want[i], rays[i]);
                let hits = want[i].primitive != PrimitiveId::NONE;
                assert_eq!(blocked, u8::from(hits), "{way:?}: {:?}: {:?}", want[i], rays[i]);
            }
        }
    }
}

fn compare_packet(scene: &Scene, mut rays: [Ray; 8], want: [Hit; 8], active: u32, traversal: &mut Traversal) {
    // Lanes without work may hold anything.
    let number = want.iter().map(|hit| hit.primitive.0 as usize % 5).sum::<usize>();
    for (lane, ray) in rays.iter_mut().enumerate().filter(|&(lane, _)| active >> lane & 1 == 0) {
        let rubbish =
            [f32::NAN, f32::INFINITY, -1.0, f32::NAN, f32::NAN][(lane + active as usize + number) % 5];
        *ray = Ray::new(Vec3::splat(rubbish), Vec3::splat(-rubbish), rubbish, rubbish);
    }
    let packet = packet(&rays);
    let mask = <Mask8 as packlight::simd::Mask>::from_bitmask(active);
    let got = scene.closest_hit_packet(&packet, mask, traversal);
    let blocked = scene.occluded_packet(&packet, mask, traversal);
    for lane in 0..8 {
        let hit = Hit {
            t: got.t.lane(lane),
            u: got.u.lane(lane),
            v: got.v.lane(lane),
            primitive: PrimitiveId(packlight::simd::Bits::lane(got.primitive, lane)),
        };
        let want = if active >> lane & 1 == 0 { Hit::MISS } else { want[lane] };
        assert_eq!(bits(hit), bits(want), "lane {lane} of {active:08b}: {hit:?}, {want:?}: {rays:?}");
        assert_eq!(
            blocked.lane(lane),
            want.primitive != PrimitiveId::NONE,
            "lane {lane} of {active:08b}: {rays:?}"
        );
    }
}

/// `count` rays of each kind at a scene.
fn check(name: &str, description: &SceneDescription, count: usize) -> Seen {
    let scene = compile(description).expect("the scene compiles");
    let rays = rays_at(&targets(description), count, &mut Random::new(count as u64));
    let seen = agree(&scene, &rays);
    println!("{name}: {seen:?}");
    seen
}

#[test]
fn a_small_soup() {
    let seen = check("soup", &scenes::soup(800), 1500);
    assert!(seen.hits * 4 > seen.rays, "{seen:?}");
}

#[test]
fn ties_go_to_the_lowest_number() {
    let description = scenes::quads();
    let seen = check("quads", &description, 1500);
    assert!(seen.hits * 10 > seen.rays, "{seen:?}");
    // Every quad is there three times; the first to come wins.
    let scene = compile(&description).unwrap();
    let third = (description.shapes.len() / 3 * 2) as u32;
    let mut hits = 0;
    for i in 0..200 {
        let org = Vec3::new(0.05 * (i % 20) as f32 + 0.01, 0.1 * (i / 20) as f32 + 0.03, 5.0);
        let hit = scene.closest_hit(&Ray::new(org, -Vec3::Z, 0.0, f32::INFINITY), &mut Traversal::new(()));
        if hit.primitive != PrimitiveId::NONE {
            assert!(hit.primitive.0 < third, "{hit:?}");
            hits += 1;
        }
    }
    assert!(hits > 100);
}

#[test]
fn spheres_disks_cylinders_and_triangles() {
    let seen = check("mixed", &scenes::mixed(400), 1500);
    assert!(seen.hits * 4 > seen.rays, "{seen:?}");
}

#[test]
fn a_packet_beside_a_plane_of_a_box_does_not_lose_it() {
    // The ray of lane 0 runs in the plane x = 1, where the box begins, with the direction −0; the others
    // come from the right side of it, and their finite reciprocals must not speak for the infinite one.
    let description = scenes::fence();
    let scene = compile(&description).unwrap();
    for sign in [1.0f32, -1.0] {
        for axis in 0..3 {
            for plane in [1.0f32, 2.0, -1.0, -2.0] {
                for zero in [0.0f32, -0.0] {
                    let rays: Vec<Ray> = (0..8)
                        .map(|lane| {
                            let (mut org, mut dir) = (Vec3::splat(1.5), Vec3::splat(-sign));
                            org[(axis + 1) % 3] = 5.0 * sign;
                            org[(axis + 2) % 3] = if lane % 2 == 0 { 1.5 } else { 1.25 };
                            org[axis] = plane;
                            dir[(axis + 2) % 3] *= 1e-3;
                            dir[axis] = if lane == 0 { zero } else { -sign * lane as f32 * 0.125 };
                            Ray::new(org, dir, 0.0, f32::INFINITY)
                        })
                        .collect();
                    agree(&scene, &rays);
                }
            }
        }
    }
}

#[test]
fn directions_have_any_length() {
    for (name, description) in [("soup", scenes::soup(150)), ("mixed", scenes::mixed(50))] {
        let some = rays_at(&targets(&description), 8, &mut Random::new(21));
        let scaled = |factor: f32| {
            let longer =
                move |ray: &Ray| Ray::new(ray.org, ray.dir * factor, ray.t_near / factor, ray.t_far / factor);
            some.iter()
                .map(longer)
                .filter(|ray| Ray32::new(ray.org, ray.dir, ray.t_near, ray.t_far).is_valid())
        };
        let rays: Vec<Ray> =
            [1e-34, 1e-28, 1e-20, 1e-17, 1e-12, 1e-6, 1e8, 1e15].into_iter().flat_map(scaled).collect();
        let seen = agree(&compile(&description).unwrap(), &rays);
        assert!(seen.hits * 8 > seen.rays, "{name}: {seen:?}");
    }
}

/// Along an axis at a corner that bounds a box, from where rounding leaves nothing else of a scene.
#[test]
fn origins_have_any_distance() {
    for (name, description) in [("soup", scenes::soup(150)), ("mixed", scenes::mixed(50))] {
        let mut rays = vec![];
        for corner in targets(&description).iter().flatten() {
            for (distance, axis) in [1e7, 1e13, 1e16].into_iter().flat_map(|d| [(d, 0), (d, 1), (d, 2)]) {
                let (mut org, mut dir) = (*corner, Vec3::ZERO);
                (org[axis], dir[axis]) = (distance, -1.0);
                rays.push(Ray::new(org, dir, 0.0, f32::INFINITY));
            }
        }
        let seen = agree(&compile(&description).unwrap(), &rays);
        assert!(seen.hits * 8 > seen.rays, "{name}: {seen:?}");
    }
}

#[test]
fn the_bunny() {
    if let Some(path) = shared("meshes/stanford-bunny.obj") {
        let seen = check("bunny", &scenes::read(&path), 40);
        assert!(seen.hits * 4 > seen.rays, "{seen:?}");
    }
}

#[test]
fn awkward_meshes() {
    let Some(folder) = shared("awkward") else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for path in files.iter().filter(|path| path.extension().is_some_and(|e| e == "ply")) {
        let description = scenes::read(path);
        let triangles = scenes::triangles(&description);
        let count = (2_500_000 / (triangles + 1)).clamp(6, 400);
        check(&path.file_name().unwrap().to_string_lossy(), &description, count);
    }
}

#[test]
fn an_empty_scene_is_never_hit() {
    let seen = check("empty", &SceneDescription::default(), 20);
    assert_eq!(seen.hits, 0);
}

#[test]
fn scenes_of_one() {
    for (name, description) in
        [("triangle", scenes::soup(1)), ("sphere", scenes::one_sphere()), ("two", scenes::soup(2))]
    {
        assert!(check(name, &description, 200).hits > 50);
    }
}

/// What blocked rays in one tree says nothing about another, which may be smaller.
#[test]
fn a_tracer_goes_from_tree_to_tree() {
    let [large, small] = [scenes::soup(2000), scenes::soup(2)].map(|scene| (compile(&scene).unwrap(), scene));
    let some = |count| rays_at(&targets(&small.1), count, &mut Random::new(3));
    // Each of many rays is blocked where the one before it was.
    let [a, b, c] = targets(&large.1)[1999];
    let again = vec![Ray::new(Vec3::splat(3.0), (a + b + c) / 3.0 - 3.0, 0.0, f32::INFINITY); 640];
    let mut tracer = Tracer::new(());
    for (scene, rays) in [(&large.0, &again), (&small.0, &some(60)), (&large.0, &again), (&small.0, &some(3))]
    {
        let stream: Vec<Ray32> =
            rays.iter().map(|ray| Ray32::new(ray.org, ray.dir, ray.t_near, ray.t_far)).collect();
        let mut blocked = vec![9; rays.len()];
        scene.occluded_stream_by(&stream, &mut blocked, Way::Chosen, &mut tracer);
        for (ray, blocked) in rays.iter().zip(blocked) {
            let want = scene.brute_force(ray).primitive != PrimitiveId::NONE;
            assert_eq!(blocked, u8::from(want), "{ray:?}");
        }
    }
}

#[test]
fn a_thousand_equal_triangles() {
    let description = scenes::equal(1000);
    let seen = check("equal", &description, 150);
    assert!(seen.hits > 100, "{seen:?}");
    let scene = compile(&description).unwrap();
    for ray in rays_at(&targets(&description), 150, &mut Random::new(1)) {
        let hit = scene.closest_hit(&ray, &mut Traversal::new(()));
        assert!(hit.primitive == PrimitiveId::NONE || hit.primitive == PrimitiveId(0), "{hit:?}");
    }
}

#[test]
fn triangles_without_area_are_never_hit() {
    let seen = check("degenerate", &scenes::degenerate(), 100);
    assert_eq!(seen.hits, 0);
}

#[test]
fn instances_everywhere() {
    let groups: [(&str, &dyn Fn() -> SceneDescription); 3] =
        [("soup", &|| scenes::soup(300)), ("mixed", &|| scenes::mixed(100)), ("quads", &scenes::quads)];
    for (name, group) in groups {
        let seen = check(name, &placed::everywhere(group), 250);
        assert!(seen.hits * 4 > seen.rays, "{name}: {seen:?}");
    }
}

const RAYS: usize = 4000;
/// Triangles of a hundredth stand at 1.5: rounding of positions is thousandths of them.
const CLOSE: f32 = 1e-2;

#[test]
fn an_instance_is_what_its_group_is_elsewhere() {
    let mut description = placed::everywhere(&placed::any_map);
    // What is a thousandth of its distance from the origin has a thousandth of its bits in float coordinates.
    // And points and lines, moved, have an area by rounding.
    let fine = |instance: &Instance| {
        instance.to_world.matrix3.determinant().abs() > 1e-2 && instance.group != placed::DEGENERATE
    };
    description.instances.retain(fine);
    // Somebody asks for the texture coordinates of spheres, too.
    description.aovs = vec![AovChannel { name: "uv".into(), kind: Aov::Uv }];
    let flat = placed::flattened(&description);
    let (scene, flat) = (compile(&description).unwrap(), compile(&flat).unwrap());
    let own = scenes::quads().shapes.len() as u32 * 2;
    let targets = targets(&description);
    let mut random = Random::new(5);
    let mut traversal = Traversal::new(());
    let (mut inside, mut others) = (0, 0);
    for _ in 0..RAYS {
        // At the inside of something: which side of an edge a ray passes is a matter of rounding.
        let [a, b, c] = targets[random.below(targets.len())];
        let (s, t) = (0.1 + 0.4 * random.unit(), 0.1 + 0.4 * random.unit());
        let org = random.vector() * 3.0;
        let ray = Ray::new(org, a + (b - a) * s + (c - a) * t - org, 0.0, f32::INFINITY);
        let (a, b) = (scene.closest_hit(&ray, &mut traversal), flat.closest_hit(&ray, &mut traversal));
        if a.primitive == PrimitiveId::NONE || a.primitive.0 < own {
            others += usize::from(a.primitive != b.primitive);
            continue;
        }
        inside += 1;
        let line = (ray.org.into(), ray.dir.into());
        let at = |scene: &Scene, hit: Hit| {
            let asked = Asked { oriented: true, mapped: true };
            scene.surface::<f32>(line, (hit.t, hit.u, hit.v), hit.primitive.0, asked)
        };
        if b.primitive == PrimitiveId::NONE || (a.t - b.t).abs() > 1e-4 * a.t {
            others += 1;
            continue;
        }
        let (p, q) = (at(&scene, a), at(&flat, b));
        let size = ray.org.length() + a.t * ray.dir.length();
        let like = |a: Vector3<f32>, b: Vector3<f32>, to: f32| Vec3::from(a - b).length() < CLOSE * to;
        let partial = |k: usize| {
            let (a, b) = (p.partials[k], q.partials[k]);
            like(a, b, Vec3::from(a).length())
        };
        // A mesh that is mirrored shows the other side, an instance of it the same.
        let faces = like(p.n_g, q.n_g, 1.0) || like(p.n_g, -q.n_g, 1.0);
        let same = like(p.position, q.position, 1e-2 * size)
            && scene.material(a.primitive, a.u) == flat.material(b.primitive, b.u)
            && (p.uv.u - q.uv.u).abs() < CLOSE
            && (p.uv.v - q.uv.v).abs() < CLOSE
            && faces
            && like(p.frame.s, q.frame.s, 1.0)
            && partial(0)
            && partial(1);
        others += usize::from(!same);
    }
    println!("{inside} rays at instances, {others} of which rounding decides");
    assert!(inside * 3 > RAYS && others * 100 < RAYS, "{inside} {others}");
}
