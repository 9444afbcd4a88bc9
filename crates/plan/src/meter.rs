//! Time and calls per op, kept by the plan itself.

use std::time::Duration;

/// What an op has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meter {
    /// Wall time.
    pub time: Duration,
    /// Calls.
    pub calls: u64,
    /// Bytes touched, as the op reckons.
    pub bytes: u64,
}
