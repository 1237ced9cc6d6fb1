//! Wavefront MTL: the part of it that has a meaning here.
//!
//! MTL files are careless more often than not, and a scene without its colours is better than no
//! scene: a line that makes no sense is reported and passed over.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{LoadError, Warning, text};
use crate::scene::Rgb;

/// One `newmtl`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    /// As `usemtl` refers to it.
    pub(super) name: String,
    /// Diffuse reflectance, in [0, 1].
    pub(super) kd: Option<Rgb>,
    /// Specular reflectance, in [0, 1].
    pub(super) ks: Rgb,
    /// Exponent of the highlight.
    pub(super) ns: f32,
    /// Emitted radiance.
    pub(super) ke: Rgb,
    /// Picture of the diffuse reflectance, beside the MTL file if relative.
    pub(super) map_kd: Option<PathBuf>,
}

/// Reads a library.
pub(super) fn read(path: &Path, warnings: &mut Vec<Warning>) -> Result<Vec<MtlMaterial>, LoadError> {
    let source: Arc<str> = text::read(path)?.into();
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for line in source.lines().map(str::trim) {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if keyword == "newmtl" {
            materials.push(MtlMaterial { name: rest.trim().to_owned(), ..MtlMaterial::default() });
        }
        let Some(material) = materials.last_mut() else { continue };
        let understood = match keyword {
            "Kd" => reflectance(rest).map(|rgb| material.kd = Some(rgb)),
            "Ks" => reflectance(rest).map(|rgb| material.ks = rgb),
            "Ke" => colour(rest).map(|rgb| material.ke = rgb),
            "Ns" => number(rest).map(|ns| material.ns = ns),
            "map_Kd" => file_name(rest).map(|name| material.map_kd = Some(folder.join(name))),
            _ => Some(()),
        };
        if understood.is_none() {
            let message = format!("`{line}` was not understood and is ignored");
            warnings.push(Warning::within(path, &source, text::range_of(&source, line), message));
        }
    }
    Ok(materials)
}

fn number(text: &str) -> Option<f32> {
    text.split_whitespace().next()?.parse().ok().filter(|number: &f32| number.is_finite())
}

/// Three numbers, or one for all three; never negative.
fn colour(text: &str) -> Option<Rgb> {
    let numbers: Option<Vec<f32>> = text.split_whitespace().map(number).collect();
    match numbers?[..] {
        [grey] => Some(Rgb::splat(grey)),
        [r, g, b] => Some(Rgb::new(r, g, b)),
        _ => None,
    }
    .map(|rgb| rgb.max(Rgb::ZERO))
}

fn reflectance(text: &str) -> Option<Rgb> {
    colour(text).map(|rgb| rgb.min(Rgb::ONE))
}

/// The name after the options, which may hold blanks; with slashes as every system reads them.
fn file_name(text: &str) -> Option<String> {
    let mut rest = text.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        rest = after.trim_start();
        for place in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace)?;
            // `-o u v w`: v and w may be absent.
            if place > 0 && word.parse::<f32>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    Some(rest.replace('\\', "/")).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn load(text: &str) -> (Vec<MtlMaterial>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mtl");
        fs::write(&path, text).unwrap();
        let mut warnings = Vec::new();
        let mut materials = read(&path, &mut warnings).unwrap();
        for material in &mut materials {
            let relative = material.map_kd.as_ref().and_then(|name| name.strip_prefix(folder.path()).ok());
            material.map_kd = relative.map(Path::to_owned);
        }
        let text = |warning: Warning| warning.to_string().rsplit_once("a.mtl:").unwrap().1.to_owned();
        (materials, warnings.into_iter().map(text).collect())
    }

    #[test]
    fn what_has_a_meaning_is_read() {
        let (materials, warnings) = load(
            "# two\nnewmtl old brick\n\tKd 0.5 0.25 1.5\n Ks 0.1\nNs 20\nillum 2\nKe 0 3 -1\n\
             map_Kd -s 2 2 -clamp on tex\\old brick.png\nnewmtl plain\r\n",
        );
        assert!(warnings.is_empty(), "{warnings:?}");
        let brick = MtlMaterial {
            name: "old brick".into(),
            kd: Some(Rgb::new(0.5, 0.25, 1.0)),
            ks: Rgb::splat(0.1),
            ns: 20.0,
            ke: Rgb::new(0.0, 3.0, 0.0),
            map_kd: Some("tex/old brick.png".into()),
        };
        assert_eq!(materials, [brick, MtlMaterial { name: "plain".into(), ..MtlMaterial::default() }]);
    }

    #[test]
    fn careless_lines_are_reported_and_passed_over() {
        let (materials, warnings) =
            load("Kd 1 1 1\nnewmtl a\nKd 1 1\nKd spectral a.rfl\nKs nan nan nan\nNs\nmap_Kd\nmap_Kd -s 1\n");
        assert_eq!(materials, [MtlMaterial { name: "a".into(), ..MtlMaterial::default() }]);
        let places: Vec<&str> = warnings.iter().filter_map(|warning| warning.split(' ').next()).collect();
        assert_eq!(places, ["3:1:", "4:1:", "5:1:", "6:1:", "7:1:", "8:1:"]);
        assert!(warnings[0].ends_with("`Kd 1 1` was not understood and is ignored"));
    }
}
