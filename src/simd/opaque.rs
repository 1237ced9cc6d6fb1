//! Lanes of which the compiler is not to know where they came from.

use super::f32x16;

/// The same lanes. What is read from memory and then moved between lanes the compiler reads again, lane by lane, where
/// it takes that for cheaper; what has been through here it moves.
#[inline(always)]
#[allow(unsafe_code)]
pub(super) fn opaque(lanes: f32x16) -> f32x16 {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx512f"))]
    {
        use std::arch::{
            asm,
            x86_64::{_mm512_loadu_ps, _mm512_storeu_ps},
        };
        let mut out = [0.0; 16];
        // SAFETY: the feature is compiled in, arrays of sixteen floats are what is read and written, and no instruction
        // is in between.
        unsafe {
            let mut register = _mm512_loadu_ps(lanes.to_array().as_ptr());
            asm!("/* {0} */", inout(zmm_reg) register, options(pure, nomem, nostack, preserves_flags));
            _mm512_storeu_ps(out.as_mut_ptr(), register);
        }
        f32x16::new(out)
    }
    #[cfg(not(all(target_arch = "x86_64", target_feature = "avx512f")))]
    lanes
}
