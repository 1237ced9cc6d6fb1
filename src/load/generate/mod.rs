//! Meshes made on the spot, the same every time: `soup:100k`, `terrain:1M`, `spheres:1M`, `hair:200k`.
//!
//! They are what ray tracers are measured on, so other programs make them too: the hash, the order of
//! random numbers and the order of operations are fixed. Unlike a picture, a generated mesh is **not** a
//! bits contract across platforms: angles go through the standard library's `sin_cos`, and the edge of
//! the soup through its `powf`, as they do elsewhere.

mod hair;
mod random;
mod soup;
mod spheres;
mod terrain;

use std::path::PathBuf;

use glam::Vec3;

use super::LoadError;
use crate::scene::Mesh;

/// What a path starts with if it names a mesh to make.
pub const PREFIX: &str = "gen:";

/// More than this is a slip of the keyboard: three vertices each fill the index type.
const MAX_TRIANGLES: usize = 100_000_000;

/// The kinds, for messages.
const KINDS: &str = "soup, terrain, spheres or hair";

/// Makes a mesh of about N triangles from `KIND:N` or `KIND:N:SEED`, where N may be `100k` or `1M`.
/// The seed is 1 if it is not given.
///
/// - `soup`: small triangles, uniform in the unit cube
/// - `terrain`: a square height field
/// - `spheres`: a sphereflake; it has no seed
/// - `hair`: strands of long thin triangles on a sphere
///
/// # Errors
/// [`LoadError`] for anything else.
pub fn mesh(spec: &str) -> Result<Mesh, LoadError> {
    let refuse = |message: String| {
        LoadError::new(&PathBuf::from(format!("{PREFIX}{spec}")), message)
            .help(format!("{PREFIX}KIND:N[:SEED] with KIND {KINDS} and N like 20000, 100k or 1M"))
    };
    let mut parts = spec.split(':');
    let kind = parts.next().unwrap_or_default();
    if !["soup", "terrain", "spheres", "hair"].contains(&kind) {
        return Err(refuse(format!("there is no mesh of the kind `{kind}`")));
    }
    let Some(size) = parts.next() else {
        return Err(refuse("how many triangles?".into()));
    };
    let triangles = match count(size) {
        Some(n) if n > MAX_TRIANGLES => {
            return Err(refuse(format!("{size} triangles are more than {MAX_TRIANGLES}")));
        }
        Some(n) if n > 0 => n,
        _ => return Err(refuse(format!("expected a number of triangles, found `{size}`"))),
    };
    let seed = parts.next();
    if let Some(rest) = parts.next() {
        return Err(refuse(format!("nothing may follow the seed, found `{rest}`")));
    }
    if kind == "spheres" && seed.is_some() {
        return Err(refuse("the spheres have no seed: nothing about them is random".into()));
    }
    let seed: u64 = match seed.map(str::parse).transpose() {
        Ok(seed) => seed.unwrap_or(1),
        Err(_) => return Err(refuse("the seed is not a whole number below 2^64".into())),
    };
    Ok(match kind {
        "soup" => soup::make(triangles, seed),
        "terrain" => terrain::make(triangles, seed),
        "spheres" => spheres::make(triangles),
        _ => hair::make(triangles, seed),
    })
}

/// `20000`, `20k` or `1M`; numbers too large to hold are the largest.
fn count(text: &str) -> Option<usize> {
    let (digits, unit) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1_000),
        None => match text.strip_suffix(['m', 'M']) {
            Some(digits) => (digits, 1_000_000),
            None => (text, 1),
        },
    };
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    Some(digits.parse().unwrap_or(usize::MAX).saturating_mul(unit))
}

/// Triangles without normals or uv.
fn bare(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { positions, triangles, ..Mesh::default() }
}

#[cfg(test)]
mod tests;
