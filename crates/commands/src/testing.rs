//! Lines of a deck acted on a bare world, for the tests of the commands of this crate.

use super::COMMANDS;
use perigrain_base::diag::Result;
use perigrain_styles::testing::lines;
pub use perigrain_styles::testing::lines::AtomVariable;
use perigrain_world::World;

/// Executes one line on the world; returns its log lines.
pub fn act(world: &mut World, line: &str, variables: &[AtomVariable]) -> Result<Vec<String>> {
    lines::act(COMMANDS, world, line, variables)
}

/// The world after these lines, each of which must work.
pub fn scene(text: &str) -> World {
    lines::scene(COMMANDS, text)
}

/// Acts further lines, each of which must work.
pub fn more(world: &mut World, text: &str) {
    lines::more(COMMANDS, world, text);
}

/// The word that is to blame in a line that must fail, and the message.
pub fn refused(world: &World, line: &str) -> (String, String) {
    lines::refused(COMMANDS, world, line)
}
