//! Rays at the edges and vertices that triangles share: none may pass between them.
//!
//! A ray crosses a surface at an edge if the two triangles there lie on different sides of the plane through
//! its origin and the edge, and at a vertex if the triangles around it go round the ray once. Both are asked
//! in double precision, with room for the rounding of the ray itself; edges seen in profile, where a ray may
//! pass, are left out. Such a ray must hit something no farther away than its target: the two triangles, if
//! nothing is before them. So a mesh need not be closed to be tested where it is, and other things may stand
//! around it.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{Exhibit, Expected, aim::Random};
use crate::bvh::Traversal;
use crate::compile::Scene;
use crate::geometry::{Aabb, PrimitiveId, Ray32};

/// Rays that a thread takes at a time.
const CHUNK: u64 = 16_384;
/// Least height of a triangle over the plane through an edge and the ray's origin, in lengths of its side;
/// and least sine of the angle between a ray and a triangle.
const CLEAR: f64 = 0.02;
/// Bound on what rounding a direction moves the ray by at its target, in units of the distance; and on what
/// rounding a point of an edge moves that off the edge, in units of its coordinates.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Cracks {
    /// Edges that two triangles share.
    pub edges: u64,
    /// Vertices with triangles all around.
    pub vertices: u64,
    /// Rays at them that must hit.
    pub rays: u64,
    /// Rays that passed.
    pub leaks: u64,
    /// The first of them.
    pub exhibit: Option<Exhibit>,
}

/// Triangles that meet in positions that are the same to the bit.
#[derive(Debug, Default)]
pub struct Seams {
    /// Two ends, and the third vertices of the two triangles.
    edges: Vec<[Vec3; 4]>,
    /// A vertex, and where the vertices around it are in `rings`.
    vertices: Vec<(Vec3, std::ops::Range<usize>)>,
    /// In their order around the vertex.
    rings: Vec<Vec3>,
    bounds: Option<Aabb>,
}

impl Seams {
    /// Of all triangles of a scene that have area.
    pub fn of(scene: &Scene) -> Self {
        let triangles = (0..scene.primitive_count()).filter_map(|i| scene.triangle(PrimitiveId(i)));
        Self::of_triangles(triangles.filter(|[a, b, c]| (*b - *a).cross(*c - *a) != Vec3::ZERO))
    }

    fn of_triangles(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
        // Each corner: its vertex, the next and the one after.
        let mut corners: Vec<[Vec3; 3]> =
            triangles.flat_map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]).collect();
        corners.par_sort_unstable_by_key(|&[a, b, _]| (key(a), key(b)));
        let find = |a: Vec3, b: Vec3| {
            let wanted = (key(a), key(b));
            let first = corners.partition_point(|&[a, b, _]| (key(a), key(b)) < wanted);
            let mut same = corners[first..].iter().take_while(|&&[a, b, _]| (key(a), key(b)) == wanted);
            // An edge that three triangles share has no two sides.
            same.next().filter(|_| same.next().is_none())
        };
        let mut seams = Self::default();
        for &[a, b, c] in corners.iter().filter(|&&[a, b, _]| key(a) < key(b)) {
            if let (Some(_), Some(&[_, _, other])) = (find(a, b), find(b, a)) {
                seams.edges.push([a, b, c, other]);
            }
        }
        for fan in corners.chunk_by(|a, b| key(a[0]) == key(b[0])) {
            let vertex = fan[0][0];
            let first = seams.rings.len();
            let mut next = fan[0][1];
            // From edge to edge around the vertex, until the first comes again.
            for _ in fan {
                seams.rings.push(next);
                match find(vertex, next) {
                    Some(&[_, _, after]) => next = after,
                    None => break,
                }
            }
            if seams.rings.len() - first == fan.len() && key(next) == key(fan[0][1]) {
                seams.vertices.push((vertex, first..seams.rings.len()));
            } else {
                seams.rings.truncate(first);
            }
        }
        seams.bounds = (!corners.is_empty()).then(|| Aabb::of_points(corners.iter().map(|corner| corner[0])));
        seams
    }

    /// A ray that must hit something up to the end it has, with the triangles that it is aimed between;
    /// `None` if what was drawn is seen in profile.
    fn aim(&self, bounds: Aabb, random: &mut Random) -> Option<(Ray32, Vec<[Vec3; 3]>)> {
        let size = bounds.max - bounds.min;
        // Flat things are looked at from above, too.
        let around = size.max(Vec3::splat(0.3 * size.max_element()));
        let org = bounds.centre() + random.vector() * around * (0.3 + random.unit());
        let at_vertex = self.edges.is_empty() || random.unit() < 0.5;
        let (target, ring, triangles) = if at_vertex {
            let (vertex, ring) = self.vertices.get(random.below(self.vertices.len().max(1)))?;
            let ring = &self.rings[ring.clone()];
            let fan = (0..ring.len()).map(|i| [*vertex, ring[i], ring[(i + 1) % ring.len()]]);
            (*vertex, ring, fan.collect())
        } else {
            let [a, b, c, other] = self.edges[random.below(self.edges.len())];
            let on = a + (b - a) * (0.1 + 0.8 * random.unit());
            (on, &[b, c, a, other][..], vec![[a, b, c], [b, a, other]])
        };
        let dir = target - org;
        let [from, to, way] = [org, target, dir].map(Vec3::as_dvec3);
        let off = if at_vertex { 0.0 } else { to.abs().max_element() };
        let blur = ROUNDING * (off + way.length());
        let sine = profile(from, to, ring, blur)?;
        // A ray of unit length is another ray: its target is off by the rounding of its direction.
        let (dir, end) = if random.unit() < 0.5 { (dir, 1.0) } else { (dir.normalize(), dir.length()) };
        let slack = blur / (way.length() * sine);
        let ray = Ray32::new(org, dir, 0.0, end * (1.0 + slack as f32));
        (slack < 1e-2 && ray.is_valid()).then_some((ray, triangles))
    }
}

/// The least sine between the ray and the triangles around its target, if they go round it once, each by a
/// margin.
fn profile(org: DVec3, target: DVec3, ring: &[Vec3], blur: f64) -> Option<f64> {
    let way = (target - org).normalize_or_zero();
    let spokes = |i: usize| ring[i % ring.len()].as_dvec3() - target;
    let mut sine = f64::INFINITY;
    let (mut turn, mut side) = (0.0, 0.0);
    for i in 0..ring.len() {
        let (a, b) = (spokes(i), spokes(i + 1));
        let n = a.cross(b);
        let (p, q) = (a - way * a.dot(way), b - way * b.dot(way));
        // Of two spokes along one edge there is no triangle between them.
        let area = way.dot(n);
        let flat = p.length().min(q.length());
        let clear = CLEAR * p.length() * q.length();
        if flat < 16.0 * blur || area.abs() < clear || area * side < 0.0 {
            return None;
        }
        side = area;
        sine = sine.min(area.abs() / n.length());
        turn += f64::atan2(area, p.dot(q));
    }
    let once = (turn.abs() - std::f64::consts::TAU).abs() < 1e-6;
    (once && sine > CLEAR).then_some(sine)
}

/// Aims about `rays` rays, the same ones each time.
pub fn cracks(scene: &Scene, seams: &Seams, rays: u64) -> Cracks {
    let mut found = Cracks {
        edges: seams.edges.len() as u64,
        vertices: seams.vertices.len() as u64,
        ..Cracks::default()
    };
    let Some(bounds) = seams.bounds.filter(|_| found.edges + found.vertices > 0) else {
        return found;
    };
    let each: Vec<(u64, u64, Option<Exhibit>)> =
        (0..rays.div_ceil(CHUNK)).into_par_iter().map(|seed| chunk(scene, seams, bounds, seed)).collect();
    for (rays, leaks, exhibit) in each {
        found.rays += rays;
        found.leaks += leaks;
        found.exhibit = found.exhibit.or(exhibit);
    }
    found
}

fn chunk(scene: &Scene, seams: &Seams, bounds: Aabb, seed: u64) -> (u64, u64, Option<Exhibit>) {
    let (mut random, mut traversal) = (Random::new(seed), Traversal::new(()));
    let (mut rays, mut leaks, mut exhibit) = (0, 0, None);
    for (ray, triangles) in (0..CHUNK).filter_map(|_| seams.aim(bounds, &mut random)) {
        rays += 1;
        if !scene.occluded(&ray.ray(), &mut traversal) {
            leaks += 1;
            exhibit.get_or_insert_with(|| Exhibit {
                what: "a ray passes between triangles".into(),
                triangles,
                rays: vec![ray],
                expected: Some(Expected::Hit),
            });
        }
    }
    (rays, leaks, exhibit)
}
