//! Rays, boxes and the surfaces they hit: equation, one ray, eight rays, in one file each.
//!
//! # What a hit is
//! A surface is hit at t if its equation says so, `t_near < t ≤ t_far`, **and t lies within the slabs of
//! the surface's own bounding box**; t is clamped into that interval first. The clamp changes t only
//! within its rounding error. With it the answer can't depend on a tree: slab arithmetic is monotone
//! ([`aabb`]), so a box that contains the surface's box has an interval that contains t, and is never
//! culled. No epsilon decides a hit, comparisons with NaN are misses, and only a determinant of exactly
//! zero is parallel.

pub mod aabb;
mod affine;
mod canonical;
mod crossing;
mod offset;
mod pencil;
mod placement;
mod ray;
pub mod ray_file;
#[cfg(test)]
pub(crate) mod seeds;
mod sphere;
mod triangle;

pub use aabb::Aabb;
pub use affine::{Affine, AffineLanes};
pub use canonical::{Canonical, CanonicalKind};
pub use offset::{REACH, offset_origin};
pub use pencil::{EdgePlanes, Pencils};
pub use placement::{Entered, Placement};
pub use ray::{Hit, PrimitiveId, Ray, RayLanes, Rayx8, Rayx16};
pub use ray_file::Ray32;
pub use sphere::{Sphere, SphereLanes};
pub use triangle::{Aspect, AspectColumns, Triangle, TriangleLanes};
