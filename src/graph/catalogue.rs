//! Every style there is, by category, under LAMMPS' names for these.

use super::build::DECLARATIONS;
use perigrain_commands::{ANGLE_STYLES, ATOM_STYLES, COMMANDS, RUN_STYLES, SHAPES};
use perigrain_computes::COMPUTES;
use perigrain_dumps::DUMPS;
use perigrain_fixes::FIXES;
use perigrain_pairs::PAIRS;
use perigrain_pairs::bond::BONDS;
use perigrain_styles::Style;
use perigrain_world::Registration;
use perigrain_world::minimizer::MinStyle;

/// Commands of the session and of the cursor through the deck, which stand in no table.
pub const SESSION_COMMANDS: [&str; 26] = [
    "print",
    "log",
    "echo",
    "clear",
    "compat",
    "run",
    "variable",
    "if",
    "jump",
    "label",
    "next",
    "include",
    "quit",
    "suffix",
    "package",
    "write_restart",
    "read_restart",
    "rerun",
    "minimize",
    "shell",
    "info",
    "timer",
    "partition",
    "balance",
    "comm_style",
    "sweep",
];

/// The categories of styles.
pub const CATEGORIES: [&str; 14] = [
    "atom",
    "integrate",
    "minimize",
    "pair",
    "bond",
    "angle",
    "dihedral",
    "improper",
    "kspace",
    "fix",
    "compute",
    "region",
    "dump",
    "command",
];

/// The styles of a category; `None` if there is no such category.
pub fn styles(category: &str) -> Option<Vec<&'static str>> {
    Some(match category {
        "atom" => ATOM_STYLES.to_vec(),
        "integrate" => RUN_STYLES.to_vec(),
        "minimize" => MinStyle::ALL.map(|(name, _)| name).to_vec(),
        "pair" => PAIRS.iter().map(|s| s.name()).collect(),
        "bond" => BONDS.iter().map(|s| s.name()).collect(),
        "angle" => ANGLE_STYLES.to_vec(),
        // Forces between three and more particles, and electric ones, do not exist here.
        "dihedral" | "improper" | "kspace" => vec![],
        "fix" => FIXES.iter().map(|s| s.name()).collect(),
        "compute" => COMPUTES.iter().map(|s| s.name()).collect(),
        "region" => SHAPES.iter().map(|(name, _)| *name).collect(),
        "dump" => DUMPS.iter().map(|s| s.name()).collect(),
        "command" => COMMANDS.iter().map(|s| s.name()).chain(DECLARATIONS).chain(SESSION_COMMANDS).collect(),
        _ => return None,
    })
}

/// State of all styles that has a role for others or that a motion of matter changes.
pub fn registrations() -> impl Iterator<Item = &'static Registration> + Clone {
    fn of<S: Style + ?Sized>(
        table: &'static [&'static S],
    ) -> impl Iterator<Item = &'static Registration> + Clone {
        table.iter().flat_map(|style| style.registrations()).copied()
    }
    of(FIXES).chain(of(COMPUTES)).chain(of(DUMPS)).chain(of(PAIRS)).chain(of(BONDS)).chain(of(COMMANDS))
}
