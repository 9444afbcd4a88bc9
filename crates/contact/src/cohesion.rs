//! Cohesion: a pull k A by the area of contact, which begins and ends with the contact, or that of a liquid bridge.
//!
//! LIGGGHTS manual, gran_cohesion_sjkr and gran_cohesion_sjkr2: "simplified JKR" with an energy density k [energy/volume]; the
//! area of `sjkr2` on walls is measured with LIGGGHTS 3.8.0.

mod bridge;

use super::Geometry;
use super::normal::geometric;
pub use bridge::{Bridge, Profile};
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
    /// `capillary`: a liquid bridge.
    Capillary(Bridge),
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
            Cohesion::Capillary(_) => "capillary",
        }
    }

    /// The word about its force that must be the same for mixing.
    pub(crate) fn detail(&self) -> &'static str {
        match self {
            Cohesion::Capillary(Bridge { profile: Profile::Willett, .. }) => "cohesion … force willett",
            _ if self.reduces() => "cohesion … reduce",
            _ => "another cohesion",
        }
    }

    /// Whether it acts beyond touch.
    #[inline(always)]
    pub fn spans(&self) -> bool {
        matches!(self, Cohesion::Capillary(_))
    }

    /// The gap between surfaces at which an existing contact breaks [length].
    pub fn gap(&self) -> f64 {
        match self {
            Cohesion::Capillary(bridge) => bridge.rupture,
            _ => 0.0,
        }
    }

    /// Whether the limit of friction counts from the force with the pull.
    #[inline(always)]
    pub fn reduces(&self) -> bool {
        match self {
            Cohesion::None | Cohesion::Capillary(_) => false,
            Cohesion::Sjkr(pull) | Cohesion::Sjkr2(pull) => pull.reduces,
        }
    }

    /// The model between two types whose models are of one kind: geometric means.
    pub fn mixed(&self, other: &Cohesion) -> Cohesion {
        let both = |a: &Pull, b: &Pull| Pull { density: geometric(a.density, b.density), reduces: a.reduces };
        match (self, other) {
            (Cohesion::Sjkr(a), Cohesion::Sjkr(b)) => Cohesion::Sjkr(both(a, b)),
            (Cohesion::Sjkr2(a), Cohesion::Sjkr2(b)) => Cohesion::Sjkr2(both(a, b)),
            (Cohesion::Capillary(a), Cohesion::Capillary(b)) => Cohesion::Capillary(a.mixed(b)),
            _ => Cohesion::None,
        }
    }

    /// The pull [force]; `on_wall`: the second side is a flat wall.
    #[inline(always)]
    pub fn pull<R: Real>(&self, g: &Geometry<R>, on_wall: bool) -> R {
        let depth = g.overlap.most(g.overlap.like(0.0));
        match self {
            Cohesion::None => g.overlap.like(0.0),
            Cohesion::Sjkr(pull) => circle(g, depth, on_wall) * pull.density,
            Cohesion::Sjkr2(pull) => g.curvature * depth * (sjkr2(on_wall) * pull.density),
            Cohesion::Capillary(bridge) => bridge.pull(g),
        }
    }

    /// ∫ F dδ of the pull F from first touch, negative beyond touch [energy].
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
            Cohesion::Capillary(bridge) => -bridge.work(g),
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
