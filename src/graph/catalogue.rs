//! Every style there is, by category, under LAMMPS' names for these.

use perigrain_commands::{ANGLE_STYLES, ATOM_STYLES, COMMANDS, RUN_STYLES, SHAPES};
use perigrain_computes::COMPUTES;
use perigrain_dumps::DUMPS;
use perigrain_fixes::FIXES;
use perigrain_pairs::PAIRS;
use perigrain_pairs::bond::BONDS;
use perigrain_styles::{BondStyle, CommandStyle, ComputeStyle, DumpStyle, FixStyle, PairStyle, Style};
use perigrain_world::Registration;
use perigrain_world::minimizer::MinStyle;

/// The commands that declare.
pub const DECLARATIONS: [&str; 20] = [
    "bond_style",
    "bond_coeff",
    "pair_style",
    "pair_coeff",
    "pair_modify",
    "peri_modify",
    "fix",
    "unfix",
    "fix_modify",
    "compute",
    "uncompute",
    "compute_modify",
    "dump",
    "undump",
    "dump_modify",
    "thermo",
    "thermo_style",
    "thermo_modify",
    "restart",
    "write_dump",
];

/// Commands of the session and of the cursor through the deck, which stand in no table.
pub const SESSION_COMMANDS: [&str; 28] = [
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
    "statics",
    "fatigue",
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

/// The styles that decks of a session can name, a table for each kind: the program's own by default, to which a host program
/// can add before the session starts. The manual and the sub-styles of `hybrid` are those of the program.
#[derive(Clone)]
pub struct Tables {
    /// Of `pair_style`.
    pub pairs: Vec<&'static dyn PairStyle>,
    /// Of `bond_style`.
    pub bonds: Vec<&'static dyn BondStyle>,
    /// Of `fix`.
    pub fixes: Vec<&'static dyn FixStyle>,
    /// Of `compute`.
    pub computes: Vec<&'static dyn ComputeStyle>,
    /// Of `dump`.
    pub dumps: Vec<&'static dyn DumpStyle>,
    /// Commands that act on the scene.
    pub commands: Vec<&'static dyn CommandStyle>,
}

impl Default for Tables {
    fn default() -> Self {
        Self {
            pairs: PAIRS.to_vec(),
            bonds: BONDS.to_vec(),
            fixes: FIXES.to_vec(),
            computes: COMPUTES.to_vec(),
            dumps: DUMPS.to_vec(),
            commands: [COMMANDS, perigrain_calibrate::COMMANDS].concat(),
        }
    }
}

impl Tables {
    /// The command of this name that acts on the scene.
    pub fn command(&self, name: &str) -> Option<&'static dyn CommandStyle> {
        self.commands.iter().copied().find(|c| c.name() == name)
    }

    /// The names of a category, those that no table has included; `None` if there is no such category.
    pub fn names(&self, category: &str) -> Option<Vec<&'static str>> {
        Some(match category {
            "atom" => ATOM_STYLES.to_vec(),
            "integrate" => RUN_STYLES.to_vec(),
            "minimize" => MinStyle::ALL.map(|(name, _)| name).to_vec(),
            "pair" => names(&self.pairs).collect(),
            "bond" => names(&self.bonds).collect(),
            "angle" => ANGLE_STYLES.to_vec(),
            // Forces between three and more particles, and electric ones, do not exist here.
            "dihedral" | "improper" | "kspace" => vec![],
            "fix" => names(&self.fixes).collect(),
            "compute" => names(&self.computes).collect(),
            "region" => SHAPES.iter().map(|(name, _)| *name).collect(),
            "dump" => names(&self.dumps).collect(),
            "command" => names(&self.commands).chain(DECLARATIONS).chain(SESSION_COMMANDS).collect(),
            _ => return None,
        })
    }

    /// State of all styles that has a role for others or that a motion of matter changes.
    pub fn registrations(&self) -> impl Iterator<Item = &'static Registration> + Clone {
        fn of<S: Style + ?Sized>(
            table: &[&'static S],
        ) -> impl Iterator<Item = &'static Registration> + Clone {
            table.iter().flat_map(|style| style.registrations()).copied()
        }
        let forces = of(&self.pairs).chain(of(&self.bonds));
        of(&self.fixes)
            .chain(of(&self.computes))
            .chain(of(&self.dumps))
            .chain(forces)
            .chain(of(&self.commands))
    }
}

fn names<S: Style + ?Sized>(table: &[&'static S]) -> impl Iterator<Item = &'static str> {
    table.iter().map(|s| s.name())
}
