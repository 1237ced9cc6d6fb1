#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    packlight_fuzz::with_file("fuzzed.xml", bytes, packlight_fuzz::show);
});
