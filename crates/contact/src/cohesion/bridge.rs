//! Liquid bridges: the capillary pull of a small ring of liquid between two spheres, or a sphere and a wall.
//!
//! A bridge forms where two surfaces touch and lasts until their distance H exceeds that of rupture. With R = 2 R̄ (Derjaguin:
//! the radius of equal spheres, twice the radius of a sphere on a wall), the volume V, the surface tension γ and the contact angle θ
//! the pull is
//!
//! ```text
//! rabinovich   2 π R γ cos θ (1 − H/√(H² + c)),  c = 2 V/(π R)
//! willett      2 π R γ cos θ/(1 + 1.05 s + 2.5 s²),  s = H √(R/V)
//! ```
//!
//! and that at H = 0 where the two overlap. It ruptures at H = (1 + θ/2) V^(1/3), θ in radians (Lian et al. 1993), if no other
//! distance is given. Rabinovich, Esayanur & Moudgil 2005, doi 10.1021/la0517639, as LIGGGHTS' manual has it (gran_cohesion_washino_capillary_viscous): 1 + H/(2 d) with
//! 2 d = −H + √(H² + c), without the second term, which Lambert et al. 2008 (doi 10.1021/la7036444) found to be counted twice. Willett, Adams, Johnson & Seville 2000, doi 10.1021/la000657y, the short fit (their half distance doubled).
//! Lian, Thornton & Adams 1993, doi 10.1006/jcis.1993.1452. The ring's own weight and viscosity are left out.

use super::super::Geometry;
use super::super::normal::geometric;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

/// The dependence of the pull on distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Rabinovich et al. 2005.
    Rabinovich,
    /// Willett et al. 2000.
    Willett,
}

/// A bridge between grains of two types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge {
    /// The dependence on distance.
    pub profile: Profile,
    /// V of each bridge [volume].
    pub volume: f64,
    /// γ [force/length].
    pub tension: f64,
    /// θ [radians].
    pub angle: f64,
    /// The distance of rupture [length].
    pub rupture: f64,
}

/// Coefficients of Willett's fit.
const WILLETT: [f64; 2] = [1.05, 2.5];

impl Bridge {
    /// With the distance of rupture of Lian et al.
    pub fn new(profile: Profile, volume: f64, tension: f64, angle: f64) -> Self {
        Self { profile, volume, tension, angle, rupture: (1.0 + 0.5 * angle) * volume.cbrt() }
    }

    /// The bridge between two types: geometric means.
    pub(super) fn mixed(&self, other: &Self) -> Self {
        Self {
            profile: self.profile,
            volume: geometric(self.volume, other.volume),
            tension: geometric(self.tension, other.tension),
            angle: geometric(self.angle, other.angle),
            rupture: geometric(self.rupture, other.rupture),
        }
    }

    /// Pull per R̄ where the surfaces touch.
    #[inline(always)]
    fn touching(&self) -> f64 {
        4.0 * PI * self.tension * self.angle.cos()
    }

    /// The pull [force].
    #[inline(always)]
    pub(super) fn pull<R: Real>(&self, g: &Geometry<R>) -> R {
        let apart = (-g.overlap).most(g.overlap.like(0.0));
        let most = g.curvature * self.touching();
        match self.profile {
            Profile::Rabinovich => {
                let c = g.curvature.like(self.volume / PI) / g.curvature;
                most - most * apart / (apart * apart + c).sqrt()
            }
            Profile::Willett => {
                let s = apart * (g.curvature * (2.0 / self.volume)).sqrt();
                let [one, two] = WILLETT;
                most / (s * (s * two + one) + 1.0)
            }
        }
    }

    /// The work against the pull from touch to a distance; where the two overlap, minus that of the overlap [energy].
    pub(super) fn work(&self, g: &Geometry) -> f64 {
        let most = g.curvature * self.touching();
        if g.overlap >= 0.0 {
            return -most * g.overlap;
        }
        let h = -g.overlap;
        match self.profile {
            Profile::Rabinovich => {
                let c = self.volume / (PI * g.curvature);
                most * (h - (h * h + c).sqrt() + c.sqrt())
            }
            Profile::Willett => {
                let scale = (2.0 * g.curvature / self.volume).sqrt();
                let [b, a] = WILLETT;
                let root = (4.0 * a - b * b).sqrt();
                let angle = |s: f64| ((2.0 * a * s + b) / root).atan();
                most / scale * 2.0 / root * (angle(h * scale) - angle(0.0))
            }
        }
    }
}
