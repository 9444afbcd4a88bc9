//! The communicator of the current thread.

use super::{Alone, Comm};
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    static PRESENT: RefCell<Arc<dyn Comm>> = RefCell::new(Arc::new(Alone));
}

/// The communicator of the current thread.
pub fn present() -> Arc<dyn Comm> {
    PRESENT.with_borrow(Clone::clone)
}

/// Whether the current thread is one of several ranks.
pub fn several() -> bool {
    PRESENT.with_borrow(|comm| comm.size() > 1)
}

/// Whether the current thread is the first rank, or the only one: it alone prints and writes files.
pub fn is_first() -> bool {
    PRESENT.with_borrow(|comm| comm.rank() == 0)
}

/// Runs `work` on this thread as one of these ranks.
pub fn run_as<T>(comm: Arc<dyn Comm>, work: impl FnOnce() -> T) -> T {
    /// Restores the previous communicator, even if the work panics.
    struct Before(Arc<dyn Comm>);
    impl Drop for Before {
        fn drop(&mut self) {
            PRESENT.set(std::mem::replace(&mut self.0, Arc::new(Alone)));
        }
    }
    let _before = Before(PRESENT.replace(comm));
    work()
}
