//! Constitutive laws of solids: from the deformation gradient of a site to its stress, with what the site remembers.
//!
//! Pure functions over 3×3 matrices, independent of families, decks, the world and units: any consistent units do. The main
//! type is [`Material`], the main function [`Material::respond`]. Large strains are logarithmic (Hencky): plastic flow needs no
//! rates of stress and no rotations, and a rigid rotation changes nothing.

// Units stand in brackets in doc comments, as [pressure]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod brittle;
mod damage;
mod drucker_prager;
mod elastic;
mod flow;
mod hardening;
mod heat;
mod johnson_cook;
mod logarithmic;
mod material;
pub mod sheet;
mod site;
mod spectral;
mod tensor;

pub use brittle::Brittle;
pub use damage::{Damage, Onset};
pub use drucker_prager::DruckerPrager;
pub use elastic::Elastic;
pub use flow::Flow;
pub use hardening::{Flowing, Hardening};
pub use heat::Heating;
pub use johnson_cook::{FractureStrain, JohnsonCook, Reference};
pub use material::{Law, Material};
pub use site::{Failure, Memory, Moment, Response};
pub use tensor::{Mat3, Sym3};

#[cfg(test)]
mod tests;
