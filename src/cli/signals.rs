//! Requests of the system to end: of a queue at its time limit, of `kill`, of a terminal that is closed; and limits of the shell.

#[cfg(unix)]
use std::time::{Duration, Instant};

/// Calls `ask` for each of them, on a thread of its own. A signal that the caller has switched off, as `nohup` does, stays off.
#[cfg(unix)]
pub fn listen(ask: impl Fn() + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGTERM, SIGXCPU};
    let ignored = ignored();
    let wanted = [SIGTERM, SIGHUP, SIGXCPU]
        .into_iter()
        .filter(|s| ignored.is_some_and(|mask| mask >> (s - 1) & 1 == 0));
    // Without a handler they end the program as they always did.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(wanted) else { return };
    std::thread::spawn(move || {
        let (mut spent, mut last) = (false, None::<Instant>);
        for signal in signals.forever() {
            // Past its limit of processor time (`ulimit -t`) a program gets that signal again every second.
            let repeated = signal == SIGXCPU && std::mem::replace(&mut spent, true);
            if !repeated && last.is_none_or(|last| last.elapsed() >= ONE_REQUEST) {
                last = Some(Instant::now());
                ask();
            }
        }
    });
}

/// Signals that come within this time are one request: a queue sends them to all processes of a job, and scripts and programs
/// around this one pass on those that they get themselves.
#[cfg(unix)]
const ONE_REQUEST: Duration = Duration::from_secs(1);

/// A file that outgrows the limit for files (`ulimit -f`) fails as on a full disk: the write returns an error, and the signal
/// that would end the program at once does nothing.
#[cfg(unix)]
pub fn outlive_large_files() {
    // A handler, as commands that a deck starts would inherit a signal that is ignored. Without one all is as it was.
    let came = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, came);
}

/// Nothing to outlive.
#[cfg(not(unix))]
pub fn outlive_large_files() {}

/// Nothing to listen to.
#[cfg(not(unix))]
pub fn listen(_ask: impl Fn() + Send + 'static) {}

/// The signals that are ignored, a bit each from the first one on; `None` if the system does not report them.
#[cfg(unix)]
fn ignored() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}
