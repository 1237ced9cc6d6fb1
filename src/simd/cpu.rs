//! What the compiler was told about the processor, and what the processor says about itself.
//!
//! `wide` picks its lanes at compile time, and a program compiled for AVX2 dies of an illegal
//! instruction on a processor without it. So `main` asks here first. `is_x86_feature_detected!` is no
//! help: in a program compiled for AVX2 it folds to `true`.
//!
//! Everything on the way to [`missing`] is itself compiled for the processor that may be the wrong
//! one. So there is nothing here that the compiler could fill, copy or fold with vector instructions,
//! nor a shift by a variable or an and-not, which BMI has instructions for: a feature costs a few
//! calls, a `cpuid` and a test against a mask, and nothing is remembered. `tests/cpu_guard.rs` runs it
//! on emulated processors.

use std::fmt::Write as _;

/// Where the processor reports a feature.
#[derive(Clone, Copy)]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
enum Place {
    Leaf1Ecx,
    Leaf7Ebx,
    Leaf7Ecx,
    Leaf7Sub1Eax,
    ExtendedEcx,
}

/// Registers that the operating system must save and restore.
#[derive(Clone, Copy)]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
enum Registers {
    General,
    Ymm,
    Zmm,
}

/// An extension of the instruction set that the compiler uses unasked where it is told it may.
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
struct Feature {
    name: &'static str,
    compiled: bool,
    registers: Registers,
    place: Place,
    mask: u32,
}

macro_rules! features {
    ($($name:literal $registers:ident $place:ident $bit:literal)*) => {
        [$(Feature {
            name: $name,
            compiled: cfg!(target_feature = $name),
            registers: Registers::$registers,
            place: Place::$place,
            mask: 1 << $bit,
        }),*]
    };
}

/// Intel 64 and IA-32 manual, volume 2A, CPUID; AMD64 manual, volume 3, appendix E.
static FEATURES: [Feature; 28] = features! {
    "sse3"            General Leaf1Ecx 0
    "ssse3"           General Leaf1Ecx 9
    "sse4.1"          General Leaf1Ecx 19
    "sse4.2"          General Leaf1Ecx 20
    "sse4a"           General ExtendedEcx 6
    "popcnt"          General Leaf1Ecx 23
    "movbe"           General Leaf1Ecx 22
    "lzcnt"           General ExtendedEcx 5
    "bmi1"            General Leaf7Ebx 3
    "bmi2"            General Leaf7Ebx 8
    "adx"             General Leaf7Ebx 19
    "gfni"            General Leaf7Ecx 8
    "avx"             Ymm     Leaf1Ecx 28
    "f16c"            Ymm     Leaf1Ecx 29
    "fma"             Ymm     Leaf1Ecx 12
    "avx2"            Ymm     Leaf7Ebx 5
    "avxvnni"         Ymm     Leaf7Sub1Eax 4
    "avx512f"         Zmm     Leaf7Ebx 16
    "avx512bw"        Zmm     Leaf7Ebx 30
    "avx512cd"        Zmm     Leaf7Ebx 28
    "avx512dq"        Zmm     Leaf7Ebx 17
    "avx512vl"        Zmm     Leaf7Ebx 31
    "avx512ifma"      Zmm     Leaf7Ebx 21
    "avx512vbmi"      Zmm     Leaf7Ecx 1
    "avx512vbmi2"     Zmm     Leaf7Ecx 6
    "avx512vnni"      Zmm     Leaf7Ecx 11
    "avx512bitalg"    Zmm     Leaf7Ecx 12
    "avx512vpopcntdq" Zmm     Leaf7Ecx 14
};

/// What this program was compiled to use and this processor, or its operating system, does not have,
/// as `rustc` names it: `avx2`, `fma`. Nothing where the processor is not x86-64.
pub fn missing() -> impl Iterator<Item = &'static str> {
    FEATURES.iter().filter(|feature| feature.compiled && !present(feature)).map(|feature| feature.name)
}

/// What this processor and its operating system offer beyond the instructions that every x86-64 has, as far
/// as it makes lanes faster: whether it was compiled or not.
pub fn offered() -> Vec<&'static str> {
    let worth_saying = ["sse4.2", "avx2", "fma", "avx512f"];
    let there = FEATURES.iter().filter(|feature| worth_saying.contains(&feature.name) && present(feature));
    there.map(|feature| feature.name).collect()
}

/// The lanes that were compiled, in a line: `f32x8 in one AVX register (avx2, fma, avx512f)`.
pub fn compiled() -> String {
    let registers = if cfg!(target_feature = "avx") {
        "one AVX register"
    } else if cfg!(target_feature = "sse2") {
        "two SSE2 registers"
    } else if cfg!(target_feature = "neon") {
        "two NEON registers"
    } else {
        "scalar registers"
    };
    let mut text = format!("f32x8 in {registers}");
    let worth_saying = ["sse4.2", "avx2", "fma", "avx512f"];
    let mut separator = " (";
    for feature in FEATURES.iter().filter(|f| f.compiled && worth_saying.contains(&f.name)) {
        // `fmt::Write` for a String never fails.
        let _ = write!(text, "{separator}{}", feature.name);
        separator = ", ";
    }
    if separator == ", " {
        text.push(')');
    }
    text
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn present(feature: &Feature) -> bool {
    let saved = match feature.registers {
        Registers::General => true,
        Registers::Ymm => ymm_is_saved(),
        Registers::Zmm => zmm_is_saved(),
    };
    saved && register(feature.place) & feature.mask != 0
}

#[cfg(not(target_arch = "x86_64"))]
fn present(_: &Feature) -> bool {
    true
}

/// A register of the processor's description; 0 where the processor is too old to have that leaf.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[allow(unsafe_code, unused_unsafe)] // `__cpuid` became a safe function after our oldest compiler.
fn register(place: Place) -> u32 {
    use core::arch::x86_64::{__cpuid, __cpuid_count};
    // SAFETY: every x86-64 processor has the cpuid instruction.
    unsafe {
        match place {
            Place::Leaf1Ecx => __cpuid(1).ecx,
            Place::Leaf7Ebx if __cpuid(0).eax >= 7 => __cpuid_count(7, 0).ebx,
            Place::Leaf7Ecx if __cpuid(0).eax >= 7 => __cpuid_count(7, 0).ecx,
            Place::Leaf7Sub1Eax if __cpuid(0).eax >= 7 && __cpuid_count(7, 0).eax >= 1 => {
                __cpuid_count(7, 1).eax
            }
            Place::ExtendedEcx if __cpuid(0x8000_0000).eax > 0x8000_0000 => __cpuid(0x8000_0001).ecx,
            _ => 0,
        }
    }
}

/// XMM and the upper halves of YMM.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn ymm_is_saved() -> bool {
    const STATE: u32 = 0b0000_0110;
    xcr0() & STATE == STATE
}

/// Those, the mask registers, and all of ZMM.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn zmm_is_saved() -> bool {
    const STATE: u32 = 0b1110_0110;
    xcr0() & STATE == STATE
}

/// The low half of XCR0, where the system says what it saves; 0 where it does not say.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[allow(unsafe_code)]
fn xcr0() -> u32 {
    const OSXSAVE: u32 = 1 << 27;
    if register(Place::Leaf1Ecx) & OSXSAVE == 0 {
        return 0;
    }
    // SAFETY: OSXSAVE says that the processor has xgetbv and that the system has enabled it.
    unsafe { core::arch::x86_64::_xgetbv(0) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_missing_where_the_tests_run() {
        assert_eq!(missing().collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn the_lanes_are_in_the_text() {
        let text = compiled();
        assert!(text.starts_with("f32x8 in "), "{text}");
        assert_eq!(text.contains("avx2"), cfg!(target_feature = "avx2"), "{text}");
        assert_eq!(text.contains('('), text.ends_with(')'), "{text}");
    }

    /// Where a feature was not compiled in, the standard library asks the processor too.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn the_table_agrees_with_the_standard_library() {
        macro_rules! detected {
            ($($name:tt)*) => { [$(($name, is_x86_feature_detected!($name))),*] };
        }
        let detected = detected! {
            "sse3" "ssse3" "sse4.1" "sse4.2" "sse4a" "popcnt" "movbe" "lzcnt" "bmi1" "bmi2" "adx" "gfni"
            "avx" "f16c" "fma" "avx2" "avxvnni" "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl"
            "avx512ifma" "avx512vbmi" "avx512vbmi2" "avx512vnni" "avx512bitalg" "avx512vpopcntdq"
        };
        for (feature, (name, expected)) in FEATURES.iter().zip(detected) {
            assert_eq!(feature.name, name);
            assert_eq!(present(feature), expected, "{name}");
        }
    }
}
