//! What fix insert keeps from step to step.

use perigrain_base::math::rng::ParkMiller;
use perigrain_world::{Numbers, World};

/// What has been inserted, and when it inserts next.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// How many grains.
    pub done: u64,
    /// Their mass [mass].
    pub mass: f64,
    /// The step of the next insertion, if there is one.
    pub next: Option<i64>,
    /// Whether there has been one.
    pub begun: bool,
    /// The random stream.
    pub stream: ParkMiller,
}

impl State {
    /// Of a fix that begins.
    pub fn new(seed: u32) -> Self {
        let mut stream = ParkMiller::new(seed);
        // Numbers after small seeds are small.
        stream.skip(30);
        Self { done: 0, mass: 0.0, next: None, begun: false, stream }
    }

    /// Reads it from the world.
    pub fn load(w: &World, key: Numbers) -> Option<Self> {
        let &[done, mass, next, begun, state, spare] = w.memo.get(key)?.as_slice() else { return None };
        Some(Self {
            done: done as u64,
            mass,
            next: (!next.is_nan()).then_some(next as i64),
            begun: begun != 0.0,
            stream: ParkMiller::resumed([state, spare]),
        })
    }

    /// The step of the next insertion, without the rest of it.
    pub fn next(w: &World, key: Numbers) -> Option<i64> {
        let next = *w.memo.get(key)?.get(2)?;
        (!next.is_nan()).then_some(next as i64)
    }

    /// Keeps it in the world.
    pub fn store(&self, w: &mut World, key: Numbers) {
        let [state, spare] = self.stream.stand();
        let next = self.next.map_or(f64::NAN, |n| n as f64);
        let begun = f64::from(u8::from(self.begun));
        w.memo.insert(key, vec![self.done as f64, self.mass, next, begun, state, spare]);
    }
}
