//! Something to be done now and then while something else is done.

use std::{
    sync::{Condvar, Mutex, PoisonError},
    thread,
    time::Duration,
};

/// Does `work`, and meanwhile, on a thread of its own, `visit`: first after a pause, then after each pause that it
/// returns. It is not interrupted, and has ended when this returns.
pub(super) fn meanwhile(pause: Duration, mut visit: impl FnMut() -> Duration + Send, work: impl FnOnce()) {
    let done = Done::default();
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut pause = pause;
            while !done.wait(pause) {
                pause = visit();
            }
        });
        // Said by a drop, so that work that panics is not waited for.
        let _end = End(&done);
        work();
    });
}

/// Is the work done?
#[derive(Default)]
struct Done(Mutex<bool>, Condvar);

impl Done {
    /// Waits until it is, or for so long.
    fn wait(&self, time: Duration) -> bool {
        let guard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.1.wait_timeout_while(guard, time, |done| !*done);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

struct End<'d>(&'d Done);

impl Drop for End<'_> {
    fn drop(&mut self) {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.1.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visits_end_with_the_work() {
        let mut visits = 0;
        let visit = || {
            visits += 1;
            Duration::from_secs(if visits < 3 { 0 } else { 3600 })
        };
        meanwhile(Duration::ZERO, visit, || thread::sleep(Duration::from_millis(200)));
        assert_eq!(visits, 3);
        meanwhile(Duration::from_secs(3600), || unreachable!("it is too early"), || ());
    }
}
