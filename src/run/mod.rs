//! The loops over a sealed plan: steps in time, and minimization.

pub mod guarded;
pub mod minimize;
pub mod staggered;
pub mod verlet;

pub use verlet::{Made, Outcome, Watch, verlet};
