//! The words of the format: element names and plugin types, supported or only known.

use std::fmt;

/// What kind of thing an object element declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    Scene,
    Integrator,
    Sensor,
    Sampler,
    Film,
    RFilter,
    Bsdf,
    Texture,
    Emitter,
    Shape,
}

impl Class {
    const ALL: [(&'static str, Self); 10] = [
        ("scene", Self::Scene),
        ("integrator", Self::Integrator),
        ("sensor", Self::Sensor),
        ("sampler", Self::Sampler),
        ("film", Self::Film),
        ("rfilter", Self::RFilter),
        ("bsdf", Self::Bsdf),
        ("texture", Self::Texture),
        ("emitter", Self::Emitter),
        ("shape", Self::Shape),
    ];

    /// The class that an element of this name declares.
    pub(super) fn of_element(element: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| *name == element).map(|&(_, class)| class)
    }

    /// The plugin types that packlight builds.
    pub(super) fn supported(self) -> &'static [&'static str] {
        match self {
            Self::Scene => &[],
            Self::Integrator => &["path", "direct", "aov", "moment", "whitted", "ao", "irradiance"],
            Self::Sensor => &["perspective", "thinlens", "orthographic", "irradiancemeter"],
            Self::Sampler => &["independent", "stratified", "multijitter", "orthogonal", "ldsampler"],
            Self::Film => &["hdrfilm"],
            Self::RFilter => &["box", "gaussian", "tent", "mitchell", "catmullrom", "lanczos"],
            Self::Bsdf => &[
                "diffuse",
                "conductor",
                "roughconductor",
                "dielectric",
                "roughdielectric",
                "plastic",
                "roughplastic",
                "principled",
                "twosided",
                "mask",
                "blendbsdf",
                "bumpmap",
                "normalmap",
                "phong",
                "ward",
                "toon",
                "merl",
            ],
            Self::Texture => &["bitmap", "checkerboard", "mesh_attribute"],
            Self::Emitter => &["area", "point", "spot", "directional", "constant", "envmap", "shlight"],
            Self::Shape => &[
                "sphere",
                "rectangle",
                "cube",
                "disk",
                "cylinder",
                "obj",
                "ply",
                "serialized",
                "shapegroup",
                "instance",
            ],
        }
    }

    /// The plugin types that Mitsuba has and packlight does not.
    pub(super) fn foreign(self) -> &'static [&'static str] {
        match self {
            Self::Scene => &[],
            Self::Integrator => &[
                "volpath",
                "volpathmis",
                "depth",
                "stokes",
                "ptracer",
                "prb",
                "prb_basic",
                "prbvolpath",
                "prb_projective",
                "direct_projective",
            ],
            Self::Sensor => &["distant", "radiancemeter", "batch"],
            Self::Sampler => &[],
            Self::Film => &["specfilm"],
            Self::RFilter => &[],
            Self::Bsdf => &[
                "thindielectric",
                "hair",
                "measured",
                "principledthin",
                "null",
                "polarizer",
                "retarder",
                "circular",
                "measured_polarized",
                "pplastic",
            ],
            Self::Texture => &["volume"],
            Self::Emitter => &["sunsky", "projector", "directionalarea", "volumelight", "sky", "sun"],
            Self::Shape => &[
                "blender",
                "bsplinecurve",
                "linearcurve",
                "sdfgrid",
                "merge",
                "ellipsoids",
                "ellipsoidsmesh",
            ],
        }
    }

    /// Every element that may stand in an object, for suggestions.
    pub(super) fn elements() -> impl Iterator<Item = &'static str> {
        let objects = Self::ALL.iter().map(|&(name, _)| name);
        objects.chain(PROPERTIES.iter().copied()).chain(["default", "ref", "include", "path", "alias"])
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(_, class)| class == self).map_or("", |&(name, _)| name);
        f.write_str(name)
    }
}

/// Elements that give a value a name.
pub(super) const PROPERTIES: [&str; 9] =
    ["integer", "float", "boolean", "string", "point", "vector", "rgb", "spectrum", "transform"];

/// Elements that Mitsuba has and packlight does not.
pub(super) const FOREIGN_ELEMENTS: [&str; 5] = ["medium", "phase", "volume", "animation", "tensor"];

/// Bytes of what may be a slip of somebody's fingers.
const MAX_WORD: usize = 256;

/// The known word most like a misspelt one, if any is alike.
pub(in crate::load) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Older Mitsuba versions wrote `toWorld` for `to_world`.
    let folded = |s: &str| s.to_ascii_lowercase().replace(['_', '-'], "");
    let word = folded(word);
    // Likeness takes time and memory by the product of both lengths.
    let is_word = |s: &str| s.len() <= MAX_WORD;
    known
        .into_iter()
        .filter(|candidate| is_word(&word) && is_word(candidate))
        .map(|candidate| (strsim::normalized_damerau_levenshtein(&word, &folded(candidate)), candidate))
        .filter(|(likeness, _)| *likeness > 0.55)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `a`, `b` and `c`, each in backquotes.
pub(super) fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("`{word}`")).collect();
    match quoted.split_last() {
        None => "nothing".into(),
        Some((only, [])) => only.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

/// A sentence of help: the nearest of the known words, or all of them.
pub(super) fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>, these: &str) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match nearest(word, known.iter().copied()) {
        Some(candidate) => format!("did you mean `{candidate}`?"),
        None if known.is_empty() => "none are expected here".into(),
        None => format!("{these} are {}", listed(known)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_spellings_and_slips_find_their_word() {
        let known = ["to_world", "reflectance", "radius"];
        for (word, expected) in [
            ("toWorld", Some("to_world")),
            ("reflectence", Some("reflectance")),
            ("raduis", Some("radius")),
            ("quark", None),
        ] {
            assert_eq!(nearest(word, known), expected, "{word}");
        }
    }

    #[test]
    fn lists_read_as_sentences() {
        assert_eq!(listed([]), "nothing");
        assert_eq!(listed(["a"]), "`a`");
        assert_eq!(listed(["a", "b", "c"]), "`a`, `b` and `c`");
    }

    #[test]
    fn no_type_is_both_supported_and_foreign() {
        for (_, class) in Class::ALL {
            for plugin in class.supported() {
                assert!(!class.foreign().contains(plugin), "{class} {plugin}");
            }
        }
    }
}
