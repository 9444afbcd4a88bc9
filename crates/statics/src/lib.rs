//! Quasi-static solution: equilibria of bodies under held ends, loads and periodic strains, and what follows from their
//! stiffness. Pure functions over numbers and columns, independent of the world, decks and styles.
//!
//! - [`network`] is a body's tangent: bonds as columns and their response to motions of the particles; [`contacts`] and
//!   [`walls`] add what touches. [`pairs`] sums over them with the same bits for any number of threads.
//! - [`pcg`] solves a linear system ([`minres`] one that is not definite), with block Jacobi ([`precond`]) or clusters that move rigidly ([`coarse`]);
//!   [`newton`] solves with contacts that open and close, [`load_steps`] along a path with slip.
//! - [`dsm`] (between ends), [`periodic`] (a cell), [`strength`] (bond after bond) and [`ste`] (a closed formula) are the
//!   methods, [`certificate`] a lower bound, [`energy_shares`] the sensitivities, [`stable_step`] the limit of a run.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod certificate;
pub mod coarse;
pub mod contact;
pub mod contacts;
pub mod dsm;
pub mod ends;
pub mod energy_shares;
pub mod load_steps;
pub mod minres;
pub mod network;
pub mod newton;
pub mod pairs;
pub mod pcg;
pub mod periodic;
pub mod precond;
pub mod six;
pub mod stable_step;
pub mod ste;
pub mod strength;
pub mod tensor;
pub mod walls;

#[cfg(test)]
mod lattices;
#[cfg(test)]
mod tests_coarse;
#[cfg(test)]
mod tests_contacts;
#[cfg(test)]
mod tests_large;
#[cfg(test)]
mod tests_statics;
#[cfg(test)]
mod tests_strength;
#[cfg(test)]
mod tests_tensors;
