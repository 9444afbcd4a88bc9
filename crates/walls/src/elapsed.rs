//! Time since a fix was declared.

use perigrain_world::{Numbers, World};

/// Time since the declaration, valid also when the time step changes or steps are renumbered.
#[derive(Clone, Copy)]
pub struct Elapsed {
    /// Step of the declaration.
    pub origin: f64,
    /// Time at `step`.
    time: f64,
    /// The step since which `dt` has been in effect.
    step: f64,
    /// The current time step.
    dt: f64,
    /// The latest step.
    last: f64,
}

impl Elapsed {
    /// Loads the state stored under this key, or starts at the current step.
    pub fn load(w: &World, key: Numbers) -> Self {
        match w.memo.get(key).map(Vec::as_slice) {
            Some(&[origin, time, step, dt, last]) => Self { origin, time, step, dt, last },
            _ => {
                let step = w.clock.step as f64;
                Self { origin: step, time: 0.0, step, dt: w.clock.dt, last: step }
            }
        }
    }

    /// Stores the state in the world.
    pub fn store(self, w: &mut World, key: Numbers) {
        let Self { origin, time, step, dt, last } = self;
        match w.memo.get_mut(key) {
            Some(memo) => memo.copy_from_slice(&[origin, time, step, dt, last]),
            None => drop(w.memo.insert(key, vec![origin, time, step, dt, last])),
        }
    }

    /// Time at the latest step.
    pub fn time(&self) -> f64 {
        self.time + (self.last - self.step) * self.dt
    }

    /// Advances to `step` with time step `dt`.
    pub fn follow(&mut self, step: i64, dt: f64) {
        let before = (step - 1) as f64;
        self.step += before - self.last;
        self.last = before;
        if dt != self.dt {
            *self = Self { time: self.time(), step: before, dt, ..*self };
        }
        self.last = step as f64;
    }
}
