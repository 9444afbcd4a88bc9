//! Peridynamic laws: what a bond does, and what engineering moduli mean for it.

mod breaking;
mod chunk;
mod contact;
pub mod damage;
mod energy;
pub mod families;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes512;
mod lattice;
mod list;
pub mod moduli;
mod pmb;
mod stretching;
