//! Small vectors and matrices, decompositions, random numbers.

pub mod cformat;
pub mod rng;
