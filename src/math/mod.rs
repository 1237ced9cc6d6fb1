//! Mathematics of lanes: functions, frames, warps and random numbers; and digests of data.
//!
//! Each function is generic over [`Real`](crate::simd::Real), so one lane and eight lanes are the same
//! operations in the same order. Transcendental functions are polynomials of `+ − × ÷ √` only: neither
//! the platform's libm nor a fused multiply-add can change a bit.

mod digest;
mod elementary;
mod erf;
mod frame;
mod sampler;
mod sh;
pub mod warp;

pub use digest::Digest;
pub use elementary::{acos, atan2, exp, exp2, ln, log2, pow, sin_cos_turns};
pub use erf::{erf, erf_inv};
pub use frame::Frame;
pub use sampler::{PathKey, Sampler};
pub use sh::{sh_basis, sh_cosine};

/// 1/π.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// 1/2π.
pub const INV_TWO_PI: f32 = 0.159_154_94;
