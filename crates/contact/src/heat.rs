//! Heat conduction through the contact area.

use super::normal::geometric;
use perigrain_base::math::real::Real;

/// Heat conduction models.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Heat {
    /// `none`.
    #[default]
    None,
    /// `area h`: h π a², h [energy/(time area temperature)].
    Area(f64),
    /// `radius k`: 2 k a, with conductivity k [energy/(time length temperature)] (constriction in a
    /// half-space).
    Radius(f64),
}

impl Heat {
    /// The word in decks.
    pub fn name(&self) -> &'static str {
        match self {
            Heat::None => "none",
            Heat::Area(_) => "area",
            Heat::Radius(_) => "radius",
        }
    }

    /// The model between two types whose models are of one kind.
    pub fn mixed(&self, other: &Heat) -> Heat {
        match (*self, *other) {
            (Heat::Area(a), Heat::Area(b)) => Heat::Area(geometric(a, b)),
            (Heat::Radius(a), Heat::Radius(b)) => Heat::Radius(geometric(a, b)),
            _ => Heat::None,
        }
    }

    /// Heat flow per temperature difference for contact radius `a` [energy/(time temperature)].
    #[inline(always)]
    pub fn conductance<R: Real>(&self, a: R) -> R {
        match *self {
            Heat::None => a.like(0.0),
            Heat::Area(h) => a * (h * std::f64::consts::PI) * a,
            Heat::Radius(k) => a * (2.0 * k),
        }
    }
}
