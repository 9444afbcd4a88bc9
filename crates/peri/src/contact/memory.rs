//! What short-range contact keeps between steps: rows of near pairs, and room for what is in hand.

use std::sync::Mutex;

use crate::contact::hits::Hits;
use crate::contact::near::Near;

/// Memory of the search and of what is in hand.
#[derive(Debug, Default)]
pub struct Memory {
    /// Near pairs as rows: those of a body, and those across bodies.
    pub near: [Near; 2],
    /// Of each thread.
    pub(super) hits: Vec<Mutex<Hits>>,
    pub(super) close: Close,
    pub(super) pressed: Vec<Pressed>,
    /// Of [`Rules`](crate::contact::hits::Rules).
    pub(super) stiff: Vec<f64>,
}

impl Memory {
    /// Forgets pairs: those that may touch are others, or touch at other distances.
    pub fn forget(&mut self) {
        self.near.iter_mut().for_each(Near::clear);
        self.close.clear();
    }

    /// Forgets rows of one rank's particles: others are its own now.
    pub fn forget_own(&mut self) {
        self.near.iter_mut().filter(|near| near.narrow).for_each(Near::clear);
    }

    /// Memory held by rows.
    pub fn bytes(&self) -> usize {
        self.near.iter().map(Near::bytes).sum()
    }
}

/// What does not change from step to step of the bonds of a list that can come into contact, as [`crate::families::list::ListBody::close`] has them.
#[derive(Debug, Default)]
pub struct Close {
    /// Their particles, the one of lower number first.
    pub(super) ends: Vec<[u32; 2]>,
    /// The distances at which these touch.
    pub(super) contact: Vec<f64>,
}

impl Close {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.ends.clear();
        self.contact.clear();
    }
}

/// The pairs of one part, the particle of lower number first.
#[derive(Debug, Default)]
pub struct Pressed {
    pub(super) hits: Hits,
    pub(super) ends: Vec<[u32; 2]>,
}
