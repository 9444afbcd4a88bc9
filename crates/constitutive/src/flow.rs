//! Plastic flow: the return of a trial stress to the yield surface.

use crate::drucker_prager::DruckerPrager;
use crate::elastic::Elastic;
use crate::hardening::{Flowing, Hardening};
use crate::site::{Failure, Moment};

/// A yield surface with its flow rule.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Flow {
    /// Mises (J2): q = √(3/2)|dev τ| ≤ σ_y, associated and isotropic; the volume does not flow.
    Mises(Hardening),
    /// Drucker and Prager: √J₂ + ηp ≤ κc.
    DruckerPrager(DruckerPrager),
}

/// Where a trial state returns to.
#[derive(Clone, Copy, Debug)]
pub struct Returned {
    /// Factor of the deviator of the elastic strain.
    pub deviator: f64,
    /// Elastic volume strain tr ε.
    pub volume: f64,
    /// Increment of the equivalent plastic strain Δε̄.
    pub step: f64,
    /// Plastic work [energy/volume].
    pub dissipated: f64,
    /// Equivalent stress at the end, at the apex of a cone its pressure [pressure].
    pub limit: f64,
}

/// Iterations for a plastic strain: Newton's method needs below ten, halving alone reaches rounding in sixty, and behind strains of 1e-16,
/// where a power of ε̄ has just begun, in a hundred.
const MOST_ITERATIONS: usize = 200;

/// Slopes of the residual, in shear moduli, beyond which hardening counts as steep; without hardening it is 3.
const STEEP: f64 = 6.0;

impl Flow {
    /// The return from a trial state of equivalent stress q and volume strain tr ε; `None` for an elastic step.
    ///
    /// # Errors
    /// No plastic strain returns to the yield surface.
    #[inline]
    pub fn returned(
        &self,
        elastic: &Elastic,
        [q, volume]: [f64; 2],
        before: f64,
        moment: &Moment,
    ) -> Result<Option<Returned>, Failure> {
        match self {
            Self::Mises(hardening) => {
                let start = Flowing {
                    before,
                    step: 0.0,
                    dt: moment.dt,
                    thermal: hardening.thermal(moment.temperature),
                };
                let Some((step, [first, last])) = mises(hardening, elastic.shear, q, start)? else {
                    return Ok(None);
                };
                Ok(Some(Returned {
                    deviator: 1.0 - 3.0 * elastic.shear * step / q,
                    volume,
                    step,
                    dissipated: 0.5 * (first + last) * step,
                    limit: last,
                }))
            }
            Self::DruckerPrager(cone) => Ok(cone.returned(elastic, q, volume, before)),
        }
    }

    /// Whether the volume keeps out of flow.
    pub fn keeps_volume(&self) -> bool {
        matches!(self, Self::Mises(_))
    }
}

/// The increment Δε̄ of the equivalent plastic strain with which q − 3GΔε̄ = σ_y, and the yield stresses before and after, both at
/// the rate of the step; `None` where the trial stress q does not reach the yield stress at rest.
///
/// Newton's method inside a bracket [0, q/3G], which halves where a step would leave it. It starts at 0, or at the other end where
/// σ_y begins steeply (a power of ε̄): there the slope is nearly 3G.
///
/// Source: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), section 3.3.
///
/// # Errors
/// No increment is found: σ_y falls faster than 3G.
#[inline]
fn mises(
    hardening: &Hardening,
    shear: f64,
    q: f64,
    start: Flowing,
) -> Result<Option<(f64, [f64; 2])>, Failure> {
    let residual = |step: f64| {
        let (limit, slope) = hardening.limit(Flowing { step, ..start });
        (q - 3.0 * shear * step - limit, -(3.0 * shear + slope), limit)
    };
    let (mut excess, mut slope, _) = residual(0.0);
    if excess.is_nan() || excess <= 0.0 {
        return Ok(None);
    }
    let (mut low, mut high, mut step) = (0.0, q / (3.0 * shear), 0.0);
    if -slope > STEEP * shear {
        step = high;
        (excess, slope, _) = residual(step);
    }
    // A few roundings of q: a smaller residual is noise.
    let enough = 16.0 * f64::EPSILON * q;
    for _ in 0..MOST_ITERATIONS {
        let newton = step - excess / slope;
        step = if newton > low && newton <= high { newton } else { 0.5 * (low + high) };
        let limit;
        (excess, slope, limit) = residual(step);
        match excess > 0.0 {
            true => low = step,
            false => high = step,
        }
        if excess.abs() <= enough || high - low <= 2.0 * f64::EPSILON * high {
            // The strain before, at the rate of the step.
            let (first, _) = hardening.limit(Flowing { before: start.before - step, step, ..start });
            return Ok(Some((step, [first, limit])));
        }
    }
    Err(Failure::NoReturn(q))
}
