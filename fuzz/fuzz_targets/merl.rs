#![no_main]

use packlight::{load::read_material, scene::MerlTable};

/// Of a file of the database: three sides, then red, green and blue of every cell.
const HEADER: usize = 12;
const BYTES: usize = HEADER + 90 * 90 * 180 * 3 * 8;

fn table(bytes: &[u8]) {
    if let Ok(table) = MerlTable::decode(bytes) {
        assert!(MerlTable::decode(&table.encode()).is_ok(), "what was written can be read");
    }
}

// The first byte chooses: bytes as they are, repeated until they fill a table, or as measurements in text.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else { return };
    match first {
        0 if rest.len() > HEADER => {
            let (header, body) = rest.split_at(HEADER);
            let mut bytes = [header, &body.repeat((BYTES - HEADER).div_ceil(body.len()))].concat();
            bytes.truncate(BYTES);
            table(&bytes);
        }
        1..64 => table(rest),
        _ => packlight_fuzz::with_file("fuzzed.brdf", rest, |path| {
            let line = format!("merl:filename={}", path.display());
            if let Err(error) = read_material(&line) {
                assert!(error.to_string().contains("fuzzed.brdf"), "refused without its name: {error}");
            }
        }),
    }
});
