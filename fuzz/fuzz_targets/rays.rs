#![no_main]

use std::{path::Path, sync::OnceLock};

use packlight::{
    compile::{Scene, compile},
    geometry::ray_file::{RayFile, encode},
    load::{LoadOptions, load},
    verify::ways::{answers, compare},
};

/// A scene with a shape of every kind, instances included.
fn scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/instances.xml");
        let loaded = load(&path, &LoadOptions::default()).expect("a scene of ours loads");
        compile(&loaded.description).expect("a scene of ours compiles")
    })
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = RayFile::decode(bytes) else { return };
    let again = RayFile::decode(&encode(&file.rays)).expect("what was written can be read");
    assert_eq!(
        (&again.rays, again.invalid),
        (&file.rays, file.rays.iter().filter(|ray| !ray.is_valid()).count() as u64)
    );
    let compared = compare(scene(), &file.rays, 1 << 18, &answers);
    assert_eq!(compared.mismatches, 0, "{:?}", compared.exhibit);
});
