//! What a render leaves: the picture, and beside it the one without noise.

use super::{
    Arguments,
    denoised::{self, Denoised},
    keep::Name,
    rescue,
};
use crate::{
    cli::{failure::Failure, metadata::About, output::Output, part_file},
    compile::Scene,
    denoise::Denoiser,
    picture::{Format, Style, save_with},
    render::{Frame, Rendered, Shard, Statistics},
    scene::AovChannel,
};

/// A render that has ended, whether it is done or was stopped.
pub(super) struct Ended<'a> {
    pub(super) arguments: &'a Arguments,
    pub(super) output: &'a Output,
    pub(super) scene: &'a Scene,
    pub(super) frame: &'a Frame,
    pub(super) name: &'a Name<'a>,
    pub(super) denoiser: Option<&'a Denoiser>,
}

impl Ended<'_> {
    /// Writes it as it was rendered; and then, if that is asked for, without noise.
    pub(super) fn save(&self) -> Result<(Statistics, Option<Denoised>), Failure> {
        let Self { arguments, output, scene, frame, name, denoiser } = self;
        let coverage = frame.coverage();
        let is_part =
            output.format == Format::Exr && (frame.plan().shard != Shard::WHOLE || !coverage.complete);
        let rendered = frame.develop();
        let settings = arguments.settings();
        let denoiser = denoiser.map(|denoiser| (denoiser, rendered.clone().with_alpha(scene, &settings)));
        let besides = match denoiser {
            Some(_) => denoised::besides(&arguments.layers()),
            None => Vec::new(),
        };
        // A part keeps colours, and all layers, to go on from; only a picture has the film's format.
        let rendered = match &denoiser {
            _ if is_part => rendered,
            Some((_, noisy)) => self.shown(noisy.clone(), &besides),
            None => self.shown(rendered.with_alpha(scene, &settings), &besides),
        };
        let statistics = rendered.statistics;
        let (samples, facts) = (frame.samples(), name.facts);
        let about = About { scene: name.scene, facts, samples, statistics: &statistics, coverage };
        let style = arguments.style.style(&about);
        self.write(&rendered, &style, is_part)?;
        let Some((denoiser, noisy)) = denoiser else { return Ok((statistics, None)) };
        let (denoised, picture) = Denoised::of(denoiser, &noisy.picture, &output.path)?;
        let clean = self.shown(Rendered { picture, ..noisy }, &besides);
        denoised.save(&clean.picture, &output.path, style)?;
        Ok((statistics, Some(denoised)))
    }

    /// In the film's colours, without layers that nobody asked for.
    fn shown(&self, rendered: Rendered, besides: &[AovChannel]) -> Rendered {
        let Rendered { picture, statistics } = rendered.recoloured(self.scene.film.format);
        Rendered { picture: denoised::without(picture, besides), statistics }
    }

    /// The picture; and its sums, if it is a shard or not finished.
    fn write(&self, rendered: &Rendered, style: &Style, is_part: bool) -> Result<(), Failure> {
        let Self { arguments, output, frame, name, .. } = self;
        let saved = if is_part {
            part_file::save(&name.part(frame), &output.path, style)
        } else {
            save_with(&rendered.picture, &output.path, style).map_err(|error| error.to_string())
        };
        let checkpoint = arguments.keep.checkpoint.as_deref();
        saved.map_err(|error| rescue::rescue(frame, name, &output.path, checkpoint, &error))
    }
}
