//! Granular models as decks write them: shared by pair styles and walls.

pub mod classic;
pub mod durations;
mod models;
mod sliding;
mod sticking;
mod turning;
pub mod words;

use perigrain_base::diag::Span;
use perigrain_contact::Model;
use perigrain_contact::driver::{Average, Curvature};

/// Coefficients of one `pair_coeff` line for its pairs of types, or of a wall for its contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coeff {
    /// The models.
    pub model: Model,
    /// The same with the material of the second type, if that is another one, and the place of its words.
    pub other: Option<(Model, Span)>,
    /// Sharing among simultaneous contacts.
    pub average: Average,
    /// Effective radius.
    pub curvature: Curvature,
    /// The explicit reach of the neighbour list [length].
    pub cutoff: Option<f64>,
    /// The word with the normal model, for messages.
    pub span: Span,
}
