//! The numbers behind the plots.

use std::fmt::Write;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Swatch;
use crate::material::proof::Reflector;
use crate::simd::{LANES, Mask, Real, Vec3x8, f32x8};

/// Light in the plane of incidence, and the albedo over the angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// One for each angle of the light.
    pub slices: Vec<Slice>,
    /// From 0 to 89 degrees.
    pub albedo: Vec<Albedo>,
}

/// Where light from one direction goes, within the plane of incidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// θ_i in degrees; the light comes from the left.
    pub light: f32,
    /// Degrees from the normal to the right, and f |cos θ_o| there, per steradian.
    pub points: Vec<(f32, Vec3)>,
    /// What goes into single directions.
    pub spikes: Vec<Spike>,
}

/// A delta lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spike {
    /// Degrees from the normal to the right.
    pub angle: f32,
    /// Share of the light.
    pub share: Vec3,
}

/// What a surface shows of white light from everywhere, seen from an angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Albedo {
    /// Degrees from the normal.
    pub angle: f32,
    /// ∫ f cos θ_i dω over the side of the viewer, a share of what arrives, in [0, 1].
    pub reflected: DVec3,
    /// The same from the other side, as power: radiance over the square of the index.
    pub transmitted: DVec3,
}

/// Angles of the light in the slices.
const LIGHTS: [f32; 5] = [0.0, 20.0, 40.0, 60.0, 80.0];
/// Directions of the lattice by which an albedo is integrated.
const POINTS: usize = 8192;

impl Curves {
    /// Evaluates the swatch, eight directions at a time, on the current rayon pool.
    pub fn new(swatch: &Swatch) -> Self {
        let slices = LIGHTS.par_iter().map(|&light| Slice::new(swatch, light)).collect();
        let albedo = (0..90).into_par_iter().map(|degrees| Albedo::new(swatch, degrees as f32)).collect();
        Self { slices, albedo }
    }

    /// All of it as text: `quantity,incident_degrees,outgoing_degrees,r,g,b`.
    ///
    /// `slice` is f |cos θ_o| per steradian, outgoing degrees counted from the normal away from the light;
    /// `spike` the share of the light that leaves in a single direction; `reflected` and `transmitted` the
    /// albedo, which has no outgoing direction.
    pub fn csv(&self) -> String {
        let mut text = String::from("quantity,incident_degrees,outgoing_degrees,r,g,b\n");
        let mut row = |quantity: &str, light: f32, out: String, rgb: DVec3| {
            // Writing to a string never fails.
            let _ = writeln!(text, "{quantity},{light},{out},{},{},{}", rgb.x, rgb.y, rgb.z);
        };
        for slice in &self.slices {
            for &(angle, value) in &slice.points {
                row("slice", slice.light, angle.to_string(), value.as_dvec3());
            }
            for spike in &slice.spikes {
                row("spike", slice.light, spike.angle.to_string(), spike.share.as_dvec3());
            }
        }
        for albedo in &self.albedo {
            row("reflected", albedo.angle, String::new(), albedo.reflected);
            row("transmitted", albedo.angle, String::new(), albedo.transmitted);
        }
        text
    }
}

impl Slice {
    fn new(swatch: &Swatch, light: f32) -> Self {
        let most = if swatch.transmits() { 180.0 } else { 90.0 };
        // Twice a degree everywhere, fifty times about the mirror direction.
        let coarse = (0..=(4.0 * most) as i32).map(|i| i as f32 * 0.5 - most);
        let fine = (-200..=200).map(|i| light + i as f32 * 0.02);
        let mut angles: Vec<f32> = coarse.chain(fine.filter(|angle| angle.abs() <= most)).collect();
        angles.sort_by(f32::total_cmp);
        angles.dedup();
        let wi = in_plane(-light);
        let points = angles.chunks(LANES).flat_map(|angles| {
            let angle = |i: usize| angles[i.min(angles.len() - 1)];
            let values =
                radiant_intensity(swatch, Vec3x8::splat(wi), Vec3x8::from_fn(|i| in_plane(angle(i))));
            (0..angles.len()).map(move |i| (angle(i), values.lane(i))).collect::<Vec<_>>()
        });
        let points = points.collect();
        let branches = swatch.seen_from::<f32>(wi.into()).branches();
        let spikes = branches.into_iter().filter(|branch| branch.valid).map(|branch| {
            let to = Vec3::from(branch.wi);
            Spike { angle: to.x.atan2(to.z).to_degrees(), share: branch.weight.into() }
        });
        Self { light, points, spikes: spikes.filter(|spike| spike.share.max_element() > 0.0).collect() }
    }
}

/// f(wo, wi) |cos θ_o|: what leaves along `wo` of a unit of irradiance from `wi`.
pub(super) fn radiant_intensity(swatch: &Swatch, wi: Vec3x8, wo: Vec3x8) -> Vec3x8 {
    let (f_cos, _) = swatch.seen_from(wo).eval(wi);
    let ratio = wo.z.abs() / wi.z.abs();
    f_cos.scale(ratio).only(ratio.gt(f32x8::zero()))
}

/// The direction at this angle from the normal, in degrees, to the right in the plane of incidence.
pub(super) fn in_plane(degrees: f32) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin, 0.0, cos)
}

impl Albedo {
    /// The mean weight of samples, delta lobes included, over a lattice in three dimensions.
    pub(super) fn new(model: &impl Reflector<f32x8>, angle: f32) -> Self {
        let wo = Vec3x8::splat(in_plane(angle));
        let (mut reflected, mut transmitted) = (DVec3::ZERO, DVec3::ZERO);
        for first in (0..POINTS).step_by(LANES) {
            let number = |dimension: usize| f32x8::from_fn(|i| lattice(first + i, dimension));
            let sample = model.sample(wo, number(0), (number(1), number(2)));
            let power = sample.weight.scale(sample.eta * sample.eta).only(sample.valid);
            for i in (0..LANES).filter(|i| sample.valid.to_bitmask() >> i & 1 != 0) {
                let side = if sample.wi.z.lane(i) > 0.0 { &mut reflected } else { &mut transmitted };
                *side += power.lane(i).as_dvec3();
            }
        }
        Self { angle, reflected: reflected / POINTS as f64, transmitted: transmitted / POINTS as f64 }
    }

    /// All that leaves, by the channel of which most does.
    pub(super) fn most(&self) -> f64 {
        (self.reflected + self.transmitted).max_element()
    }
}

/// Roberts's R₃ sequence: multiples of the powers of 1 over the root of x⁴ = x + 1, modulo 1.
fn lattice(i: usize, dimension: usize) -> f32 {
    const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_6];
    // Rounded to f32, the last numbers below 1 would be 1.
    ((0.5 + i as f64 * STEPS[dimension]).fract() as f32).min(1.0 - f32::EPSILON / 2.0)
}
