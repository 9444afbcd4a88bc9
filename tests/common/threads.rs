//! The number of threads, which belongs to the whole process.

use std::sync::{Mutex, MutexGuard, PoisonError};

static THREADS: Mutex<()> = Mutex::new(());

/// Held while a test examines the effect of numbers of threads.
pub fn alone() -> MutexGuard<'static, ()> {
    THREADS.lock().unwrap_or_else(PoisonError::into_inner)
}
