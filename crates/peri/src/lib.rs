//! Peridynamic solids: their bonds (families), what a bond does, and what engineering moduli mean for it.
//!
//! The types that matter most: [`families::Families`], the bonds of a scene; [`families::PeriView`], the columns of particles they
//! look at; [`families::Law`]. It knows no deck, no units and no other forces.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

mod advance;
mod breaking;
pub mod calibration;
mod cauchy;
pub mod conduction;
mod contact;
pub mod criteria;
mod cut;
pub mod damage;
mod energy;
mod evaluate;
pub mod families;
pub mod kinematics;
mod lattice;
pub mod law;
mod limit;
pub mod linked;
mod list;
mod load_ratio;
mod measured;
pub mod moduli;
mod pass;
mod pulled;
mod released;
mod seen;
pub use cauchy::stress;
pub mod setup;
pub mod shares;
pub mod stretches;
