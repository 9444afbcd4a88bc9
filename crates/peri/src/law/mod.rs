//! Laws of bonds: one file for each, and what all of them share.
//!
//! A law is a type with [`BondLaw`], a formula that is written once for single bonds and for lanes of them, and a [`Style`]: what
//! it is like, the numbers that decks give it, its kernels. Scenes choose it by the [table].

mod cauchy;
mod eps;
pub mod formula;
pub mod freed;
pub(crate) mod kernels;
mod lps;
pub mod material;
pub mod moment;
mod nonlinear;
mod plastic;
mod pmb;
pub mod polynomials;
pub mod series;
pub mod settle;
mod shaped;
pub mod site;
mod softening;
pub mod state;
pub mod stretch;
pub mod style;
pub mod table;
pub mod terms;
mod ves;
pub mod weighing;

pub use formula::{Angles, BondLaw};
pub use moment::{COLUMNS, Held, Moment};
pub use stretch::{Ends, Stretch, closed};
pub use style::Style;
pub use table::{
    CAUCHY, EPS, EXPONENTIAL, LAWS, LINEAR, LPS, LawKind, NONLINEAR, PLASTIC, PMB, SHAPED, VES, VES_APART,
};

#[cfg(test)]
mod tests;
