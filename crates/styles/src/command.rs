//! What a command is: a style that reads its line, and what the line will do.

use super::{ActCx, BuildCx, Compute, Style};
use perigrain_base::diag::Result;
use perigrain_lang::Args;

/// A command: one file, one line in `COMMANDS`.
pub trait CommandStyle: Style {
    /// Reads the line's words completely and checks them; changes nothing.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn parse(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>>;
}

/// What a read line will do to the world.
pub trait Act {
    /// Does it. Either all of it happens or, on an error, nothing.
    ///
    /// # Errors
    /// What can only be known with the particles at hand.
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()>;

    /// Whether it makes or needs particles: such acts are skipped by `perigrain check`.
    fn needs_particles(&self) -> bool {
        true
    }

    /// Whether forces and energies of the last run are still those of the scene: it only names something new.
    fn leaves_forces(&self) -> bool {
        false
    }

    /// The group it makes if there is none of this name: a check may count on it although nothing acts.
    fn makes_group(&self) -> Option<&str> {
        None
    }

    /// What it leaves behind for formulas to read as `c_ID`, with its ID; a check counts on it although nothing acts.
    fn leaves(&self) -> Option<(String, Box<dyn Compute>)> {
        None
    }

    /// Which facts of the scene it settles (`volume`, `density`, `mass`, `diameter`, `velocity` …), for checks.
    fn settles(&self) -> Vec<&'static str> {
        vec![]
    }
}
