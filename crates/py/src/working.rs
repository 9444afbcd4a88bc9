//! Long operations on a separate thread, while Python threads run and Ctrl-C is handled.

use super::screen::Screen;
use perigrain::par::STACK;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

type Panic = Box<dyn Any + Send>;

/// Interval at which the screen is updated and Ctrl-C is checked.
const PERIOD: Duration = Duration::from_millis(25);

/// Result of an operation.
pub struct Ended<T> {
    /// The result; `Err` with the text of a panic.
    pub outcome: Result<T, String>,
    /// An exception raised by a Python signal handler in the meantime.
    pub raised: Option<PyErr>,
}

/// Runs `job` on this thread: for operations shorter than starting a thread.
pub fn at_once<T>(job: impl FnOnce() -> T) -> Ended<T> {
    let outcome = catch_unwind(AssertUnwindSafe(job)).map_err(|panic| words(&*panic));
    Ended { outcome, raised: None }
}

/// Runs `job` on a separate thread. An exception of a signal handler sets `stop`; the job should end soon
/// then.
pub fn beside<T: Send>(
    py: Python<'_>,
    screen: &Screen,
    stop: &AtomicBool,
    job: impl FnOnce() -> T + Send,
) -> Ended<T> {
    let (outcome, raised) = py.detach(|| {
        thread::scope(|scope| {
            let (done, ended) = channel::<()>();
            // The stack size of the threads of a run.
            let thread = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, move || {
                let outcome = catch_unwind(AssertUnwindSafe(job));
                drop(done);
                outcome
            });
            let worker = match thread {
                Ok(worker) => worker,
                Err(e) => return (Err(Box::new(format!("the system grants no thread: {e}")) as Panic), None),
            };
            let mut raised = None;
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(PERIOD) {
                Python::attach(|py| {
                    screen.show(py);
                    if let Err(e) = py.check_signals() {
                        stop.store(true, Ordering::Relaxed);
                        raised.get_or_insert(e);
                    }
                });
            }
            (worker.join().unwrap_or_else(Err), raised)
        })
    });
    Ended { outcome: outcome.map_err(|panic| words(&*panic)), raised }
}

/// The text of a panic.
pub fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".into())
}
