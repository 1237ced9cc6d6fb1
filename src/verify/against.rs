//! Our hits and somebody else's, of the same triangles.
//!
//! Two programs that round differently differ where rounding decides: about which of two triangles at the
//! same distance, and about rays along edges. What is left is a fault. Vertices are seen from the ray's origin,
//! so no number that is rounded is greater than R: the length of the origin and that of the farthest vertex or
//! point that was hit. In double precision, with δ = R · 2⁻¹⁸ and cos θ between the ray and the normal of the
//! triangle that was hit first, two answers are
//!
//! - *the same* if both are misses, or the same triangle at distances that differ by at most δ/|cos θ|: a plane
//!   that is moved by δ is met so much later;
//! - *a tie* if they are different triangles at distances that differ by at most that;
//! - *at an edge* if the ray passes an edge of the triangle that only one has hit, or that it has hit first, at a
//!   distance of at most δ: a triangle seen edge-on has no other places;
//! - *at an end* if that triangle is within δ/|cos θ| of where the ray begins or ends;
//! - *different* otherwise.

use glam::{DVec3, Vec3};

use crate::geometry::{Hit, PrimitiveId, Ray32};

/// δ/R: 64 times the rounding error of single precision.
const TOLERANCE: f64 = 1.0 / 262_144.0;

/// How answers compare.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Against {
    /// Rays.
    pub rays: u64,
    /// The same answer.
    pub same: u64,
    /// Different triangles at the same distance.
    pub ties: u64,
    /// Where a ray passes an edge, or a triangle is at one of its ends.
    pub at_edges: u64,
    /// What rounding does not explain.
    pub different: u64,
    /// The first of those, as a place in its stream.
    pub first: Option<usize>,
}

impl Against {
    /// Both together; the first difference stays what it is.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.same += other.same;
        self.ties += other.ties;
        self.at_edges += other.at_edges;
        self.different += other.different;
        self.first = self.first.or(other.first);
    }
}

/// Compares answers about rays; primitives are places in the list of triangles.
pub fn compare(triangles: &[[Vec3; 3]], rays: &[Ray32], ours: &[Hit], theirs: &[Hit]) -> Against {
    let mut found = Against { rays: rays.len() as u64, ..Against::default() };
    for (i, ((ray, a), b)) in rays.iter().zip(ours).zip(theirs).enumerate() {
        match judge(triangles, ray, a, b) {
            Verdict::Same => found.same += 1,
            Verdict::Tie => found.ties += 1,
            Verdict::Edge => found.at_edges += 1,
            Verdict::Different => {
                found.different += 1;
                found.first.get_or_insert(i);
            }
        }
    }
    found
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Same,
    Tie,
    Edge,
    Different,
}

fn judge(triangles: &[[Vec3; 3]], ray: &Ray32, a: &Hit, b: &Hit) -> Verdict {
    let missed = |hit: &Hit| hit.primitive == PrimitiveId::NONE;
    if missed(a) && missed(b) {
        return Verdict::Same;
    }
    // A miss is behind everything.
    let (near, far) = if a.t <= b.t { (a, b) } else { (b, a) };
    let triangle = triangles[near.primitive.0 as usize].map(Vec3::as_dvec3);
    let org = DVec3::from(ray.org.map(f64::from));
    let dir = DVec3::from(ray.dir.map(f64::from));
    let length = dir.length();
    let along = |t: f32| f64::from(t) * length;
    let point = org + dir * f64::from(near.t);
    let places = triangle.iter().chain([&point]);
    let reach = org.length() + places.fold(0.0, |reach: f64, place| reach.max(place.length()));
    let tolerance = TOLERANCE * reach;
    let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalize_or_zero();
    let later = tolerance / normal.dot(dir / length).abs();
    if !missed(far) && along(far.t) - along(near.t) <= later {
        return if a.primitive == b.primitive { Verdict::Same } else { Verdict::Tie };
    }
    let ends = [ray.t_near, ray.t_far].map(|end| (along(end) - along(near.t)).abs());
    let edges =
        [(0, 1), (1, 2), (2, 0)].map(|(i, j)| distance((org, dir / length), triangle[i], triangle[j]));
    let is_close =
        ends.into_iter().any(|end| end <= later) || edges.into_iter().any(|edge| edge <= tolerance);
    if is_close { Verdict::Edge } else { Verdict::Different }
}

/// Between a line, its direction of unit length, and a segment: in the plane across the line the line is a
/// point.
fn distance((org, dir): (DVec3, DVec3), from: DVec3, to: DVec3) -> f64 {
    let across = |point: DVec3| (point - org) - dir * (point - org).dot(dir);
    let (from, to) = (across(from), across(to));
    let edge = to - from;
    let place = if edge == DVec3::ZERO { 0.0 } else { -from.dot(edge) / edge.length_squared() };
    (from + edge * place.clamp(0.0, 1.0)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLES: [[Vec3; 3]; 2] =
        [[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::Y]];

    fn ray(x: f32, y: f32) -> Ray32 {
        Ray32::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z * 0.5, 0.0, f32::INFINITY)
    }

    fn hit(t: f32, primitive: u32) -> Hit {
        Hit { t, u: 0.1, v: 0.1, primitive: PrimitiveId(primitive) }
    }

    #[test]
    fn rounding_is_told_from_faults() {
        let inside = ray(0.25, 0.25);
        let grazing =
            Ray32::new(Vec3::new(-0.75, 0.25, 0.01), Vec3::new(1.0, 0.0, -0.01), 0.0, f32::INFINITY);
        for (ray, a, b, verdict) in [
            (inside, Hit::MISS, Hit::MISS, Verdict::Same),
            (inside, hit(4.0, 0), hit(4.000_001, 0), Verdict::Same),
            (inside, hit(4.0, 0), hit(4.000_001, 1), Verdict::Tie),
            (inside, hit(4.0, 0), hit(4.001, 0), Verdict::Different),
            (grazing, hit(1.0, 0), hit(1.000_3, 0), Verdict::Same),
            (grazing, hit(1.0, 0), hit(1.1, 0), Verdict::Different),
            (inside, hit(4.0, 0), hit(5.5, 1), Verdict::Different),
            (inside, hit(5.5, 1), hit(4.0, 0), Verdict::Different),
            (inside, Hit::MISS, hit(4.0, 0), Verdict::Different),
            (ray(0.5, 0.0), Hit::MISS, hit(4.0, 0), Verdict::Edge),
            (ray(0.5, 1e-6), hit(6.0, 1), hit(4.0, 0), Verdict::Edge),
            (ray(0.5, 1e-3), hit(6.0, 1), hit(4.0, 0), Verdict::Different),
            (Ray32 { t_far: 4.0, ..inside }, Hit::MISS, hit(4.0, 0), Verdict::Edge),
        ] {
            assert_eq!(judge(&TRIANGLES, &ray, &a, &b), verdict, "{ray:?} {a:?} {b:?}");
        }
    }

    #[test]
    fn counts_add_up_and_the_first_difference_is_kept() {
        let rays = [ray(0.25, 0.25); 3];
        let found = compare(&TRIANGLES, &rays, &[hit(4.0, 0); 3], &[hit(4.0, 0), Hit::MISS, Hit::MISS]);
        assert_eq!(found, Against { rays: 3, same: 1, different: 2, first: Some(1), ..Against::default() });
        let mut sum = Against::default();
        sum.add(&found);
        sum.add(&Against { first: Some(0), ..found });
        assert_eq!((sum.rays, sum.different, sum.first), (6, 4, Some(1)));
    }

    #[test]
    fn a_line_and_a_segment_are_as_far_apart_as_they_look() {
        let line = (DVec3::ZERO, DVec3::Z);
        let near = |from, to| distance(line, from, to);
        assert_eq!(near(DVec3::new(1.0, -1.0, 5.0), DVec3::new(1.0, 1.0, -7.0)), 1.0);
        assert_eq!(near(DVec3::new(3.0, 4.0, 0.0), DVec3::new(6.0, 8.0, 0.0)), 5.0);
        assert_eq!(near(DVec3::new(3.0, 4.0, 0.0), DVec3::new(3.0, 4.0, 9.0)), 5.0);
    }
}
