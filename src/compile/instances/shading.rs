//! Points on what instances place: found in the group's space, taken to the world.
//!
//! Positions and ∂p/∂u, ∂p/∂v go by the map, normals by its inverse transpose, which keeps outward normals
//! outward even where the map mirrors.

use super::{Instances, Placed};
use crate::compile::{
    Asked,
    surfaces::{Surface, Surfaces, partials::frame_along},
};
use crate::geometry::{AffineLanes, PrimitiveId};
use crate::light::LightId;
use crate::material::MaterialId;
use crate::math::Frame;
use crate::simd::{Bits, MOST, Mask, Real, Vector3};

/// What rays met: (t, u, v) and the primitive.
pub(in crate::compile) type Met<R> = ((R, R, R), <R as Real>::Bits);

impl Instances {
    /// The material of what was hit in an instance; `inside` is the hit's `u`.
    pub(in crate::compile) fn material(&self, primitive: PrimitiveId, inside: f32) -> MaterialId {
        let group = self.placed[(primitive.0 - self.first) as usize].group;
        self.groups[group as usize].surfaces.shape(inside.to_bits()).material
    }

    /// The surfaces of a scene with instances, as [`Surfaces::at`] for one without. `others` are those that
    /// stand in the scene by themselves.
    pub(in crate::compile) fn surface<R: Real>(
        &self,
        others: &Surfaces,
        line: (Vector3<R>, Vector3<R>),
        ((t, u, v), primitive): Met<R>,
        asked: Asked,
    ) -> Surface<R> {
        let all = (1u32 << R::LANES) - 1;
        let set = |f: &dyn Fn(usize) -> bool| (0..R::LANES).fold(0, |set, i| set | u32::from(f(i)) << i);
        let mut rest = set(&|i| self.holds(primitive.lane(i)));
        // Lanes that are not asked for read what the first of the others reads.
        let safe = |lanes: u32| {
            let first = lanes.trailing_zeros() as usize;
            move |i: usize| if lanes >> i & 1 != 0 { i } else { first }
        };
        let mut surface = None;
        if rest != all {
            let safe = safe(all & !rest);
            let weights = (t, R::from_fn(|i| u.lane(safe(i))), R::from_fn(|i| v.lane(safe(i))));
            let primitive = R::Bits::from_fn(|i| primitive.lane(safe(i)));
            surface = Some(others.at(line, weights, primitive, asked));
        }
        while rest != 0 {
            let placed = |i: usize| &self.placed[(primitive.lane(i) - self.first) as usize];
            let group = placed(rest.trailing_zeros() as usize).group;
            let same = rest & set(&|i| rest >> i & 1 != 0 && placed(i).group == group);
            rest &= !same;
            let safe = safe(same);
            let inside = u.to_bits();
            let inside = R::Bits::from_fn(|i| inside.lane(safe(i)));
            let surfaces = &self.groups[group as usize].surfaces;
            let new = at(surfaces, |i| placed(safe(i)), line, (t, inside), asked);
            surface = Some(match surface {
                Some(old) => Surface::select(R::Mask::from_bitmask(same), new, old),
                None => new,
            });
        }
        surface.unwrap_or_else(|| others.at(line, (t, u, v), primitive, asked))
    }
}

/// Points on the surfaces of one group, each by an instance of its own.
#[inline]
fn at<'p, R: Real>(
    surfaces: &Surfaces,
    placed: impl Fn(usize) -> &'p Placed,
    (org, dir): (Vector3<R>, Vector3<R>),
    (t, inside): (R, R::Bits),
    asked: Asked,
) -> Surface<R> {
    let to_group = AffineLanes::<R>::from_fn(|i| &placed(i).placement.to_group);
    let to_world = AffineLanes::<R>::from_fn(|i| &placed(i).placement.to_world);
    let line = (to_group.point(org), to_group.direction(dir));
    let (u, v) = surfaces.barycentric(line, inside);
    let there = surfaces.at(line, (t, u, v), inside, asked);
    let position = to_world.point(there.position);
    let normal = |n: Vector3<R>| to_group.normal_back(n).normalize();
    let (n_g, n_s) = (normal(there.n_g), normal(there.frame.n));
    let partials = there.partials.map(|along| to_world.direction(along));
    Surface {
        position,
        // Rounding on the way to the group's space and back is that of the sizes on the way.
        extent: to_world.reach(there.extent + to_group.magnitude(position)),
        n_g,
        frame: if asked.oriented { frame_along(n_s, partials[0]) } else { Frame::around(n_s) },
        partials,
        uv: there.uv,
        light: R::Bits::splat(LightId::NONE.0),
    }
}

impl Surfaces {
    /// The barycentric weights that the kernel finds for lines (org, dir) and triangles; 0 for other surfaces.
    #[inline]
    fn barycentric<R: Real>(&self, (org, dir): (Vector3<R>, Vector3<R>), primitive: R::Bits) -> (R, R) {
        use crate::compile::primitives::Primitive;
        use crate::geometry::{RayLanes, Triangle, TriangleLanes};
        let nothing = Triangle::new(glam::Vec3::ZERO, glam::Vec3::ZERO, glam::Vec3::ZERO);
        let mut triangles = [nothing; MOST];
        let mut there = 0;
        for (i, triangle) in triangles[..R::LANES].iter_mut().enumerate() {
            if let Primitive::Triangle(found) = self.primitive(primitive.lane(i)) {
                *triangle = found;
                there |= 1 << i;
            }
        }
        let row = |of: fn(&Triangle) -> glam::Vec3| Vector3::from_fn(|i| of(&triangles[i]));
        let edges = R::from_fn(|i| triangles[i].edges());
        let lanes = TriangleLanes { v0: row(|t| t.v0), v1: row(|t| t.v1), v2: row(|t| t.v2), edges };
        let ray = RayLanes::new(org, dir, R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let there = R::Mask::from_bitmask(there);
        let (_, _, u, v) = lanes.intersect(&ray, there);
        (u.only(there), v.only(there))
    }
}
