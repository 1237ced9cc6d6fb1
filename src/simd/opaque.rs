//! Lanes of which the compiler is not to know where they came from.

/// The same lanes. What is read from memory and then moved between lanes the compiler reads again, lane by lane, where
/// it takes that for cheaper; what has been through here it moves.
#[inline(always)]
pub(super) fn opaque<R: Opaque>(lanes: R) -> R {
    lanes.opaque()
}

/// Lanes that one register holds on some processors.
pub(super) trait Opaque {
    fn opaque(self) -> Self;
}

macro_rules! opaque {
    ($lanes:ident, $feature:literal, $class:ident, $load:ident, $store:ident) => {
        impl Opaque for super::$lanes {
            #[inline(always)]
            #[allow(unsafe_code)]
            fn opaque(self) -> Self {
                #[cfg(all(target_arch = "x86_64", target_feature = $feature))]
                {
                    use std::arch::x86_64::{$load, $store};
                    let mut out = self.to_array();
                    // SAFETY: the feature is compiled in, arrays of as many floats as a register holds are what is read
                    // and written, and no instruction is in between.
                    unsafe {
                        let mut register = $load(out.as_ptr());
                        std::arch::asm!(
                            "/* {0} */", inout($class) register, options(pure, nomem, nostack, preserves_flags)
                        );
                        $store(out.as_mut_ptr(), register);
                    }
                    Self::new(out)
                }
                #[cfg(not(all(target_arch = "x86_64", target_feature = $feature)))]
                self
            }
        }
    };
}
opaque!(f32x8, "avx", ymm_reg, _mm256_loadu_ps, _mm256_storeu_ps);
opaque!(f32x16, "avx512f", zmm_reg, _mm512_loadu_ps, _mm512_storeu_ps);
