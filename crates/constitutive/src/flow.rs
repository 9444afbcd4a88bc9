//! Plastic flow: the return of a trial stress to the yield surface.

use crate::hardening::{Flowing, Hardening};
use crate::site::Failure;

/// A yield surface with its flow rule.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Flow {
    /// Mises (J2): q = √(3/2)|dev τ| ≤ σ_y, associated and isotropic: the volume flows not at all.
    Mises(Hardening),
}

/// Iterations for a plastic strain: Newton's method needs below ten, halving alone reaches rounding in sixty.
const MOST_ITERATIONS: usize = 80;

/// The increment Δε̄ of the equivalent plastic strain with which q − 3GΔε̄ = σ_y, and the limits σ_y before and after; `None`
/// where the trial stress q does not reach the limit.
///
/// Newton's method inside a bracket [0, q/3G], which halves where a step would leave it.
///
/// Source: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), section 3.3.
///
/// # Errors
/// No increment is found: σ_y falls faster than 3G.
pub fn returned(
    hardening: &Hardening,
    shear: f64,
    q: f64,
    before: f64,
) -> Result<Option<(f64, [f64; 2])>, Failure> {
    let residual = |step: f64| {
        let (limit, slope) = hardening.limit(Flowing { before, step });
        (q - 3.0 * shear * step - limit, -(3.0 * shear + slope), limit)
    };
    let (mut excess, mut slope, first) = residual(0.0);
    if !(excess > 0.0) {
        return Ok(None);
    }
    let (mut low, mut high, mut step) = (0.0, q / (3.0 * shear), 0.0);
    // The rounding of q: a smaller residual is noise.
    let enough = 4.0 * f64::EPSILON * q;
    for _ in 0..MOST_ITERATIONS {
        let newton = step - excess / slope;
        step = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let limit;
        (excess, slope, limit) = residual(step);
        match excess > 0.0 {
            true => low = step,
            false => high = step,
        }
        if excess.abs() <= enough || high - low <= 2.0 * f64::EPSILON * high {
            return Ok(Some((step, [first, limit])));
        }
    }
    Err(Failure::NoReturn(q))
}
