//! The time loop.

pub mod verlet;

pub use verlet::{Outcome, Watch, verlet};
