//! A watch over the energy of a run: the error it allows, and what happens beyond that.

use super::When;
use perigrain_base::diag::Result;
use perigrain_world::World;

/// Reads the world's energy.
pub type Look = Box<dyn FnMut(&World) -> Result<Energy> + Send>;

/// Writes a line to the log.
pub type WriteLine = Box<dyn FnMut(&str) -> Result<()> + Send>;

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

/// What error is allowed and what happens beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Steps per block.
    pub every: i64,
    /// The largest change of the residual in a block, relative to what is held, that passes.
    pub tolerance: f64,
    /// The factor for the step size of a bad block.
    pub shrink: f64,
    /// The shortest step [time].
    pub shortest: f64,
    /// After this many good blocks the step becomes longer again, up to the deck's; 0: never.
    pub recover: i64,
}

/// A guard over a run.
pub struct Guard {
    /// Its name.
    pub name: String,
    /// Its rule.
    pub rule: Rule,
    /// The steps at which it checks the energy: the ends of blocks, and wherever outputs are made.
    pub when: When,
    /// Reads the energy.
    pub look: Look,
    /// Writes a line.
    pub write_line: WriteLine,
}
