//! Bonded particles: spheres joined by massless beams and springs. Forces and stiffnesses of one bond, and the loop over
//! bonds. Pure functions over numbers and columns, independent of the world, decks and styles.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod beam;
pub mod columns;
pub mod law;
pub mod rotational;
pub mod spring;
pub mod stiffness;
pub mod sweep;
pub mod weibull;

#[cfg(test)]
mod tests_sweep;
