//! Ctrl-C, and SIGTERM and SIGHUP where there are any: a wish to stop, not an order to die.

use std::{
    process,
    sync::atomic::{AtomicBool, Ordering},
};

use super::{exit, failure::warn_of};

static WISHED: AtomicBool = AtomicBool::new(false);

/// From now on a signal is a wish; the second one is an order.
pub(super) fn listen() {
    let heard = ctrlc::set_handler(|| {
        if WISHED.swap(true, Ordering::Relaxed) {
            process::exit(exit::STOPPED.into());
        }
    });
    if let Err(error) = heard {
        warn_of(format!("signals end the program at once: {error}"));
    }
}

/// Has somebody asked to stop?
pub(super) fn wished() -> bool {
    WISHED.load(Ordering::Relaxed)
}
