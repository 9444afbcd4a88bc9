//! Whether threads pay: now and then a run is timed with all of them and without.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Whether the calling thread does all work by itself.
static ALONE: AtomicBool = AtomicBool::new(false);
/// Whether a loop has had parts to share since somebody asked.
static SHARED: AtomicBool = AtomicBool::new(false);
/// What the last run has found out; taken out while a run goes on.
static LAST: Mutex<Option<Found>> = Mutex::new(None);

/// Whether loops are to be left to the calling thread.
#[inline]
pub(super) fn alone() -> bool {
    ALONE.load(Ordering::Relaxed)
}

/// A loop has parts that threads could share.
#[inline]
pub(super) fn shares() {
    if !SHARED.load(Ordering::Relaxed) {
        SHARED.store(true, Ordering::Relaxed);
    }
}

/// How long a window lasts, at least.
const SPAN: Duration = Duration::from_millis(5);
/// What is not counted after a change: threads fall asleep or wake up, memory moves from core to core.
const SETTLING: (u32, Duration) = (3, Duration::from_millis(1));
/// Steps that take longer are many threads' work on any machine, and a trial would be dear.
const LONG: Duration = Duration::from_millis(10);
/// To look at the clock takes some 30 ns: of shorter steps than this several are timed together, [`MOST_TOGETHER`] at most.
const WORTH_A_LOOK: Duration = Duration::from_micros(4);
const MOST_TOGETHER: u32 = 16;
/// Of two that take nearly the same time the one that is in use stays.
const CLEARLY: f64 = 0.95;
/// A step with threads counts as so many times as long: what saves less than a tenth takes from others on the machine what it does not
/// need, and where they are busy it loses more in some windows than it gains in others.
const DEAR: f64 = 1.1;
/// And of two that differ by more than this the trial has been no accident.
const FAR: f64 = 0.8;
/// Windows between the first two trials that tell little.
const FIRST_REST: f64 = 8.0;
/// A trial may take this part of the time: as many windows lie between trials as one without threads takes times more, over this.
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

    /// Seconds per step, if there are enough to tell.
    fn mean(self) -> Option<f64> {
        (self.steps > 0).then(|| self.time.as_secs_f64() / f64::from(self.steps))
    }
}

/// Which way of working wins, and how long it has been left alone.
#[derive(Clone, Copy, Debug)]
struct Found {
    alone: bool,
    rest: f64,
}

/// Where a trial stands.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// The way that won goes on for some windows.
    Rest(u32),
    /// It is timed.
    Before,
    /// The other way is timed.
    Other { before: f64 },
    /// The way that won is timed again: scenes change.
    After { before: f64, other: f64 },
}

/// Times the steps of a run with all threads and with one, and goes on with what is faster. Which it is hangs on the scene (small
/// loops are done before another thread has seen them) and on what else the machine does; results do not hang on it.
#[derive(Debug)]
pub struct Trial {
    found: Found,
    phase: Phase,
    /// End of the last step, where the clock was looked at.
    last: Option<Instant>,
    /// Steps since then, of how many, and whether lists were made in one.
    together: u32,
    look_after: u32,
    anew: bool,
    /// When the present window began, and its steps so far.
    since: Instant,
    seen: u32,
    /// Steps that made lists anew, and the others.
    sums: [Sum; 2],
}

impl Trial {
    /// The trial of a run that begins; `None` where there is one thread only. Of two runs at a time in one program each tries for
    /// both, which costs time and changes no result.
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

    /// A step is made; `anew`: lists were made in it, which is another kind of work.
    #[inline]
    pub fn step(&mut self, anew: bool) {
        // Where no loop has parts to share there is nothing to try, and to look at the clock takes longer than small loops.
        if SHARED.load(Ordering::Relaxed) {
            self.together += 1;
            self.anew |= anew;
            if self.together >= self.look_after {
                self.timed(Instant::now());
            }
        }
    }

    /// The steps since the last look end now.
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
            // Not one quiet step, of a scene that has some or of one that has none.
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

    /// Goes on with what is faster: the `other` way or `this` one [seconds per step].
    fn judge(&mut self, other: f64, this: f64) -> Phase {
        let [other, this] = if self.found.alone { [DEAR * other, this] } else { [other, DEAR * this] };
        if other < CLEARLY * this {
            self.found = Found { alone: !self.found.alone, rest: FIRST_REST };
        } else {
            let most = ((other / this - 1.0).max(0.1) / COST).max(FIRST_REST);
            // What is this clear at once need not be asked again soon.
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

    /// Steps through `windows` windows of a scene whose steps take `together` or `alone` milliseconds; the part of them
    /// made alone.
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
        // Two threads pay: a trial takes a hundredth of the time in the long run.
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.02);
        // Another program takes a core.
        assert!(part_alone(&mut trial, 1000, [0.3, 0.2]) > 0.85);
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.3);
        // What saves a fifteenth is used, and not begun.
        assert!(part_alone(&mut trial, 1000, [0.14, 0.15]) < 0.2);
        assert!(part_alone(&mut trial, 1000, [0.3, 0.2]) > 0.85);
        assert!(part_alone(&mut trial, 1000, [0.14, 0.15]) > 0.9);
        assert!(part_alone(&mut trial, 1000, [0.1, 0.18]) < 0.3);
        // What saves nothing is left.
        assert!(part_alone(&mut trial, 1000, [0.1, 0.1]) > 0.9);
        drop(trial);
        assert!(!alone());
    }
}
