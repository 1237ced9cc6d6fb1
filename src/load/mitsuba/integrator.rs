//! Which integral is estimated.

use super::{
    files::Files,
    properties::Object,
    vocabulary::{Class, did_you_mean, nearest},
};
use crate::{
    load::LoadError,
    scene::{Aov, AovChannel, Integrator},
};

const AOVS: [(&str, Aov); 10] = [
    ("depth", Aov::Depth),
    ("position", Aov::Position),
    ("uv", Aov::Uv),
    ("geo_normal", Aov::GeoNormal),
    ("sh_normal", Aov::ShNormal),
    ("directional_albedo", Aov::DirectionalAlbedo),
    ("material_id", Aov::MaterialId),
    ("primitive_id", Aov::PrimitiveId),
    ("nodes", Aov::Nodes),
    ("primitives", Aov::Primitives),
];

/// Most vertices of a path that nothing may end.
const MAX_CERTAIN: u32 = 1000;

pub(super) fn build(object: Object, files: &mut Files) -> Result<Integrator, LoadError> {
    if object.plugin() == "moment" {
        return moment(object, files);
    }
    let integrator = match object.plugin() {
        "path" => {
            let (max_depth, rr_depth) = depths(object)?;
            Integrator::Path { max_depth, rr_depth, hide_emitters: object.boolean("hide_emitters", false)? }
        }
        "direct" => {
            direct_samples(object, files)?;
            Integrator::Direct { hide_emitters: object.boolean("hide_emitters", false)? }
        }
        "whitted" => Integrator::Whitted { max_depth: object.count("max_depth", 10, 0, 1000)? },
        "ao" => Integrator::AmbientOcclusion { distance: object.positive("distance", f64::INFINITY)? as f32 },
        "irradiance" => {
            let (max_depth, rr_depth) = depths(object)?;
            Integrator::Irradiance { max_depth, rr_depth }
        }
        "aov" => Integrator::Aov { channels: aovs(object)? },
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(integrator)
}

/// Mitsuba's `moment` adds squares to what the integrator inside it estimates.
fn moment(object: Object, files: &mut Files) -> Result<Integrator, LoadError> {
    let Some(inside) = object.child(Class::Integrator)? else {
        return Err(object
            .error("the integrator `moment` has no integrator inside")
            .help("write <integrator type=\"moment\"><integrator type=\"path\"/></integrator>"));
    };
    if inside.plugin() == "moment" {
        return Err(inside.error("a `moment` can't stand inside a `moment`"));
    }
    object.finish()?;
    files.warnings.push(object.warning(format!(
        "`moment` is read as the `{}` inside it: second moments are not written",
        inside.plugin()
    )));
    build(inside, files)
}

/// `max_depth`, and the depth from which roulette may end a path: one of them must, or paths between white walls
/// never end.
fn depths(object: Object) -> Result<(Option<u32>, u32), LoadError> {
    let (max_depth, rr_depth) = (max_depth(object)?, object.count("rr_depth", 5, 1, i32::MAX as u32)?);
    let certain = rr_depth.min(max_depth.unwrap_or(u32::MAX));
    if certain > MAX_CERTAIN {
        return Err(object
            .error_at("rr_depth", format!("nothing ends a path before it has {certain} vertices"))
            .help(format!("set `rr_depth` or `max_depth` to {MAX_CERTAIN} or less")));
    }
    Ok((max_depth, rr_depth))
}

fn max_depth(object: Object) -> Result<Option<u32>, LoadError> {
    match object.integer("max_depth")? {
        None | Some(-1) => Ok(None),
        Some(depth) => u32::try_from(depth).map(Some).map_err(|_| {
            object
                .error_at("max_depth", "`max_depth` must be -1 (no limit) or a number of vertices from 0 up")
        }),
    }
}

fn direct_samples(object: Object, files: &mut Files) -> Result<(), LoadError> {
    object.exclude("shading_samples", "emitter_samples")?;
    object.exclude("shading_samples", "bsdf_samples")?;
    for name in ["shading_samples", "emitter_samples", "bsdf_samples"] {
        if object.count(name, 1, 1, u32::MAX)? != 1 {
            files.warnings.push(object.span(name).warning(format!(
                "`{name}` is taken as 1: raise the sampler's `sample_count` for less noise"
            )));
        }
    }
    Ok(())
}

fn aovs(object: Object) -> Result<Vec<AovChannel>, LoadError> {
    let text = object
        .string("aovs")?
        .ok_or_else(|| object.missing("aovs", "<string name=\"aovs\" value=\"nn:sh_normal,dd:depth\"/>"))?;
    let mut channels: Vec<AovChannel> = Vec::new();
    for item in text.split(',').map(str::trim) {
        let Some((name, kind)) = item.split_once(':').map(|(name, kind)| (name.trim(), kind.trim())) else {
            return Err(object
                .error_at("aovs", format!("`{item}` is not `name:type`"))
                .help("write `nn:sh_normal,dd:depth`"));
        };
        if name.is_empty() || channels.iter().any(|channel| channel.name == name) {
            return Err(object.error_at("aovs", format!("`{item}` needs a name that no other has")));
        }
        let Some(&(_, aov)) = AOVS.iter().find(|(known, _)| *known == kind) else {
            let known = AOVS.map(|(known, _)| known);
            let error = object.error_at("aovs", format!("the variable `{kind}` is not supported"));
            return Err(error.help(match nearest(kind, known) {
                Some(candidate) => format!("did you mean `{candidate}`?"),
                None => did_you_mean("", known, "supported variables"),
            }));
        };
        channels.push(AovChannel { name: name.to_owned(), kind: aov });
    }
    Ok(channels)
}
