//! A watch over the energy of a run: how far it may be off, and what happens when it is.

use super::When;
use perigrain_base::diag::Result;
use perigrain_world::World;

/// Reads the world's energy.
pub type Look = Box<dyn FnMut(&World) -> Result<Energy> + Send>;

/// Says a line in the log.
pub type Say = Box<dyn FnMut(&str) -> Result<()> + Send>;

/// The energy of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// What is missing (the ledger's residual).
    pub residual: f64,
    /// What is held.
    pub held: f64,
    /// What has gone in and out so far.
    pub turnover: f64,
}

/// What may be off and what to do then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Steps per block.
    pub every: i64,
    /// The change of the residual in a block, over what is held, that is still good.
    pub tolerance: f64,
    /// What a bad block's step is multiplied with.
    pub shrink: f64,
    /// The shortest step [time].
    pub shortest: f64,
    /// After so many good blocks the step becomes longer again, up to the deck's; never for 0.
    pub recover: i64,
}

/// A guard over a run.
pub struct Guard {
    /// What it is called.
    pub name: String,
    /// Its rule.
    pub rule: Rule,
    /// At which steps it looks: the ends of blocks, and wherever outputs are made.
    pub when: When,
    /// Reads the energy.
    pub look: Look,
    /// Says a line.
    pub say: Say,
}
