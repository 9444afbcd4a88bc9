//! Small vectors and matrices, decompositions, random numbers.

pub mod angle;
pub mod body;
pub mod cell;
pub mod cformat;
#[cfg(target_arch = "x86_64")]
mod eight;
pub mod elementary;
pub mod forest;
pub mod form;
pub mod four;
pub mod lanczos;
pub mod lanes;
pub mod pair;
pub mod periods;
pub mod real;
pub mod rng;
pub mod scatter;
pub mod threes;
pub mod triangle;
pub mod twice;
pub mod vec3;
