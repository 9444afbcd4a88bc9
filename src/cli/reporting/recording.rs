//! Snapshots while a run goes on: the scene is read at even intervals, and nothing of the run depends on it.

use crate::cli::progress::Progress;
use crate::report::film::{Film, taken};
use crate::session::{Made, Watch};
use perigrain_world::World;
use std::sync::{Arc, Mutex, PoisonError};

/// Shows each step in the live line, and takes snapshots.
pub struct Recorder {
    bar: Progress,
    film: Arc<Mutex<Film>>,
    /// Steps of earlier runs, and of this one.
    before: u64,
    made: u64,
    every: u64,
}

impl Recorder {
    /// One that takes nothing yet.
    pub fn new(bar: Progress) -> Self {
        Self { bar, film: Arc::default(), before: 0, made: 0, every: 1 }
    }

    /// What it takes.
    pub fn film(&self) -> Arc<Mutex<Film>> {
        self.film.clone()
    }
}

impl Watch for Recorder {
    fn begins(&mut self, w: &World) {
        self.before += std::mem::take(&mut self.made);
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        // A minimization ends when it has found something.
        film.expect(if w.clock.minimizing { 0 } else { w.clock.last - w.clock.first });
        if film.grid().is_none() {
            let frame = taken(w, None);
            film.take(0, frame);
        }
        self.every = film.every();
    }

    fn step(&mut self, made: &Made) {
        self.made = made.done.max(0) as u64;
        self.bar.step(made);
    }

    fn looks(&mut self, w: &World) -> bool {
        let done = (w.clock.step - w.clock.first).max(0) as u64;
        (self.before + done).is_multiple_of(self.every)
    }

    fn scene(&mut self, w: &World) {
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        let frame = taken(w, film.grid());
        film.take(self.before + self.made, frame);
        self.every = film.every();
    }
}
