//! Measurements at scattered directions to a table.
//!
//! An isotropic, reciprocal f is a function of
//!
//! ```text
//! (sin θ_i sin θ_o, Δφ/π, cos θ_i cos θ_o)        Δφ in [0, π]
//! ```
//!
//! in which directions that reflect alike are near each other \[Mar98\]. There f is the mean of the
//! measurements, each weighted by exp(−4 d²/h²), where h is the distance of the eighth nearest: it changes
//! steadily from place to place, and so does f.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use crate::scene::MerlTable;

/// f at a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scattered {
    /// Angle of the light from the normal, radians, in [0, π/2].
    pub(super) theta_i: f64,
    /// Angle of the viewer.
    pub(super) theta_o: f64,
    /// φ_o − φ_i, radians.
    pub(super) turn: f64,
    /// Linear sRGB, per steradian.
    pub(super) value: [f32; 3],
}

/// Nodes of the grid along each coordinate: finer than the kernel is wide.
const NODES: usize = 48;
/// Measurements that make up most of a mean.
const NEIGHBOURS: usize = 8;
/// −4 d²/h², at which a weight is next to nothing.
const FAR: f64 = -16.0;

/// The table of scattered measurements; `None` if there are fewer than eight.
pub(super) fn tabulate(measurements: &[Scattered]) -> Option<MerlTable> {
    if measurements.len() < NEIGHBOURS {
        return None;
    }
    let points: Vec<(DVec3, DVec3)> = measurements
        .iter()
        .map(|m| (mapped(m.theta_i, m.theta_o, m.turn), Vec3::from(m.value).as_dvec3()))
        .collect();
    let grid = Grid::new(&points);
    Some(MerlTable::tabulate(|wo, wi| {
        let theta = |w: Vec3| libm::acos(f64::from(w.z).clamp(-1.0, 1.0));
        let phi = |w: Vec3| libm::atan2(f64::from(w.y), f64::from(w.x));
        grid.fetch(mapped(theta(wi), theta(wo), phi(wo) - phi(wi)))
    }))
}

fn mapped(theta_i: f64, theta_o: f64, turn: f64) -> DVec3 {
    let ((sin_i, cos_i), (sin_o, cos_o)) = (libm::sincos(theta_i), libm::sincos(theta_o));
    let turn = turn.rem_euclid(TAU);
    DVec3::new(sin_i * sin_o, turn.min(TAU - turn) / PI, cos_i * cos_o)
}

/// f at the nodes of the unit cube.
struct Grid(Vec<Vec3>);

impl Grid {
    fn new(points: &[(DVec3, DVec3)]) -> Self {
        let at = |i: usize| (i % NODES) as f64 / (NODES - 1) as f64;
        let mut squares = Vec::new();
        let node = |i: usize| {
            let node = DVec3::new(at(i), at(i / NODES), at(i / NODES / NODES));
            mean(node, points, &mut squares)
        };
        Self((0..NODES.pow(3)).map(node).collect())
    }

    /// Linear between nodes.
    fn fetch(&self, p: DVec3) -> Vec3 {
        let place = p.clamp(DVec3::ZERO, DVec3::ONE) * (NODES - 1) as f64;
        let low = place.floor().min(DVec3::splat((NODES - 2) as f64));
        let (part, low) = ((place - low).as_vec3(), low.as_uvec3());
        let mut sum = Vec3::ZERO;
        for corner in 0..8u32 {
            let far = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = |k: usize| if far[k] == 1 { part[k] } else { 1.0 - part[k] };
            let [x, y, z] = [0, 1, 2].map(|k| (low[k] + far[k]) as usize);
            sum += self.0[(z * NODES + y) * NODES + x] * (weight(0) * weight(1) * weight(2));
        }
        sum
    }
}

/// The weighted mean of the measurements about a point; `squares` is room to work in.
fn mean(about: DVec3, points: &[(DVec3, DVec3)], squares: &mut Vec<f64>) -> Vec3 {
    squares.clear();
    squares.extend(points.iter().map(|(p, _)| p.distance_squared(about)));
    let mut nearest = [f64::INFINITY; NEIGHBOURS];
    for &square in squares.iter() {
        if square < nearest[NEIGHBOURS - 1] {
            nearest[NEIGHBOURS - 1] = square;
            nearest.sort_by(f64::total_cmp);
        }
    }
    // Measurements that stand in one place have no distance.
    let h2 = nearest[NEIGHBOURS - 1].max(1e-9);
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for (&square, (_, value)) in squares.iter().zip(points) {
        let exponent = -4.0 * square / h2;
        if exponent >= FAR {
            let weight = libm::exp(exponent);
            sum += *value * weight;
            weights += weight;
        }
    }
    (sum / weights).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Measured;

    /// A broad lobe about the mirror direction; as of any isotropic surface, it is even in the turn, and where
    /// one direction is the normal there is no turn to depend on.
    fn lobe(theta_i: f64, theta_o: f64, turn: f64) -> f64 {
        let p = mapped(theta_i, theta_o, turn);
        0.2 + p.x * (0.25 - 0.15 * turn.cos())
    }

    #[test]
    fn a_smooth_function_comes_back() {
        let mut measurements = Vec::new();
        let angle = |i: i32| f64::from(i) * 0.13;
        for (i, o, t) in (0..12).flat_map(|i| (0..12).flat_map(move |o| (0..16).map(move |t| (i, o, t)))) {
            let (theta_i, theta_o, turn) = (angle(i), angle(o), f64::from(t) * 0.2);
            let value = [lobe(theta_i, theta_o, turn) as f32; 3];
            measurements.push(Scattered { theta_i, theta_o, turn, value });
        }
        let table = tabulate(&measurements).unwrap();
        let measured = Measured { table: &table };
        for (theta_i, theta_o, turn) in [(0.3, 0.5, 2.0), (0.9, 0.7, 3.1), (1.1, 0.2, 0.4), (0.0, 0.8, 1.0)] {
            let direction = |theta: f64, phi: f64| {
                let (sin, cos) = theta.sin_cos();
                DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
            };
            let (wi, wo) = (direction(theta_i, 0.3), direction(theta_o, 0.3 + turn));
            let got = f64::from(measured.eval::<f32>(wo.into(), wi.into()).x / wi.z);
            let want = lobe(theta_i, theta_o, turn);
            assert!((got - want).abs() < 0.02, "{theta_i} {theta_o} {turn}: {got}, not {want}");
        }
    }

    #[test]
    fn a_few_measurements_are_too_few() {
        let one = Scattered { theta_i: 0.1, theta_o: 0.2, turn: 0.3, value: [0.5; 3] };
        assert!(tabulate(&[one; 7]).is_none());
        let table = tabulate(&[one; 8]).unwrap();
        let f = Measured { table: &table }.eval::<f32>(Vec3::Z.into(), Vec3::Z.into()).x;
        assert!((f - 0.5).abs() < 1e-5, "{f}");
    }
}
