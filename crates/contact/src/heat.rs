//! Heat conduction through the contact area.

use super::Geometry;
use super::cohesion::circle;
use super::normal::geometric;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

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
    /// `contact k`: 2 k √A, A the area of contact. Grains of conductivities k_i and k_j have k = 2 k_i k_j/(k_i + k_j)
    /// (LIGGGHTS manual, fix heat/gran/conduction).
    Contact {
        /// k [energy/(time length temperature)].
        conductivity: f64,
        /// A.
        area: Area,
    },
}

/// The area of contact of `heat contact`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Area {
    /// The circle in which the spheres intersect, after δ is multiplied by this factor.
    Overlap(f64),
    /// `projection`: π times the square of the larger radius; on walls the circle (measured with LIGGGHTS 3.8.0).
    Projection,
    /// `constant A`; on walls the circle (measured with LIGGGHTS 3.8.0).
    Constant(f64),
}

impl Heat {
    /// The word in decks.
    pub fn name(&self) -> &'static str {
        match self {
            Heat::None => "none",
            Heat::Area(_) => "area",
            Heat::Radius(_) => "radius",
            Heat::Contact { .. } => "contact",
        }
    }

    /// The model between two types whose models are of one kind.
    pub fn mixed(&self, other: &Heat) -> Heat {
        match (*self, *other) {
            (Heat::Area(a), Heat::Area(b)) => Heat::Area(geometric(a, b)),
            (Heat::Radius(a), Heat::Radius(b)) => Heat::Radius(geometric(a, b)),
            (Heat::Contact { conductivity: a, area }, Heat::Contact { conductivity: b, .. }) => {
                let conductivity = if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
                Heat::Contact { conductivity, area }
            }
            _ => Heat::None,
        }
    }

    /// Heat flow per temperature difference for contact radius `a` [energy/(time temperature)].
    #[inline(always)]
    pub fn conductance<R: Real>(&self, g: &Geometry<R>, a: R, on_wall: bool) -> R {
        match *self {
            Heat::None => a.like(0.0),
            Heat::Area(h) => a * (h * PI) * a,
            Heat::Radius(k) => a * (2.0 * k),
            Heat::Contact { conductivity, area } => {
                let deep = g.overlap.most(a.like(0.0));
                let area = match area {
                    Area::Constant(area) if !on_wall => a.like(area),
                    Area::Projection if !on_wall => {
                        let largest = g.radii[0].most(g.radii[1]);
                        largest * largest * PI
                    }
                    Area::Constant(_) | Area::Projection => circle(g, deep, on_wall),
                    Area::Overlap(factor) => circle(g, deep * factor, on_wall),
                };
                area.sqrt() * (2.0 * conductivity)
            }
        }
    }
}
