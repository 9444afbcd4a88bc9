//! What every other crate stands on: messages with places, numbers, unit systems, threads with the same bits for any number of them.
//!
//! The three types that matter most: [`diag::Diagnostic`], a message with its place in a deck and what to write instead;
//! [`math::vec3::Vec3`]; [`par::Shared`], a column that parts of a loop write side by side. It knows no deck, no particles and no step.

// Units stand in brackets in doc comments, as [length]; they are no links.
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
