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
//! outputs              out::*               thermo, dumps, pictures
//! ```

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod cli;
pub mod diag;
pub mod graph;
pub mod lang;
pub mod laws;
pub mod math;
pub mod neigh;
pub mod out;
pub mod par;
pub mod plan;
pub mod run;
pub mod session;
pub mod styles;
pub mod units;
pub mod world;
