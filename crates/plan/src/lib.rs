//! The step as data: ops with stages, reads, writes and times; and the loops over steps.
//!
//! The main types: [`Op`], one thing a step does; [`StepPlan`], the ops of a run in order; [`Tick`], the present step as ops see
//! it. This crate knows no style and no deck.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod acts;
mod ending;
pub mod explain;
pub mod fuse;
pub mod guard;
mod level;
pub mod meter;
pub mod needs;
pub mod op;
pub mod run;
pub mod schedule;
pub mod share;
mod step;

pub use acts::{Acts, Beside, BlockSums, ParticleBlock, Pull, Room};
pub use fuse::{FusedPass, fuse};
pub use guard::{Energy, Guard, Rule};
pub use level::{Level, Phase, Solids};
pub use meter::Meter;
pub use needs::Needs;
pub use op::{About, Op, OpClass, Stage, Tick, Way, When};
pub use schedule::{LeftOut, Placed, StepPlan};
pub use share::Span;
