//! One of several partitions that work the same deck off beside each other, and how they share values out.

use std::sync::Arc;

/// Takes the next turn of a round, given the round, counted from 0.
pub type Turn = Arc<dyn Fn(u64) -> std::io::Result<usize> + Send + Sync>;

/// Which of several partitions runs the deck.
#[derive(Clone)]
pub struct Partition {
    /// Its number, from 0.
    pub number: usize,
    /// How many there are.
    pub of: usize,
    /// Hands out the free turns of universe and uloop variables, each once.
    pub turn: Turn,
    /// Rounds of such variables that have been begun.
    pub(super) rounds: u64,
}

impl Partition {
    /// A partition that has taken no turn yet.
    pub fn new(number: usize, of: usize, turn: Turn) -> Self {
        Self { number, of, turn, rounds: 0 }
    }
}

impl std::fmt::Debug for Partition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "partition {} of {}", self.number + 1, self.of)
    }
}
