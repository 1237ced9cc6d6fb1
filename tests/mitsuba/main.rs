//! Scenes and pictures of an independent renderer, where `../shared` holds them.
//!
//! ```sh
//! cargo test --release --test mitsuba -- --nocapture             # what is quick, with its tables
//! PYTHON=python3 cargo test --release --test mitsuba -- --ignored --nocapture   # every reference
//! ```
//! Comparing needs a Python that has `numpy` and `OpenEXR`; without one it is skipped, aloud.

#![allow(missing_docs)]

mod references;
mod scenes;
mod z_test;

use std::path::{Path, PathBuf};

/// A folder or file in `../shared`, if it is there.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name);
    if !path.exists() {
        eprintln!("skipped: there is no {}", path.display());
        return None;
    }
    Some(path)
}
