//! Snapshots during a run: the scene is read at even intervals, and nothing of the run depends on it.

use crate::cli::progress::Progress;
use crate::cli::viewing::Live;
use crate::report::film::{Film, taken};
use crate::session::{Made, Watch};
use perigrain_world::World;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Shows each step in the live line, and takes snapshots for a page that is written at the end or is open already.
pub struct Recorder {
    bar: Progress,
    film: Arc<Mutex<Film>>,
    /// Whether a film is wanted.
    films: bool,
    live: Option<Arc<Live>>,
    /// Ends the run.
    stop: Arc<AtomicBool>,
    born: Instant,
    /// The live page requests the step that is being made.
    shown: bool,
    /// Steps of earlier runs, and of this one.
    before: u64,
    made: u64,
    every: u64,
}

impl Recorder {
    /// One that takes nothing yet.
    pub fn new(bar: Progress, films: bool, live: Option<Arc<Live>>, stop: Arc<AtomicBool>) -> Self {
        Self {
            bar,
            film: Arc::default(),
            films,
            live,
            stop,
            born: Instant::now(),
            shown: false,
            before: 0,
            made: 0,
            every: 1,
        }
    }

    /// Whether the film has a place for the step that comes now.
    fn filmed(&self, w: &World) -> bool {
        let done = (w.clock.step - w.clock.first).max(0) as u64;
        self.films && (self.before + done).is_multiple_of(self.every)
    }

    /// What it takes.
    pub fn film(&self) -> Arc<Mutex<Film>> {
        self.film.clone()
    }
}

impl Watch for Recorder {
    fn requested(&mut self, steps: i64) {
        self.bar.requested(steps);
    }

    fn begins(&mut self, w: &World) {
        self.bar.begins();
        self.before += std::mem::take(&mut self.made);
        if let Some(live) = &self.live {
            live.begins(w);
        }
        if !self.films {
            return;
        }
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        // A minimization ends when it has found something.
        film.expect(if w.clock.minimizing { 0 } else { w.clock.last - w.clock.first });
        if film.last().is_none() {
            let frame = taken(w, None);
            film.take(0, frame);
        }
        self.every = film.every();
    }

    fn step(&mut self, made: &Made) {
        self.made = made.done.max(0) as u64;
        self.bar.step(made);
        if let Some(live) = &self.live {
            live.step(made);
        }
    }

    fn looks(&mut self, w: &World) -> bool {
        self.shown = self.live.as_ref().is_some_and(|live| live.looks(&self.stop));
        self.shown || self.filmed(w)
    }

    fn scene(&mut self, w: &World) {
        if let Some(live) = self.live.as_ref().filter(|_| self.shown) {
            live.show(taken(w, None));
        }
        if !self.filmed(w) {
            return;
        }
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        let begin = Instant::now();
        let frame = taken(w, film.last());
        film.take(self.before + self.made, frame);
        film.spend(begin.elapsed(), self.born.elapsed());
        self.every = film.every();
    }
}
