//! Peridynamic laws: what a bond does, and what engineering moduli mean for it.

mod breaking;
pub mod build;
pub mod calibration;
mod chunk;
mod contact;
mod cut;
pub mod damage;
mod energy;
mod evaluate;
pub mod families;
mod fragile;
mod gather;
pub mod kinematics;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod lanes512;
mod lattice;
mod leads;
mod limit;
pub mod linked;
mod list;
mod list_kernel;
pub mod moduli;
mod pmb;
mod released;
mod rows;
mod single;
mod state;
pub mod stretches;
mod stretching;
mod tables;
mod wide;
