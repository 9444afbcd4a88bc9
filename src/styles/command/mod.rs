//! Commands that act on the world once, in order.

mod material;

use super::{ActCx, BuildCx, Style};
use crate::diag::Result;
use crate::lang::Args;

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

    /// Which facts of the scene it settles (`volume`, `density`, `mass`, `diameter`, `velocity` …), for checks.
    fn settles(&self) -> &'static [&'static str] {
        &[]
    }
}

/// Every command that acts.
pub const COMMANDS: &[&dyn CommandStyle] = &[&material::MaterialStyle];
