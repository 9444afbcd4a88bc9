//! How much memory there is.

use crate::diag::{Code, Diagnostic};
use crate::gate;

/// The error of what takes more bytes than are free now.
pub fn lacking(bytes: f64, what: &str) -> Option<Diagnostic> {
    let allowed = gate::memory_left();
    let free = available().into_iter().chain(allowed).reduce(f64::min).filter(|free| bytes > *free)?;
    let (needed, free) = (bytes / 1e9, free / 1e9);
    let text = format!("{what} would need {needed:.1} GB of memory; {free:.1} GB are free");
    Some(Diagnostic::error(Code::TOO_LARGE, None, text))
}

/// Bytes of memory that are free, where the system tells.
fn available() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("MemAvailable:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024.0)
}
