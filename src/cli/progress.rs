//! A bar on a terminal; silence in a pipe.

mod screen;

use std::{
    fmt,
    time::{Duration, Instant},
};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::render::Progress;
use screen::Screen;

/// A bar that is wider than the terminal is taken off the screen in part.
const TEMPLATE: &str = "rendering [{bar:16}] {percent:>3} %  {elapsed} elapsed, {left} left";

/// Times a second that it is drawn.
const HERTZ: u8 = 20;

/// Progress of a render on stderr.
pub(super) struct Bar(ProgressBar);

impl Bar {
    /// Whatever is left to do, it ends at the deadline.
    pub(super) fn new(quiet: bool, deadline: Option<Instant>) -> Self {
        let screen = Screen::new();
        let target = match quiet || !screen.is_there() {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::term_like_with_hz(Box::new(screen), HERTZ),
        };
        let left = move |state: &ProgressState, text: &mut dyn fmt::Write| {
            let left = sooner(state.eta(), deadline, Instant::now());
            // A bar that can't be written is not shown.
            let _ = write!(text, "{:#}", HumanDuration(left));
        };
        Self(ProgressBar::with_draw_target(None, target).with_style(style().with_key("left", left)))
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

/// What is estimated, or the time to the deadline if that is less.
fn sooner(estimated: Duration, deadline: Option<Instant>, now: Instant) -> Duration {
    deadline.map_or(estimated, |deadline| estimated.min(deadline.saturating_duration_since(now)))
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
    fn a_bar_fits_a_narrow_terminal() {
        let longest = [("{bar:16}", 16), ("{percent:>3}", 3), ("{elapsed}", 3), ("{left}", 3)];
        let line = longest.iter().fold(TEMPLATE.to_owned(), |line, (key, columns)| {
            assert!(line.contains(key), "{key}");
            line.replace(key, &"=".repeat(*columns))
        });
        assert!(line.chars().count() < 60, "{line}");
    }

    #[test]
    fn what_is_left_ends_at_the_deadline() {
        let (now, minute) = (Instant::now(), Duration::from_secs(60));
        assert_eq!(sooner(minute, None, now), minute);
        assert_eq!(sooner(minute, Some(now + minute / 2), now), minute / 2);
        assert_eq!(sooner(minute, Some(now + 2 * minute), now), minute);
        assert_eq!(sooner(minute, Some(now), now + minute), Duration::ZERO);
    }

    #[test]
    fn a_late_report_does_not_turn_the_bar_back() {
        let bar = Bar::new(true, None);
        bar.show(Progress { done: 8, total: 10 });
        bar.show(Progress { done: 3, total: 10 });
        assert_eq!((bar.0.position(), bar.0.length()), (8, Some(10)));
    }
}
