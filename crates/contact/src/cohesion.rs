//! Cohesion by the area of contact: a pull k A that begins and ends with the contact.
//!
//! LIGGGHTS manual, gran_cohesion_sjkr and gran_cohesion_sjkr2: "simplified JKR" with an energy density k [energy/volume]; the
//! area of `sjkr2` on walls is measured with LIGGGHTS 3.8.0.

use super::Geometry;
use super::normal::geometric;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

/// Cohesion models.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Cohesion {
    /// `none`.
    #[default]
    None,
    /// `sjkr k`: A is the circle in which the two spheres intersect.
    Sjkr(Pull),
    /// `sjkr2 k`: A = 4 π δ R̄, on walls 2 π δ R.
    Sjkr2(Pull),
}

/// Parameters of the pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// k [energy/volume].
    pub density: f64,
    /// `reduce`: the limit of friction counts from the force with the pull, not from that without it.
    pub reduces: bool,
}

impl Cohesion {
    /// The word in decks.
    pub fn name(&self) -> &'static str {
        match self {
            Cohesion::None => "none",
            Cohesion::Sjkr(_) => "sjkr",
            Cohesion::Sjkr2(_) => "sjkr2",
        }
    }

    fn pull_parameters(&self) -> Option<Pull> {
        match *self {
            Cohesion::None => None,
            Cohesion::Sjkr(pull) | Cohesion::Sjkr2(pull) => Some(pull),
        }
    }

    /// Whether the limit of friction counts from the force with the pull.
    #[inline(always)]
    pub fn reduces(&self) -> bool {
        match self {
            Cohesion::None => false,
            Cohesion::Sjkr(pull) | Cohesion::Sjkr2(pull) => pull.reduces,
        }
    }

    /// The model between two types whose models are of one kind: the geometric mean of k.
    pub fn mixed(&self, other: &Cohesion) -> Cohesion {
        let Some((a, b)) = self.pull_parameters().zip(other.pull_parameters()) else { return Cohesion::None };
        let pull = Pull { density: geometric(a.density, b.density), reduces: a.reduces };
        match self {
            Cohesion::Sjkr2(_) => Cohesion::Sjkr2(pull),
            _ => Cohesion::Sjkr(pull),
        }
    }

    /// The pull k A [force]; `on_wall`: the second side is a flat wall.
    #[inline(always)]
    pub fn pull<R: Real>(&self, g: &Geometry<R>, on_wall: bool) -> R {
        let depth = g.overlap.most(g.overlap.like(0.0));
        match self {
            Cohesion::None => g.overlap.like(0.0),
            Cohesion::Sjkr(pull) => circle(g, depth, on_wall) * pull.density,
            Cohesion::Sjkr2(pull) => g.curvature * depth * (sjkr2(on_wall) * pull.density),
        }
    }

    /// ∫ k A dδ from first touch: the energy to separate the two [energy].
    pub fn energy(&self, g: &Geometry, on_wall: bool) -> f64 {
        let depth = g.overlap.max(0.0);
        match self {
            Cohesion::None => 0.0,
            Cohesion::Sjkr(pull) => {
                let [ri, rj] = g.radii;
                let square = depth * depth;
                let volume = if on_wall {
                    PI * square * (ri - depth / 3.0)
                } else {
                    let (sum, odd) = (ri + rj, ri - rj);
                    0.25 * PI * square * (sum - depth / 3.0 - odd * odd / (sum - depth))
                };
                pull.density * volume
            }
            Cohesion::Sjkr2(pull) => 0.5 * sjkr2(on_wall) * pull.density * g.curvature * depth * depth,
        }
    }
}

/// A/(R̄ δ) of `sjkr2`.
#[inline(always)]
fn sjkr2(on_wall: bool) -> f64 {
    if on_wall { 2.0 * PI } else { 4.0 * PI }
}

/// Area of the circle in which two spheres that overlap by `depth` intersect, or a sphere and a flat wall: with the distance
/// D = R_i + R_j − δ it is (π/4) δ (D + R_i − R_j) (D − R_i + R_j) (D + R_i + R_j)/D², on the wall π δ (2R − δ).
#[inline(always)]
pub(crate) fn circle<R: Real>(g: &Geometry<R>, depth: R, on_wall: bool) -> R {
    let [ri, rj] = g.radii;
    if on_wall {
        return (ri * 2.0 - depth) * depth * PI;
    }
    let (sum, odd) = (ri + rj, ri - rj);
    let distance = sum - depth;
    let square = distance * distance;
    (square - odd * odd) * (distance + sum) * depth * (0.25 * PI) / square
}
