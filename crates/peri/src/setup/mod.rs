//! Who belongs to whose peridynamic family, and who comes close without belonging.

pub mod detect;
mod joined;
pub mod lattice;
pub mod list;
pub mod near;
pub mod sites;
pub mod spacing;
pub mod wear;
pub mod weights;
