//! Where a path leaves a surface, towards a light or to go on.

use crate::compile::Scene;
use crate::geometry::{REACH, offset_origin};
use crate::light::{Light, Reach, Receiver, power_heuristic};
use crate::simd::{Bits, Mask, Real, Vector3};

use super::integrator::Line;

/// Points that rays leave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure<R: Real> {
    /// World space.
    pub(super) position: Vector3<R>,
    /// Size of the surface around it.
    pub(super) extent: Vector3<R>,
    /// Geometric normal, unit length, of either side.
    pub(super) n_g: Vector3<R>,
    /// Shading normal, on the side that light is received on.
    pub(super) n: Vector3<R>,
}

/// Light from one emitter, to be added if it is not blocked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connection<R: Real> {
    pub(super) lanes: R::Mask,
    /// (org, dir, `t_far`).
    pub(super) ray: (Vector3<R>, Vector3<R>, R),
    pub(super) radiance: Vector3<R>,
}

impl<R: Real> Departure<R> {
    /// The ray from the surface along a world direction.
    #[inline]
    pub(super) fn leave(&self, dir: Vector3<R>) -> Line<R> {
        (offset_origin(self.position, self.extent, self.n_g, dir), dir)
    }

    /// Light from one emitter that was picked with some probability. `eval` says what radiance from a
    /// direction is worth, and the density with which BSDF sampling draws it; `mis` weighs against that.
    #[inline]
    pub(super) fn connect(
        &self,
        light: &Light,
        pick: R,
        mis: bool,
        u: (R, R),
        eval: &impl Fn(Vector3<R>) -> (Vector3<R>, R),
    ) -> Connection<R> {
        let sample = light.sample(&Receiver { position: self.position, n: self.n }, u);
        let (worth, bsdf_pdf) = eval(sample.wi);
        let light_pdf = sample.pdf * pick;
        let can_be_hit = sample.pdf.gt(R::zero());
        let weight = if mis {
            R::select(can_be_hit, power_heuristic(light_pdf, bsdf_pdf), R::one())
        } else {
            R::one()
        };
        let radiance = (worth * sample.weight).scale(weight * (R::one() / pick));
        let (org, _) = self.leave(sample.wi);
        let (dir, t_far) = match sample.reach {
            Reach::Target => (sample.target - org, R::splat(REACH)),
            Reach::Infinity => (sample.wi, R::splat(f32::INFINITY)),
            Reach::Unhindered => (sample.wi, R::zero()),
        };
        Connection {
            lanes: sample.valid & radiance.max_element().gt(R::zero()),
            ray: (org, dir, t_far),
            radiance,
        }
    }

    /// Light from one emitter a lane, chosen by [`LightChoice`](crate::light::LightChoice). `None` if there
    /// is no light.
    #[inline]
    pub(super) fn connect_one(
        &self,
        scene: &Scene,
        (u, v): (R, R),
        eval: &impl Fn(Vector3<R>) -> (Vector3<R>, R),
    ) -> Option<Connection<R>> {
        if scene.lights.is_empty() {
            return None;
        }
        let (chosen, rest) = scene.light_choice.choose(u, self.position);
        let mut all: Option<Connection<R>> = None;
        for (index, lanes) in distinct::<R>(chosen) {
            let pick = scene.light_choice.probability(index as usize, self.position);
            let one = self.connect(&scene.lights[index as usize], pick, true, (rest, v), eval);
            all = Some(match all {
                None => Connection { lanes: one.lanes & lanes, ..one },
                Some(all) => Connection {
                    lanes: (all.lanes & !lanes) | (one.lanes & lanes),
                    ray: (
                        Vector3::select(lanes, one.ray.0, all.ray.0),
                        Vector3::select(lanes, one.ray.1, all.ray.1),
                        R::select(lanes, one.ray.2, all.ray.2),
                    ),
                    radiance: Vector3::select(lanes, one.radiance, all.radiance),
                },
            });
        }
        all
    }
}

/// Does [`Departure::connect_one`] look at its pair of numbers?
#[inline]
pub(super) fn draws_one(scene: &Scene) -> bool {
    match &scene.lights[..] {
        [] => false,
        [only] => only.is_drawn(),
        _ => true,
    }
}

/// The different values among lanes, each with its lanes.
#[inline]
pub(super) fn distinct<R: Real>(values: R::Bits) -> impl Iterator<Item = (u32, R::Mask)> {
    let mut left = (1u32 << R::LANES) - 1;
    std::iter::from_fn(move || {
        if left == 0 {
            return None;
        }
        let value = values.lane(left.trailing_zeros() as usize);
        let lanes = values.equal(R::Bits::splat(value));
        left &= !lanes.to_bitmask();
        Some((value, lanes))
    })
}
