//! The state that the run and the reader of its page share.

use crate::json::quoted;
use crate::report::film::{Frame, taken};
use crate::session::Made;
use perigrain_world::World;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A reader without a request for so long is gone.
const GONE: Duration = Duration::from_secs(4);

/// The reader's request to the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Wish {
    #[default]
    Go,
    /// Make this step, show it, and wait.
    Pause,
    /// Wait before the next step.
    Wait,
    Stop,
}

/// Shared by the run and the page.
#[derive(Default)]
pub struct Live {
    wish: Mutex<Wish>,
    changed: Condvar,
    /// A reader would like to see the particles.
    wanted: AtomicBool,
    /// The latest snapshot and its number, from 1.
    latest: Mutex<(usize, Option<Arc<Frame>>)>,
    done: AtomicU64,
    total: AtomicU64,
    /// Whether a run is in progress, and whether the deck is over.
    running: AtomicBool,
    over: AtomicBool,
    /// The reader knows that it is over, and has all of it.
    end_seen: AtomicBool,
    heard: Mutex<Option<Instant>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Live {
    /// Notes a request of a reader.
    pub fn heard(&self) {
        *lock(&self.heard) = Some(Instant::now());
    }

    /// Performs a reader's request; `false` if it is unknown.
    pub fn act(&self, path: &str) -> bool {
        let mut wish = lock(&self.wish);
        *wish = match (path, *wish) {
            ("/go", _) => Wish::Go,
            // A step is one that is shown and waited after.
            ("/pause", Wish::Wait) => Wish::Wait,
            ("/pause" | "/step", _) => Wish::Pause,
            ("/stop", _) => Wish::Stop,
            _ => return false,
        };
        self.changed.notify_all();
        true
    }

    /// The latest snapshot if it is a newer one; the next step is shown otherwise.
    pub fn frame(&self, since: usize) -> Option<(usize, Arc<Frame>)> {
        let latest = lock(&self.latest);
        let newer = latest.1.clone().filter(|_| latest.0 > since);
        if newer.is_none() {
            self.wanted.store(true, Ordering::Relaxed);
            self.end_seen.fetch_or(self.over.load(Ordering::Relaxed), Ordering::Relaxed);
        }
        newer.map(|frame| (latest.0, frame))
    }

    /// Where the run stands, as members of a JSON object.
    pub fn state_json(&self) -> String {
        let get = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
        let status = match *lock(&self.wish) {
            _ if get(&self.over) => "over",
            _ if !get(&self.running) => "waiting",
            Wish::Go => "running",
            Wish::Stop => "stopping",
            Wish::Pause | Wish::Wait => "paused",
        };
        let (done, total) = (self.done.load(Ordering::Relaxed), self.total.load(Ordering::Relaxed));
        format!("\"status\":{},\"done\":{done},\"total\":{total}", quoted(status))
    }

    /// A run begins.
    pub fn begins(&self, w: &World) {
        self.running.store(true, Ordering::Relaxed);
        self.total.store((w.clock.last - w.clock.first).max(0) as u64, Ordering::Relaxed);
        self.show(taken(w, None));
    }

    /// A step is made.
    pub fn step(&self, made: &Made) {
        self.done.store(made.done.max(0) as u64, Ordering::Relaxed);
        if made.done >= made.total {
            self.running.store(false, Ordering::Relaxed);
        }
    }

    /// Whether the reader requests the next step. While the run is paused, it waits here.
    pub fn looks(&self, stop: &AtomicBool) -> bool {
        let mut wish = lock(&self.wish);
        loop {
            match *wish {
                Wish::Go => return self.wanted.load(Ordering::Relaxed),
                Wish::Pause => {
                    *wish = Wish::Wait;
                    return true;
                }
                Wish::Stop => {
                    stop.store(true, Ordering::Relaxed);
                    return false;
                }
                // Ctrl-C ends the wait, too.
                Wish::Wait if stop.load(Ordering::Relaxed) => return false,
                Wish::Wait => {
                    let wait = self.changed.wait_timeout(wish, Duration::from_millis(100));
                    wish = wait.unwrap_or_else(PoisonError::into_inner).0;
                }
            }
        }
    }

    /// A snapshot for the reader.
    pub fn show(&self, frame: Frame) {
        self.wanted.store(false, Ordering::Relaxed);
        let mut latest = lock(&self.latest);
        *latest = (latest.0 + 1, Some(Arc::new(frame)));
    }

    /// The deck is over.
    pub fn end(&self, last: Frame) {
        self.show(last);
        self.over.store(true, Ordering::Relaxed);
    }

    /// Whether there is a reader and the end has not been shown yet.
    pub fn is_awaited(&self) -> bool {
        !self.end_seen.load(Ordering::Relaxed) && lock(&self.heard).is_some_and(|t| t.elapsed() < GONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_pauses_steps_continues_and_stops() {
        let (live, stop) = (Live::default(), AtomicBool::new(false));
        assert!(!live.looks(&stop), "there is no reader");
        assert_eq!(live.frame(0).map(|f| f.0), None);
        assert!(live.looks(&stop), "a snapshot has been requested");
        assert!(!live.act("/dance") && live.act("/pause"));
        assert!(live.looks(&stop), "the step before the pause is shown");
        std::thread::scope(|s| {
            let step = s.spawn(|| live.looks(&stop));
            std::thread::sleep(Duration::from_millis(20));
            assert!(!step.is_finished(), "it waits");
            live.act("/step");
            assert!(step.join().unwrap(), "one step is made and shown");
            let rest = s.spawn(|| live.looks(&stop));
            live.act("/stop");
            assert!(!rest.join().unwrap() && stop.load(Ordering::Relaxed));
        });
    }
}
