//! Work that takes time: on a thread of its own, while Python's threads run and Ctrl-C is heard.

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

/// How often the screen is shown and Ctrl-C is looked for.
const PERIOD: Duration = Duration::from_millis(25);

/// How a piece of work ended.
pub struct Ended<T> {
    /// What came out; `Err` with the words of a panic.
    pub outcome: Result<T, String>,
    /// What a signal handler of Python has raised in the meantime.
    pub raised: Option<PyErr>,
}

/// Does `job` right here: for what takes no longer than to begin a thread.
pub fn at_once<T>(job: impl FnOnce() -> T) -> Ended<T> {
    let outcome = catch_unwind(AssertUnwindSafe(job)).map_err(|panic| words(&*panic));
    Ended { outcome, raised: None }
}

/// Does `job` on a thread of its own. What a signal handler raises sets `stop`; the job is expected to end soon then.
pub fn beside<T: Send>(
    py: Python<'_>,
    screen: &Screen,
    stop: &AtomicBool,
    job: impl FnOnce() -> T + Send,
) -> Ended<T> {
    let (outcome, raised) = py.detach(|| {
        thread::scope(|scope| {
            let (done, ended) = channel::<()>();
            // As much stack as the threads of a run have.
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

/// What a panic says.
pub fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".into())
}
