//! Time: the step counter, the step size and what has elapsed.

/// Where a run stands in time.
///
/// Stored as between runs, at whatever step of one it is stored: files of one step differ in nothing.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(from = "Stored", into = "Stored")]
pub struct Clock {
    /// Present step.
    pub step: i64,
    /// Step size in time units of the deck.
    pub dt: f64,
    /// Time at `time_step`.
    pub time_base: f64,
    /// Step at which `time_base` was taken (moves when dt changes).
    pub time_step: i64,
    /// First step of the present (or last) run.
    pub first: i64,
    /// Last step of the present (or last) run.
    pub last: i64,
    /// Step at which `run … start` begins (for ramps); the first step by default.
    pub start: i64,
    /// Step at which `run … stop` ends (for ramps); the last step by default.
    pub stop: i64,
    /// When the present run's steps began, for the keyword `cpu`.
    pub began: Option<std::time::Instant>,
    /// Whether a run is in progress.
    pub running: bool,
    /// The steps since `time_step` were iterations of a minimization: the next run does not count their time.
    pub minimizing: bool,
    /// The step size that the deck named, while a minimization has one of its own [time].
    pub named_dt: Option<f64>,
    /// The run continues without a setup of its own (`pre no`).
    pub onward: bool,
    /// Whether a fix has ended the run.
    pub halt: Halt,
}

/// A [`Clock`] as restart files have it.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Clock")]
struct Stored {
    step: i64,
    dt: f64,
    time_base: f64,
    time_step: i64,
    first: i64,
    last: i64,
    start: i64,
    stop: i64,
    running: bool,
    #[serde(default)]
    minimizing: bool,
    halt: Halt,
}

impl From<Clock> for Stored {
    fn from(c: Clock) -> Self {
        Self {
            step: c.step,
            dt: c.named_dt.unwrap_or(c.dt),
            time_base: c.time_base,
            time_step: c.time_step,
            first: c.first,
            last: c.step,
            start: c.start,
            stop: if c.stop == c.last { c.step } else { c.stop },
            running: false,
            minimizing: c.minimizing,
            halt: Halt::No,
        }
    }
}

impl From<Stored> for Clock {
    fn from(s: Stored) -> Self {
        Self {
            step: s.step,
            dt: s.dt,
            time_base: s.time_base,
            time_step: s.time_step,
            first: s.first,
            last: s.last,
            start: s.start,
            stop: s.stop,
            running: s.running,
            minimizing: s.minimizing,
            halt: s.halt,
            ..Self::default()
        }
    }
}

/// The request of `fix halt`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Halt {
    /// Nothing.
    #[default]
    No,
    /// This run is over.
    Run,
    /// This run is over, and there are no more.
    All,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            step: 0,
            dt: 0.005,
            time_base: 0.0,
            time_step: 0,
            first: 0,
            last: 0,
            start: 0,
            stop: 0,
            began: None,
            running: false,
            minimizing: false,
            named_dt: None,
            onward: false,
            halt: Halt::No,
        }
    }
}

impl Clock {
    /// Elapsed time [time units]: accumulated with the dt of each step.
    pub fn time(&self) -> f64 {
        self.time_base + (self.step - self.time_step) as f64 * self.dt
    }

    /// Changes dt from the next step on; elapsed time keeps the old one up to here.
    pub fn set_dt(&mut self, dt: f64) {
        if dt == self.dt {
            return; // the sum of the time so far keeps its bits
        }
        self.time_base = self.time();
        self.time_step = self.step;
        self.dt = dt;
    }

    /// A minimization begins: its iterations count as time until the next run (as LAMMPS has it).
    pub fn begin_minimizing(&mut self) {
        if !self.minimizing {
            self.time_base = self.time();
            self.time_step = self.step;
            self.minimizing = true;
        }
    }

    /// A run begins: the iterations of a minimization before it have taken no time.
    pub fn begin_moving(&mut self) {
        if self.minimizing {
            self.time_step = self.step;
            self.minimizing = false;
        }
    }

    /// Sets the counter (`reset_timestep`): time restarts at step · dt.
    pub fn reset(&mut self, step: i64) {
        self.step = step;
        self.time_base = step as f64 * self.dt;
        self.time_step = step;
        self.minimizing = false;
        self.first = step;
        self.last = step;
        self.start = step;
        self.stop = step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_accumulates_with_the_old_step() {
        let mut c = Clock { dt: 0.5, ..Clock::default() };
        c.step = 4;
        c.set_dt(0.25);
        c.step = 6;
        assert_eq!(c.time(), 2.5); // 4 · 0.5 + 2 · 0.25
    }
}
