//! The foundation of all other crates: messages with spans, numbers, unit systems, and deterministic threads.
//!
//! Main types: [`diag::Diagnostic`], a message with its place in a deck and a remedy; [`math::vec3::Vec3`];
//! [`par::Shared`], a column that parts of a loop write concurrently. The crate depends on no deck, particles
//! or steps.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod base64;
pub mod diag;
pub mod gate;
pub mod letters;
pub mod math;
pub mod memory;
pub mod par;
pub mod stop;
pub mod units;

/// Ranks: several processes that run one deck together.
pub use perigrain_comm as comm;
