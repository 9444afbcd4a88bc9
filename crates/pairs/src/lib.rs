//! Forces between particles: pair styles, bond styles and the words of contact models, one line each in [`PAIRS`] and
//! [`bond::BONDS`].
//!
//! They connect the kernels of `peri` and `contact` to decks; this crate knows no fix and no compute.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod bond;
mod bpm_peri;
mod bpm_spring;
mod central;
pub mod contact;
pub mod contact_probe;
mod gran_hertz_history;
mod gran_hooke;
mod gran_hooke_history;
mod granular;
mod hybrid;
pub mod peri;
mod shared;
mod soft;
mod zero;

pub use granular::declared::GRANULAR_RULES;
pub use granular::force::TILES;
pub use granular::mdr::PLASTIC_GRAIN;
pub use granular::ranks::DEEP;
pub use shared::FROZEN;

pub use perigrain_styles::pair::{ByPart, Deck, Facts, Mix, Pair, PairOption, PairStyle, Scales, TypePairs};
pub use perigrain_styles::probe;

/// Every pair style.
#[rustfmt::skip]
pub const PAIRS: &[&dyn PairStyle] = &[
    &bpm_peri::BpmPeriStyle,
    &bpm_spring::BpmSpringStyle,
    &gran_hertz_history::GranHertzHistory,
    &gran_hooke::GranHooke,
    &gran_hooke_history::GranHookeHistory,
    &granular::GranularStyle,
    &hybrid::Hybrid,
    &hybrid::Overlay,
    &peri::PeriCauchy,
    &peri::PeriEps,
    &peri::PeriLps,
    &peri::PeriPmb,
    &peri::PeriPmbPlastic,
    &peri::PeriPmbSoftening,
    &peri::PeriVes,
    &soft::SoftStyle,
    &zero::ZeroStyle,
];
