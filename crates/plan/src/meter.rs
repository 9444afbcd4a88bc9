//! Time and calls per op, kept by the plan itself.

use super::Tick;
use std::time::{Duration, Instant};

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

/// Steps that are all timed, to see how long they take.
const TRIAL: u32 = 64;
/// Steps that take longer are all timed.
const SHORT: Duration = Duration::from_micros(40);
/// Of shorter steps one in so many is.
const ONE_IN: u32 = 16;

/// In which steps of a run ops are timed: to look at the clock before and after each op takes a sixth of a step of five grains.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    steps: u32,
    sparse: bool,
}

impl Timing {
    /// One more step begins; `spent` is what ops have taken so far.
    pub fn step(&mut self, spent: impl FnOnce() -> Duration) {
        self.steps = self.steps.saturating_add(1);
        if self.steps == TRIAL {
            self.sparse = spent() < SHORT * TRIAL;
        }
    }

    /// The clock for this step: it stands in most short ones, and what passes in the others counts for those.
    pub fn clock(&self, t: &Tick) -> Stopwatch {
        // Fibonacci hashing: no period of what acts now and then falls in with it.
        let chosen =
            (t.step as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32 < (1 << 32) / u64::from(ONE_IN);
        match self.sparse && !t.setup {
            false => Stopwatch::all(),
            true => Stopwatch { last: chosen.then(Instant::now), counts: ONE_IN },
        }
    }
}

/// A clock that runs or stands.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    last: Option<Instant>,
    counts: u32,
}

impl Stopwatch {
    /// One that runs, and counts what passes.
    pub fn all() -> Self {
        Self { last: Some(Instant::now()), counts: 1 }
    }

    /// What has passed since the start or the last look, times what it counts; nothing if it stands.
    pub fn lap(&mut self) -> Duration {
        let Some(last) = &mut self.last else { return Duration::ZERO };
        let begin = std::mem::replace(last, Instant::now());
        (*last - begin) * self.counts
    }

    /// What `work` takes, times what the clock counts; nothing if it stands.
    pub fn of(&self, work: impl FnOnce()) -> Duration {
        let begin = self.last.map(|_| Instant::now());
        work();
        begin.map_or(Duration::ZERO, |begin| begin.elapsed() * self.counts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_sixteen_short_steps_counts_for_all() {
        let (mut short, mut long) = (Timing::default(), Timing::default());
        for _ in 0..TRIAL {
            short.step(|| Duration::from_micros(100));
            long.step(|| Duration::from_millis(100));
        }
        let tick = |step| Tick { step, ..Tick::between_runs(&perigrain_world::Clock::default()) };
        assert!((0..1000).all(|step| long.clock(&tick(step)).last.is_some()));
        for every in [1, 2, 5, 16, 100] {
            let runs = (0..16_000).filter(|k| short.clock(&tick(every * k)).last.is_some()).count();
            // A thousand, evenly spread: a few more or fewer.
            assert!(runs.abs_diff(1000) < 60, "every {every}: {runs}");
        }
    }
}
