//! Peridynamic laws: what a bond does, and what engineering moduli mean for it.

pub mod families;
pub mod moduli;
