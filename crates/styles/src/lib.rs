//! What all styles that a deck can name have in common, and what styles of several kinds need.
//!
//! A style is one file and one line in the table of its crate. It parses its own words, declares what it needs, and hands ops to
//! the step plan when a run is sealed. The main types: [`Style`] with one trait for each kind ([`Fix`], [`Pair`], [`Compute`],
//! [`Dump`], [`CommandStyle`]); [`BuildCx`], the scene as a line sees it while it is read; [`SealCx`], the scene while a run is
//! sealed. This crate knows no style by name.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

// What `derive(Words)` writes names this crate as others do.
extern crate self as perigrain_styles;

pub mod act;
pub mod bond;
mod build;
pub mod command;
pub mod common;
pub mod compute;
pub mod critical;
pub mod dump;
pub mod fix;
pub mod lammps;
pub mod ledger;
pub mod matter;
pub mod mesh_surface;
pub mod molecules;
pub mod near;
pub mod newcomers;
pub mod pair;
pub mod peri_view;
pub mod pressed;
pub mod probe;
pub mod pull;
pub mod rigid_bodies;
pub mod seal;
pub mod step_op;
pub mod stretching;
pub mod surface;
#[cfg(feature = "testing")]
pub mod testing;
pub mod triangles;
pub mod words;

pub use act::{ActCx, Flow, Motion, Values};
pub use bond::{BondForce, BondStyle};
pub use build::{Bins, BuildCx, Chunking, Names, Shape, Use, UseKind};
pub use command::{Act, CommandStyle};
pub use compute::{Compute, ComputeStyle};
pub use dump::{Dump, DumpStyle};
pub use fix::{Fix, FixStyle};
pub use pair::{Pair, PairStyle, TypePairs};
pub use seal::{BondFormula, FORMULAS, Gravity, PlaceTest, Pull, Reading, SealCx, Text, Wants};

use perigrain_world::Registration;

/// What the manual says of a style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doc {
    /// The lines to write.
    pub syntax: words::Syntax,
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
    /// Its state that has a role for other styles or that a motion of matter changes: of several names that fit the first one counts.
    fn registrations(&self) -> &'static [&'static Registration] {
        &[]
    }
}
