//! Measures whether threads pay off: from time to time a run is timed with all threads and with one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Whether the calling thread does all work itself.
static ALONE: AtomicBool = AtomicBool::new(false);
/// Whether a loop has had parts to share since the last check.
static SHARED: AtomicBool = AtomicBool::new(false);
/// The result of the last run; taken out during a run.
static LAST: Mutex<Option<Found>> = Mutex::new(None);

/// Whether loops must run on the calling thread.
#[inline]
pub(super) fn alone() -> bool {
    ALONE.load(Ordering::Relaxed)
}

/// Records that a loop has parts that threads could share.
#[inline]
pub(super) fn shares() {
    if !SHARED.load(Ordering::Relaxed) {
        SHARED.store(true, Ordering::Relaxed);
    }
}

/// Minimum duration of a window.
const SPAN: Duration = Duration::from_millis(5);
/// Steps and time ignored after a change: threads fall asleep or wake up, memory moves between cores.
const SETTLING: (u32, Duration) = (3, Duration::from_millis(1));
/// Longer steps are work for many threads on any machine, and a trial would be expensive.
const LONG: Duration = Duration::from_millis(10);
/// Reading the clock takes about 30 ns: shorter steps than this are timed together, at most
/// [`MOST_TOGETHER`].
const WORTH_A_LOOK: Duration = Duration::from_micros(4);
const MOST_TOGETHER: u32 = 16;
/// Of two nearly equal modes the current one is kept.
const CLEARLY: f64 = 0.95;
/// Penalty on steps with threads: a saving below a tenth takes cores from other programs, and on a busy
/// machine it loses more in some windows than it gains in others.
const DEAR: f64 = 1.1;
/// A ratio beyond which a trial is certain.
const FAR: f64 = 0.8;
/// Number of windows between the first two trials without a clear result.
const FIRST_REST: f64 = 8.0;
/// Maximum cost of trials as a fraction of the time: the number of windows between trials is the relative
/// slowdown without threads, divided by this.
const COST: f64 = 0.01;

/// Time and number of steps of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    steps: u32,
    time: Duration,
}

impl Sum {
    fn add(&mut self, steps: u32, time: Duration) {
        self.steps += steps;
        self.time += time;
    }

    /// Seconds per step, if there are enough steps.
    fn mean(self) -> Option<f64> {
        (self.steps > 0).then(|| self.time.as_secs_f64() / f64::from(self.steps))
    }
}

/// The faster mode, and the interval between trials.
#[derive(Clone, Copy, Debug)]
struct Found {
    alone: bool,
    rest: f64,
}

/// State of a trial.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// The faster mode runs for some windows.
    Rest(u32),
    /// It is timed.
    Before,
    /// The other mode is timed.
    Other { before: f64 },
    /// The faster mode is timed again, because the system changes.
    After { before: f64, other: f64 },
}

/// Times the steps of a run with all threads and with one, and continues with the faster mode. Which one is
/// faster depends on the system (small loops end before other threads could start) and on the load of the
/// machine; results do not depend on it.
#[derive(Debug)]
pub struct Trial {
    found: Found,
    phase: Phase,
    /// End of the last step at which the clock was read.
    last: Option<Instant>,
    /// Steps since then, their target number, and whether lists were made in one of them.
    together: u32,
    look_after: u32,
    anew: bool,
    /// Start of the current window, and its number of steps.
    since: Instant,
    seen: u32,
    /// Steps that remade lists, and the others.
    sums: [Sum; 2],
}

impl Trial {
    /// The trial of a run that begins; `None` with a single thread. Two simultaneous runs in one program
    /// share the setting, which costs time and changes no result.
    pub fn begin() -> Option<Self> {
        if super::threads() < 2 {
            return None;
        }
        let fresh = Found { alone: false, rest: FIRST_REST };
        let found = LAST.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or(fresh);
        Some(Self::of(Found { rest: FIRST_REST, ..found }))
    }

    fn of(found: Found) -> Self {
        ALONE.store(found.alone, Ordering::Relaxed);
        SHARED.store(false, Ordering::Relaxed);
        let now = Instant::now();
        Self {
            found,
            phase: Phase::Before,
            last: None,
            together: 0,
            look_after: 1,
            anew: false,
            since: now,
            seen: 0,
            sums: Default::default(),
        }
    }

    /// Records a step; `anew`: lists were remade, which is another kind of work.
    #[inline]
    pub fn step(&mut self, anew: bool) {
        // If no loop has parts to share there is nothing to try, and reading the clock takes longer than
        // small loops.
        if SHARED.load(Ordering::Relaxed) {
            self.together += 1;
            self.anew |= anew;
            if self.together >= self.look_after {
                self.timed(Instant::now());
            }
        }
    }

    /// Ends the interval since the last clock reading.
    fn timed(&mut self, now: Instant) {
        let (steps, anew) = (std::mem::take(&mut self.together), std::mem::take(&mut self.anew));
        let Some(last) = self.last.replace(now) else {
            self.open(now);
            return;
        };
        self.seen += 1;
        let waits = self.seen <= SETTLING.0 && now - self.since < SETTLING.1;
        if !waits {
            self.sums[usize::from(!anew)].add(steps, now - last);
        }
        if now - self.since >= SPAN {
            self.close();
            self.open(now);
        }
    }

    /// Begins a window.
    fn open(&mut self, now: Instant) {
        (self.since, self.seen, self.sums) = (now, 0, Default::default());
        SHARED.store(false, Ordering::Relaxed);
        let other = matches!(self.phase, Phase::Other { .. });
        ALONE.store(self.found.alone != other, Ordering::Relaxed);
    }

    /// Ends a window.
    fn close(&mut self) {
        let [anew, quiet] = self.sums;
        let quiet = quiet.mean();
        if let Some(mean) = quiet {
            let together = WORTH_A_LOOK.as_secs_f64() / mean;
            self.look_after = together.clamp(1.0, f64::from(MOST_TOGETHER)) as u32;
        }
        self.phase = match (self.phase, quiet) {
            (Phase::Rest(left), _) if left > 0 => Phase::Rest(left - 1),
            (Phase::Rest(_), _) => Phase::Before,
            // There was not a single step without rebuilding, either by chance or always.
            (_, None) => Phase::Rest(if anew.steps > 0 { FIRST_REST as u32 } else { 0 }),
            (Phase::Before, Some(before)) if before > LONG.as_secs_f64() => {
                self.found.alone = false;
                Phase::Rest((1.0 / COST) as u32)
            }
            (Phase::Before, Some(before)) => Phase::Other { before },
            (Phase::Other { before }, Some(other)) => Phase::After { before, other },
            (Phase::After { before, other }, Some(after)) => self.judge(other, 0.5 * (before + after)),
        };
    }

    /// Continues with the faster mode: the `other` one or `this` one [seconds per step].
    fn judge(&mut self, other: f64, this: f64) -> Phase {
        let [other, this] = if self.found.alone { [DEAR * other, this] } else { [other, DEAR * this] };
        if other < CLEARLY * this {
            self.found = Found { alone: !self.found.alone, rest: FIRST_REST };
        } else {
            let most = ((other / this - 1.0).max(0.1) / COST).max(FIRST_REST);
            // A clear result need not be measured again soon.
            self.found.rest = if this < FAR * other { most } else { (2.0 * self.found.rest).min(most) };
        }
        Phase::Rest(self.found.rest as u32)
    }
}

impl Drop for Trial {
    fn drop(&mut self) {
        ALONE.store(false, Ordering::Relaxed);
        *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates `windows` windows of a system with steps of `together` or `alone` milliseconds; returns the
    /// fraction of steps made alone.
    fn part_alone(trial: &mut Trial, windows: u32, [together, alone]: [f64; 2]) -> f64 {
        let mut now = trial.last.unwrap_or(trial.since);
        let mut made = [0.0; 2];
        let end = now + SPAN * windows;
        while now < end {
            SHARED.store(true, Ordering::Relaxed);
            let is_alone = ALONE.load(Ordering::Relaxed);
            let takes = if is_alone { alone } else { together };
            now += Duration::from_secs_f64(takes * 1e-3);
            made[usize::from(is_alone)] += takes;
            trial.together += 1;
            trial.timed(now);
        }
        made[1] / (made[0] + made[1])
    }

    #[test]
    fn the_faster_way_is_found_again_when_the_machine_changes() {
        let mut trial = Trial::of(Found { alone: false, rest: FIRST_REST });
        // Two threads pay off: trials take a hundredth of the time in the long run.
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.02);
        // Another program occupies a core.
        assert!(part_alone(&mut trial, 1000, [0.3, 0.2]) > 0.85);
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.3);
        // A mode that saves a fifteenth is kept, but not started.
        assert!(part_alone(&mut trial, 1000, [0.14, 0.15]) < 0.2);
        assert!(part_alone(&mut trial, 1000, [0.3, 0.2]) > 0.85);
        assert!(part_alone(&mut trial, 1000, [0.14, 0.15]) > 0.9);
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.3);
        // A mode without gain is left.
        assert!(part_alone(&mut trial, 1000, [0.1, 0.1]) > 0.9);
        drop(trial);
        assert!(!alone());
    }
}
