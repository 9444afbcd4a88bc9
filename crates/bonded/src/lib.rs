//! Bonded particles: spheres joined by massless beams. Forces of one bond, and the stiffness of bonded
//! bodies. Pure functions over numbers and columns, independent of the world, decks and styles.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod beam;
pub mod certificate;
pub mod coarse;
pub mod columns;
pub mod contact;
pub mod contacts;
pub mod dsm;
pub mod ends;
pub mod law;
pub mod limit;
pub mod network;
pub mod newton;
pub mod pairs;
pub mod parts;
pub mod pcg;
pub mod periodic;
pub mod precond;
pub mod rotational;
pub mod shares;
pub mod six;
pub mod spring;
pub mod ste;
pub mod stiffness;
pub mod strength;
pub mod sweep;
pub mod tensor;
pub mod walls;
pub mod weibull;

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
mod tests_sweep;
#[cfg(test)]
mod tests_tensors;
