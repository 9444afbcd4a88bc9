//! Time and calls per op, kept by the plan itself.

use super::{Span, Tick};
use perigrain_world::share::Traffic;
use std::time::{Duration, Instant};

/// What an op has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meter {
    /// Wall time.
    pub time: Duration,
    /// Calls.
    pub calls: u64,
    /// Bytes touched, as the op reckons, in the calls that were looked at.
    pub bytes: u64,
    /// How many calls were.
    pub looks: u64,
    /// Of which rows it needs values in quiet steps, where particles are shared out to ranks.
    pub rows: Option<Span>,
    /// What ranks have exchanged for it in these.
    pub traffic: Traffic,
    /// In how many.
    pub exchanges: u64,
}

impl Meter {
    /// So many bytes were touched in a call.
    pub fn reckon(&mut self, bytes: u64) {
        self.bytes += bytes;
        self.looks += 1;
    }

    /// Ranks have exchanged so much for a call in a quiet step, which needed values of these rows.
    pub fn exchange(&mut self, rows: Span, traffic: Traffic) {
        self.rows = self.rows.max(Some(rows));
        self.traffic += traffic;
        self.exchanges += 1;
    }
}

/// Steps at the start that are all timed, to learn how long a step takes.
const TRIAL: u32 = 64;
/// After this many more steps the choice is made again, since scenes grow.
const ANEW: u32 = 1024;
/// Steps that take longer than this are all timed.
const SHORT: Duration = Duration::from_micros(40);
/// Of shorter steps, one in this many is timed.
const ONE_IN: u32 = 16;
/// Of steps shorter than this, one in this many: there, reading the clock takes a quarter of a step.
const TINY: (Duration, u32) = (Duration::from_micros(4), 64);

/// In which steps of a run ops are timed: reading the clock before and after each op takes a sixth of a step of five grains.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    steps: u32,
    /// One step in this many is timed; 0: all are.
    one_in: u32,
    /// The time ops had taken at the last choice.
    spent: Duration,
    /// Times are not needed.
    off: bool,
}

impl Timing {
    /// For a run whose times are not needed.
    pub fn off() -> Self {
        Self { off: true, ..Self::default() }
    }

    /// One more step begins; `spent` is what ops have taken so far.
    pub fn step(&mut self, spent: impl FnOnce() -> Duration) {
        self.steps += 1;
        if self.off || (self.steps != TRIAL && self.steps != ANEW) {
            return;
        }
        let spent = spent();
        let steps = if self.steps == TRIAL { TRIAL } else { ANEW - TRIAL };
        let each = spent.saturating_sub(self.spent) / steps;
        self.one_in = match () {
            () if each < TINY.0 => TINY.1,
            () if each < SHORT => ONE_IN,
            () => 0,
        };
        (self.spent, self.steps) = (spent, TRIAL);
    }

    /// A running clock, unless times are not needed.
    pub fn running(&self) -> Stopwatch {
        if self.off { Stopwatch { last: None, counts: 1 } } else { Stopwatch::all() }
    }

    /// The clock for this step: it stands still in most short steps, and a timed step counts for them.
    pub fn clock(&self, t: &Tick) -> Stopwatch {
        if self.off || self.one_in == 0 || t.setup {
            return self.running();
        }
        // Fibonacci hashing: the sample does not fall in with the period of any op.
        let place = (t.step as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let chosen = place * u64::from(self.one_in) < 1 << 32;
        Stopwatch { last: chosen.then(Instant::now), counts: self.one_in }
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

    /// Whether it runs.
    pub fn runs(&self) -> bool {
        self.last.is_some()
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
        let [mut tiny, mut short, mut long, mut growing] = [Timing::default(); 4];
        for _ in 0..TRIAL {
            tiny.step(|| Duration::from_micros(100));
            short.step(|| Duration::from_millis(1));
            long.step(|| Duration::from_millis(100));
            growing.step(|| Duration::from_micros(100));
        }
        for _ in TRIAL..ANEW {
            growing.step(|| Duration::from_millis(100));
        }
        assert_eq!((tiny.one_in, short.one_in, long.one_in, growing.one_in), (64, 16, 0, 0));
        let tick = |step| Tick { step, ..Tick::between_runs(&perigrain_world::Clock::default()) };
        assert!((0..1000).all(|step| long.clock(&tick(step)).runs()));
        assert!((0..1000).all(|step| !Timing::off().clock(&tick(step)).runs()));
        for every in [1, 2, 5, 16, 100] {
            for (timing, one_in) in [(short, 16), (tiny, 64)] {
                let runs = (0..1000 * one_in).filter(|k| timing.clock(&tick(every * k)).runs()).count();
                // A thousand, evenly spread: a few more or fewer.
                assert!(runs.abs_diff(1000) < 60, "every {every}: {runs}");
            }
        }
    }
}
