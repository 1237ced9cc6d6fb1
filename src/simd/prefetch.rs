//! A hint to the memory system: what will be read soon.

/// Asks for the `LINES` cache lines from an address on. It reads nothing: any address will do, a wrong one
/// only costs time. Does nothing where the target has no such hint.
#[inline]
#[allow(unsafe_code)]
pub fn prefetch<const LINES: usize>(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..LINES {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch never faults and has no effect on the program's state, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.wrapping_add(line * 64).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
