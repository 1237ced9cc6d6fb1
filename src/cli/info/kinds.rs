//! What there is of each kind.

use std::{collections::BTreeMap, fmt::Debug};

/// Kinds by the names of their variants, and how many there are of each.
pub(super) fn kinds<'a, T: Debug + 'a>(things: impl IntoIterator<Item = &'a T>) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for thing in things {
        let text = format!("{thing:?}");
        let end = text.find(|c: char| !c.is_alphanumeric()).unwrap_or(text.len());
        *counts.entry(text[..end].to_lowercase()).or_default() += 1;
    }
    counts
}

/// `7: diffuse 5, dielectric, conductor`.
pub(super) fn listed(counts: &BTreeMap<String, u64>) -> String {
    let named = counts.iter().map(|(kind, &count)| match count {
        1 => kind.clone(),
        _ => format!("{kind} {count}"),
    });
    named.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Rgb};

    #[test]
    fn variants_are_counted() {
        let lights = [1.0, 2.0].map(|radiance| Emitter::Constant { radiance: Rgb::splat(radiance) });
        assert_eq!(listed(&kinds(&lights)), "constant 2");
        assert_eq!(listed(&kinds([&Some(1), &None])), "none, some");
    }
}
