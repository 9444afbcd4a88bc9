//! Pressure-dependent flow: soils, rock, concrete.

use crate::elastic::Elastic;
use crate::flow::Returned;

/// The cone √J₂ + ηp ≤ κc, p the mean stress (tension positive), c = c₀ + Hε̄ the cohesion; it flows along dev τ and, by η̄, along
/// the pressure. On the outer edges of the pyramid of Mohr and Coulomb η = 6 sin φ/(√3(3 − sin φ)), κ = 6 cos φ/(√3(3 − sin φ)),
/// and η̄ is η with the angle of dilation ψ for φ. ε̄ grows by κΔγ.
///
/// Source: E. A. de Souza Neto, D. Perić, D. R. J. Owen, Computational Methods for Plasticity (2008), section 8.3.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DruckerPrager {
    /// Cohesion at birth c₀ [pressure].
    pub cohesion: f64,
    /// Modulus H of the cohesion [pressure].
    pub modulus: f64,
    /// Friction η.
    pub friction: f64,
    /// Dilation η̄.
    pub dilation: f64,
    /// Factor κ of the cohesion.
    pub factor: f64,
}

impl DruckerPrager {
    /// From the angles of friction φ and dilation ψ in degrees, 0 ≤ ψ ≤ φ < 90.
    pub fn from_angles(cohesion: f64, modulus: f64, friction: f64, dilation: f64) -> Self {
        let slope = |degrees: f64| {
            let sin = degrees.to_radians().sin();
            6.0 * sin / (3f64.sqrt() * (3.0 - sin))
        };
        let (sin, cos) = friction.to_radians().sin_cos();
        Self {
            cohesion,
            modulus,
            friction: slope(friction),
            dilation: slope(dilation),
            factor: 6.0 * cos / (3f64.sqrt() * (3.0 - sin)),
        }
    }

    /// The return from a trial state of equivalent stress q and volume strain tr ε; `None` inside of the cone.
    ///
    /// On the smooth part Δγ = (√J₂ + ηp − κc)/(G + Kηη̄ + κ²H). Where that would make √J₂ negative, to the apex p = κc/η, with
    /// associated flow of the volume: Δε̄ = (κ/η)Δε_v, Δε_v = (p − κc/η)/(K + H(κ/η)²).
    #[inline]
    pub fn returned(&self, elastic: &Elastic, q: f64, volume: f64, before: f64) -> Option<Returned> {
        let Self { friction, dilation, factor, modulus, .. } = *self;
        let (root, pressure) = (q / 3f64.sqrt(), elastic.bulk * volume);
        let limit = factor * (self.cohesion + modulus * before);
        let excess = root + friction * pressure - limit;
        if excess.is_nan() || excess <= 0.0 {
            return None;
        }
        let stiffness = elastic.shear + elastic.bulk * friction * dilation + factor * factor * modulus;
        let gamma = excess / stiffness;
        let left = root - elastic.shear * gamma;
        if left >= 0.0 {
            let volume = volume - dilation * gamma;
            return Some(Returned {
                deviator: left / root,
                volume,
                step: factor * gamma,
                // Stress at the end of the step times its plastic strain.
                dissipated: gamma * (left + dilation * elastic.bulk * volume),
                limit: 3f64.sqrt() * left,
            });
        }
        let ratio = factor / friction;
        let opened = (pressure - limit / friction) / (elastic.bulk + modulus * ratio * ratio);
        let apex = elastic.bulk * (volume - opened);
        Some(Returned {
            deviator: 0.0,
            volume: volume - opened,
            step: ratio * opened,
            dissipated: apex * opened,
            limit: apex,
        })
    }
}
