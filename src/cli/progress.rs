//! A bar on a terminal; silence in a pipe.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::render::Progress;

const TEMPLATE: &str = "rendering [{bar:40}] {percent:>3} %  {elapsed} elapsed, {eta} left";

/// Progress of a render on stderr.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        Self(ProgressBar::with_draw_target(None, target).with_style(style()))
    }

    /// May be called from many threads, in any order.
    pub(super) fn show(&self, progress: Progress) {
        self.0.set_length(progress.total);
        // A thread that was held up must not turn the bar back.
        if progress.done > self.0.position() {
            self.0.set_position(progress.done);
        }
    }

    /// Takes the bar off the screen.
    pub(super) fn finish(self) {
        self.0.finish_and_clear();
    }
}

fn style() -> ProgressStyle {
    ProgressStyle::with_template(TEMPLATE)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_understood() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }

    #[test]
    fn a_late_report_does_not_turn_the_bar_back() {
        let bar = Bar::new(true);
        bar.show(Progress { done: 8, total: 10 });
        bar.show(Progress { done: 3, total: 10 });
        assert_eq!((bar.0.position(), bar.0.length()), (8, Some(10)));
    }
}
