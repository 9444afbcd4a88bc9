//! Everything a deck can name: pair styles, fixes, computes, regions, dumps, commands.
//!
//! A style is one file and one line in its folder's table. It parses its own words, says what it needs,
//! and hands ops to the step plan when a run is sealed.

pub mod act;
pub mod bond;
mod build;
pub mod command;
pub mod common;
pub mod compute;
pub mod critical;
pub mod dump;
pub mod fix;
pub mod ledger;
pub mod matter;
pub mod molecules;
pub mod near;
pub mod newcomers;
pub mod pair;
pub mod peri_view;
pub mod probe;
pub mod pull;
pub mod rigid_bodies;
pub mod seal;
pub mod step_op;
pub mod stretching;
pub mod surface;
#[cfg(feature = "testing")]
pub mod testing;

pub use act::{ActCx, Flow, Motion, Values};
pub use bond::{BondForce, BondStyle};
pub use build::{BuildCx, Chunking, Names, Shape, Use, UseKind};
pub use command::{Act, CommandStyle};
pub use compute::{Compute, ComputeStyle};
pub use dump::{Dump, DumpStyle};
pub use fix::{Fix, FixStyle};
pub use pair::{Pair, PairStyle, TypePairs};
pub use seal::{PlaceTest, Pull, Reading, SealCx, Text, Wants};

/// What the manual says of a style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doc {
    /// The line to write, as `fix ID group gravity magnitude vector x y z`.
    pub syntax: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// The page's text (Markdown): parameters with units, equations, sources, differences from LAMMPS.
    pub text: &'static str,
    /// A line (or few) that works, shown on the page.
    pub example: &'static str,
}

/// What every registered thing has: a name and a page.
pub trait Style: Sync {
    /// The word in the deck.
    fn name(&self) -> &'static str;
    /// Its page.
    fn doc(&self) -> Doc;
}
