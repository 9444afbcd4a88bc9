//! Bonded particles: spheres joined by massless beams. What one bond does, and the stiffness of a body of them. Pure functions over
//! numbers and columns; knows neither the world nor decks nor styles.

pub mod beam;
pub mod columns;
pub mod law;
pub mod rotational;
pub mod spring;
pub mod stiffness;
pub mod sweep;
pub mod weibull;
