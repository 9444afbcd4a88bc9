//! Conduction of heat through the area of contact.

use super::normal::geometric;
use perigrain_base::math::real::Real;

/// How much heat flows for a difference of temperatures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Heat {
    /// `none`.
    #[default]
    None,
    /// `area h`: h π a², h [energy/(time area temperature)].
    Area(f64),
    /// `radius k`: 2 k a, k the conductivity [energy/(time length temperature)] (constriction in a half-space).
    Radius(f64),
}

impl Heat {
    /// The word decks use.
    pub fn name(&self) -> &'static str {
        match self {
            Heat::None => "none",
            Heat::Area(_) => "area",
            Heat::Radius(_) => "radius",
        }
    }

    /// For a pair of types with models of one kind.
    pub fn mixed(&self, other: &Heat) -> Heat {
        match (*self, *other) {
            (Heat::Area(a), Heat::Area(b)) => Heat::Area(geometric(a, b)),
            (Heat::Radius(a), Heat::Radius(b)) => Heat::Radius(geometric(a, b)),
            _ => Heat::None,
        }
    }

    /// Heat flow over difference of temperatures for a contact of radius `a` [energy/(time temperature)].
    #[inline(always)]
    pub fn conductance<R: Real>(&self, a: R) -> R {
        match *self {
            Heat::None => a.like(0.0),
            Heat::Area(h) => a * (h * std::f64::consts::PI) * a,
            Heat::Radius(k) => a * (2.0 * k),
        }
    }
}
