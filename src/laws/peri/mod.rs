//! Peridynamic laws: what a bond does, and what engineering moduli mean for it.

mod breaking;
mod chunk;
mod contact;
pub mod damage;
mod energy;
pub mod families;
mod lanes;
mod lattice;
mod list;
pub mod moduli;
mod pmb;
