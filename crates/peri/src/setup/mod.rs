//! Which particles belong to which peridynamic families, and which come close without belonging.

pub mod detect;
mod joined;
pub mod lattice;
pub mod list;
pub mod near;
pub mod sites;
pub mod spacing;
pub mod wear;
pub mod weights;
