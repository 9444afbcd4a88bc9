//! Whether the present work has to end before it is done: one flag and one limit of time, which all long loops look at.
//!
//! A session heeds a [`Stop`] while it executes a line. A loop that may last longer than half a second asks [`cuts`] in every turn
//! (of quick turns in every [`MANY`]th, by [`cuts_at`]), gives up where that is so, and need not say so: the line then counts as not
//! done, whatever came of it. Where a loop can return an error, [`check`] is one. Threads that a command starts take
//! [`present`] along.

use crate::diag::{Code, Diagnostic, Result};
use std::cell::RefCell;
use std::io::Read;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Quick turns of a loop between two looks.
pub const MANY: usize = 1024;

/// What ends work from outside.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    /// A signal, or a program around this one.
    flag: Arc<AtomicBool>,
    /// A limit of time.
    deadline: Option<Instant>,
    /// Some work was given up.
    cut: Arc<AtomicBool>,
}

thread_local! {
    static PRESENT: RefCell<Stop> = RefCell::default();
}

impl Stop {
    /// Work ends where this flag is set, or at this time.
    pub fn new(flag: Arc<AtomicBool>, deadline: Option<Instant>) -> Self {
        Self { flag, deadline, cut: Arc::default() }
    }

    /// Whether work has to end.
    pub fn must_end(&self) -> bool {
        self.flag.load(Ordering::Relaxed) || self.deadline.is_some_and(|end| Instant::now() >= end)
    }

    /// Whether the limit of time alone is why.
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

    /// Whether some work was given up.
    pub fn has_cut(&self) -> bool {
        self.cut.load(Ordering::Relaxed)
    }

    /// Does work on this thread that ends where this says so.
    pub fn heed<T>(&self, work: impl FnOnce() -> T) -> T {
        /// Puts back what was heeded before, also where the work panics.
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

/// What the present work heeds.
pub fn present() -> Stop {
    PRESENT.with_borrow(Clone::clone)
}

/// Whether the present work has to be given up; see [`Stop::cuts`].
pub fn cuts() -> bool {
    PRESENT.with_borrow(Stop::cuts)
}

/// As [`cuts`], looked at in every [`MANY`]th turn.
pub fn cuts_at(turn: usize) -> bool {
    turn.is_multiple_of(MANY) && cuts()
}

/// An error where the present work has to be given up.
///
/// # Errors
/// [`Code::INTERRUPTED`].
pub fn check() -> Result<()> {
    if !cuts() {
        return Ok(());
    }
    Err(Diagnostic::error(Code::INTERRUPTED, None, "interrupted before it was done").into())
}

/// A reader that fails where the present work has to be given up.
pub struct Heeding<R>(pub R);

impl<R: Read> Read for Heeding<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if cuts() {
            // Not of the kind that readers try again by themselves.
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
