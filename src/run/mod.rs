//! The time loop.

pub mod verlet;

pub use verlet::{Made, Outcome, Watch, verlet};
