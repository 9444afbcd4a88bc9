//! Requests of the system to end: of a queue at its time limit, of `kill`, of a terminal that is closed.

/// Calls `ask` for each of them, on a thread of its own. One that the caller has switched off, as `nohup` does, stays so.
#[cfg(unix)]
pub fn listen(ask: impl Fn() + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGTERM};
    let ignored = ignored();
    let wanted =
        [SIGTERM, SIGHUP].into_iter().filter(|s| ignored.is_some_and(|mask| mask >> (s - 1) & 1 == 0));
    // Without a handler they end the program as they always did.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(wanted) else { return };
    std::thread::spawn(move || signals.forever().for_each(|_| ask()));
}

/// Nothing to listen to.
#[cfg(not(unix))]
pub fn listen(_ask: impl Fn() + Send + 'static) {}

/// The signals that are ignored, a bit each from the first one on; `None` where the system does not tell.
#[cfg(unix)]
fn ignored() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}
