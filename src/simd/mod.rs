//! Lanes: eight floats, eight integers, eight truth values, sixteen of each, and vectors of them.
//!
//! The only room that names `wide`. What is exported here has the same bits in every lane on every
//! instruction set: `+ − × ÷ √`, comparisons and selection. There is no
//! approximate reciprocal and no transcendental function; the one fused operation ([`f32x8::fused`]) is
//! for tests that only cull.
//!
//! [`Real`] is implemented by `f32`, [`f32x8`] and [`f32x16`]: code that is generic over it *is* the scalar path
//! and the eight-wide path, and can't drift apart.

mod compress;
pub mod cpu;
mod float;
mod groups;
mod integer;
mod mask;
mod opaque;
mod prefetch;
mod real;
mod sixteen;
mod sort;
#[cfg(test)]
mod tests;
mod vector;

pub use compress::compress;
pub use float::{f32x8, transpose};
pub use groups::Groups;
pub use integer::u32x8;
pub use mask::{Mask8, Mask16};
pub use prefetch::prefetch;
pub use real::{Bits, Mask, Real};
pub use sixteen::{Eights, MOST, ONE_REGISTER, f32x16, u32x16};
pub use sort::sort_descending;
pub use vector::{Vec3x8, Vec3x16, Vector3, vector3};

/// Rays in a packet, lanes in a register.
pub const LANES: usize = 8;
