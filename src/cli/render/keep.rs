//! `--checkpoint` and `--resume`: what is rendered is not lost.

use std::{path::PathBuf, time::Duration};

use clap::Args;

use super::meanwhile::meanwhile;
use crate::{
    cli::{
        console, duration,
        failure::{Failure, warn_of},
        metadata::samples,
        output::check_writable,
        part_file,
    },
    compile::Scene,
    picture::{ExrCompression, ExrStyle, Style},
    render::{Frame, Plan, part::Part},
};

const KEEP: &str = "Checkpoints (to go on from one ends in the same bits)";

/// The options.
#[derive(Clone, Debug, Args)]
pub(super) struct KeepOptions {
    /// File that holds, now and then and at the end, what is there; an .exr that can be looked at
    #[arg(long, value_name = "FILE", help_heading = KEEP, value_parser = exr)]
    pub(super) checkpoint: Option<PathBuf>,

    /// Time from one checkpoint to the next
    #[arg(long, value_name = "TIME", help_heading = KEEP, default_value = "60s", value_parser = duration::parse,
          requires = "checkpoint")]
    every: Duration,

    /// Go on from a checkpoint, a shard or a picture that was stopped; if it is the --checkpoint and not
    /// there yet, from the beginning
    #[arg(long, value_name = "FILE", help_heading = KEEP)]
    resume: Option<PathBuf>,
}

/// What a part of this render is called, and by what it is told from others.
pub(super) struct Name<'a> {
    pub(super) scene: &'a str,
    pub(super) facts: &'a [(String, String)],
}

impl Name<'_> {
    /// What there is now.
    pub(super) fn part(&self, frame: &Frame) -> Part {
        frame.part(self.scene, self.facts)
    }
}

impl KeepOptions {
    /// Will sums be read or written?
    pub(super) fn keeps_sums(&self) -> bool {
        self.checkpoint.is_some() || self.resume.is_some()
    }

    /// Before anything is rendered: can the checkpoint be written?
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.checkpoint.as_deref().map_or(Ok(()), check_writable)
    }

    /// A frame with what is there already; unless `quiet`, says how much that is.
    pub(super) fn begin(
        &self,
        scene: &Scene,
        plan: Plan,
        name: &Name<'_>,
        quiet: bool,
    ) -> Result<Frame, Failure> {
        let Some(path) = &self.resume else { return Ok(Frame::new(scene, plan)) };
        if self.checkpoint.as_ref() == Some(path) && !path.exists() {
            return Ok(Frame::new(scene, plan));
        }
        let part = part_file::load(path)?;
        let path = path.display();
        let frame = Frame::resume(scene, plan, name.facts, part)
            .map_err(|difference| Failure::Sentence(format!("{path} is of another render: {difference}")))?;
        if !quiet {
            let asked = plan.shard.samples(frame.samples()).len() as u32;
            let there = samples(frame.coverage(), asked);
            let then =
                if frame.coverage().complete { "nothing is left to render" } else { "going on from there" };
            console::print(&format!("{path} has {there} samples a pixel; {then}\n"))?;
        }
        Ok(frame)
    }

    /// Does `work`, and writes checkpoints meanwhile and afterwards.
    pub(super) fn keeping(&self, frame: &Frame, name: &Name<'_>, work: impl FnOnce()) {
        let Some(path) = &self.checkpoint else { return work() };
        let write = || part_file::save(&name.part(frame), path, &quick());
        let mut warned = false;
        let keep = || {
            match write() {
                Ok(()) => warned = false,
                // Rendering goes on: the disk may have room again next time.
                Err(error) if !warned => {
                    warned = true;
                    warn_of(format!("the checkpoint could not be written: {error}"));
                }
                Err(_) => {}
            }
            self.every
        };
        meanwhile(self.every, keep, work);
        if let Err(error) = write() {
            warn_of(format!("the last checkpoint could not be written: {error}"));
        }
    }
}

/// For clap: a usage error for any other extension, which might be the scene's.
fn exr(argument: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(argument);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("exr") => Ok(path),
        _ => Err("a checkpoint is an .exr, as in --checkpoint kept.exr".into()),
    }
}

/// Written often, read seldom.
pub(super) fn quick() -> Style {
    Style { exr: ExrStyle { compression: ExrCompression::None, ..ExrStyle::default() }, ..Style::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_overwrites_no_scene() {
        for right in ["kept.exr", "a/b.EXR"] {
            assert_eq!(exr(right), Ok(right.into()));
        }
        for wrong in ["scene.xml", "bunny.ply", "exr", ".exr", "a.exr.xml", ""] {
            assert!(exr(wrong).is_err(), "{wrong}");
        }
    }
}
