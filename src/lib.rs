//! perigrain: LAMMPS-style input decks for fracture, erosion, grains and agglomerates.
//!
//! The data's way, each arrow named by the type that carries it:
//!
//! ```text
//! source text          diag::Sources        bytes + file name
//!  │  lang::lex, lang::flow, lang::vars
//!  ▼
//! commands             lang::Command        words with byte spans
//!  │  graph::build
//!  ▼
//! command graph        graph::Graph         declare, act and run nodes with edges "uses"
//!  │  acts change the world; graph::seal turns declarations into ops
//!  ▼
//! world + step plan    world::World, plan::StepPlan
//!  │  run::verlet
//!  ▼
//! outputs              output::*            thermo, dumps, pictures
//! ```

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod bench;
pub mod cli;
pub mod graph;
mod heads;
mod human;
mod json;
pub mod lsp;
pub mod manual;
pub mod plot;
mod processes;
pub mod report;
pub mod session;
pub mod sweep;
pub mod verify;

pub use perigrain_base::{diag, math, par, units};
pub use perigrain_lang as lang;
pub use perigrain_output as output;
pub use perigrain_peri as peri;
pub use perigrain_plan as plan;
pub use perigrain_world as world;

/// Everything a deck can name, by kind.
pub mod styles {
    pub use perigrain_commands as command;
    pub use perigrain_computes as compute;
    pub use perigrain_dumps as dump;
    pub use perigrain_fixes as fix;
    pub use perigrain_pairs as pair;
    pub use perigrain_pairs::bond;
    pub use perigrain_styles::*;
}
