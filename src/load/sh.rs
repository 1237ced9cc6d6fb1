//! Nine coefficients of spherical harmonics in a file: what `packlight envmap --sh` writes and the emitter
//! `shlight` reads.
//!
//! ```json
//! { "coefficients": [[r, g, b], nine of them: (0,0) (1,-1) (1,0) (1,1) (2,-2) (2,-1) (2,0) (2,1) (2,2)] }
//! ```
//! of radiance, in the axes and signs of [`sh_basis`](crate::math::sh_basis). Whatever else stands in the
//! object is passed over.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};

/// The file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShFile {
    /// W/(m² sr) in three bands, by l, then m.
    pub coefficients: [[f32; 3]; 9],
}

/// Reads a file.
///
/// # Errors
/// A sentence: the file is missing, is not JSON, or has not nine finite coefficients of three bands.
pub fn read(path: &Path) -> Result<ShFile, String> {
    let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
    let file: ShFile = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    match file.coefficients.as_flattened().iter().all(|c| c.is_finite()) {
        true => Ok(file),
        false => Err("a coefficient exceeds 32 bits".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_or_refused_with_a_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.json");
        let file = ShFile { coefficients: std::array::from_fn(|i| [i as f32, -0.5, 1e-3]) };
        fs::write(&path, serde_json::to_string(&file).unwrap()).unwrap();
        assert_eq!(read(&path), Ok(file));
        fs::write(&path, r#"{ "more": 1, "coefficients": [[1, 2, 3], [1, 2]] }"#).unwrap();
        assert!(read(&path).unwrap_err().contains("line 1"));
        fs::write(&path, serde_json::to_string(&file).unwrap().replace("8.0", "1e300")).unwrap();
        assert!(read(&path).is_err());
    }
}
