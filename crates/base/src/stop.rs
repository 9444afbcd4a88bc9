//! Cancellation: one flag and one deadline, checked by all long loops.
//!
//! A session runs each line under a [`Stop`]. A loop that may take longer than half a second calls [`cuts`]
//! in every iteration (fast loops in every [`MANY`]th, by [`cuts_at`]) and breaks off if it returns true,
//! without further notice: the line then counts as not executed, whatever it computed. Where a loop can
//! return an error, [`check`] is one. Threads started by a command must run under [`present`] as well.

use crate::diag::{Code, Diagnostic, Result};
use std::cell::RefCell;
use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Iterations of a fast loop between two checks.
pub const MANY: usize = 1024;

/// External cancellation of work.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    /// Set by a signal, or by a host program.
    flag: Arc<AtomicBool>,
    /// Deadline.
    deadline: Option<Instant>,
    /// Set when some work has been broken off.
    cut: Arc<AtomicBool>,
}

thread_local! {
    static PRESENT: RefCell<Stop> = RefCell::default();
}

impl Stop {
    /// Cancels work when this flag is set, or at this time.
    pub fn new(flag: Arc<AtomicBool>, deadline: Option<Instant>) -> Self {
        Self { flag, deadline, cut: Arc::default() }
    }

    /// Whether work has to end.
    pub fn must_end(&self) -> bool {
        self.flag.load(Ordering::Relaxed) || self.deadline.is_some_and(|end| Instant::now() >= end)
    }

    /// Whether only the deadline has passed.
    pub fn is_late(&self) -> bool {
        !self.flag.load(Ordering::Relaxed) && self.must_end()
    }

    /// As [`Stop::must_end`]; work that hears yes is given up.
    pub fn cuts(&self) -> bool {
        let ends = self.must_end();
        if ends {
            self.cut.store(true, Ordering::Relaxed);
        }
        ends
    }

    /// Whether some work has been broken off.
    pub fn has_cut(&self) -> bool {
        self.cut.load(Ordering::Relaxed)
    }

    /// Runs work on this thread that ends when this `Stop` is set.
    pub fn heed<T>(&self, work: impl FnOnce() -> T) -> T {
        /// Restores the previous `Stop`, even if the work panics.
        struct Before(Stop);
        impl Drop for Before {
            fn drop(&mut self) {
                PRESENT.set(std::mem::take(&mut self.0));
            }
        }
        let _before = Before(PRESENT.replace(self.clone()));
        work()
    }
}

/// The `Stop` of the current thread.
pub fn present() -> Stop {
    PRESENT.with_borrow(Clone::clone)
}

/// Whether the current work must be broken off; see [`Stop::cuts`].
pub fn cuts() -> bool {
    PRESENT.with_borrow(Stop::cuts)
}

/// Like [`cuts`], checked in every [`MANY`]th iteration.
pub fn cuts_at(turn: usize) -> bool {
    turn.is_multiple_of(MANY) && cuts()
}

/// An error if the current work must be broken off.
///
/// # Errors
/// [`Code::INTERRUPTED`].
pub fn check() -> Result<()> {
    if !cuts() {
        return Ok(());
    }
    Err(Diagnostic::error(Code::INTERRUPTED, None, "interrupted before it was done").into())
}

/// A reader that fails if the current work must be broken off.
pub struct Heeding<R>(pub R);

impl<R: Read> Read for Heeding<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if cuts() {
            // Not of a kind that readers retry by themselves.
            return Err(std::io::Error::other("interrupted before it was read"));
        }
        self.0.read(buffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn work_is_given_up_while_a_flag_is_heeded() {
        let stop = Stop::new(Arc::default(), None);
        assert!(!stop.heed(cuts) && !stop.has_cut());
        stop.flag.store(true, Ordering::Relaxed);
        // A look alone gives nothing up, and nothing is heeded outside.
        assert!(stop.must_end() && !stop.has_cut() && !cuts() && check().is_ok());
        assert!(stop.heed(|| !cuts_at(1) && cuts_at(MANY) && check().is_err()));
        assert!(stop.has_cut() && !stop.is_late() && !cuts());
    }

    #[test]
    fn a_limit_of_time_is_heeded_on_the_threads_of_the_pool_too() {
        let stop = Stop::new(Arc::default(), Some(Instant::now() + Duration::from_millis(20)));
        assert!(stop.heed(|| crate::par::inside(|| !cuts())));
        std::thread::sleep(Duration::from_millis(30));
        assert!(stop.heed(|| crate::par::inside(cuts)) && stop.is_late());
    }
}
