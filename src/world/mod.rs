//! The state of a scene: everything that outlives a step, and nothing that decides.

pub mod material;
pub mod potentials;
