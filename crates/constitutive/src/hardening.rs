//! Yield stresses that grow with plastic strain, its rate and fall with temperature.

use crate::johnson_cook::JohnsonCook;

/// How the yield stress σ_y depends on the equivalent plastic strain ε̄.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Hardening {
    /// σ₀ + Hε̄.
    Linear {
        /// First yield stress σ₀ [pressure].
        yields: f64,
        /// Modulus H [pressure].
        modulus: f64,
    },
    /// σ₀ + (σ∞ − σ₀)(1 − e^(−bε̄)) + Hε̄.
    ///
    /// Source: E. Voce, J. Inst. Met. 74, 537 (1948), with a linear part.
    Voce {
        /// First yield stress σ₀ [pressure].
        yields: f64,
        /// Saturation stress σ∞ [pressure].
        saturation: f64,
        /// Exponent b.
        exponent: f64,
        /// Modulus H of what does not saturate [pressure].
        modulus: f64,
    },
    /// σ₀(1 + ε̄/ε₀)ⁿ.
    ///
    /// Source: H. W. Swift, J. Mech. Phys. Solids 1, 1 (1952).
    Swift {
        /// First yield stress σ₀ [pressure].
        yields: f64,
        /// Strain ε₀.
        strain: f64,
        /// Exponent n.
        exponent: f64,
    },
    /// Linear between points (ε̄, σ_y), of which the first is at ε̄ = 0 and strains grow; constant after the last.
    Table(Vec<[f64; 2]>),
    /// Johnson and Cook.
    JohnsonCook(JohnsonCook),
}

/// Where a yield stress is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Flowing {
    /// Equivalent plastic strain before the step.
    pub before: f64,
    /// Its increment in the step Δε̄ ≥ 0.
    pub step: f64,
    /// Duration of the step [time]; 0: rates have no effect.
    pub dt: f64,
    /// The factor of temperature, [`Hardening::thermal`].
    pub thermal: f64,
}

impl Hardening {
    /// σ_y at ε̄ = `before` + `step` and its derivative by `step` [pressure].
    #[inline]
    pub fn limit(&self, at: Flowing) -> (f64, f64) {
        let strain = at.before + at.step;
        match self {
            Self::Linear { yields, modulus } => (yields + modulus * strain, *modulus),
            Self::Voce { yields, saturation, exponent, modulus } => {
                let left = (saturation - yields) * (-exponent * strain).exp();
                (saturation - left + modulus * strain, exponent * left + modulus)
            }
            Self::Swift { yields, strain: unit, exponent } => {
                let stretched = 1.0 + strain / unit;
                let limit = yields * stretched.powf(*exponent);
                (limit, exponent * limit / (unit * stretched))
            }
            Self::Table(points) => between(points, strain),
            Self::JohnsonCook(law) => law.limit(at),
        }
    }

    /// The factor of the yield stress that depends on temperature alone: 1 for laws without one, and without a temperature.
    #[inline]
    pub fn thermal(&self, temperature: Option<f64>) -> f64 {
        match self {
            Self::JohnsonCook(law) => law.thermal(temperature),
            _ => 1.0,
        }
    }
}

/// Value and slope of a polyline.
fn between(points: &[[f64; 2]], x: f64) -> (f64, f64) {
    let after = points.partition_point(|p| p[0] <= x);
    match (points.get(after.wrapping_sub(1)), points.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => {
            let slope = (y1 - y0) / (x1 - x0);
            (y0 + slope * (x - x0), slope)
        }
        (Some([_, y]), None) | (None, Some([_, y])) => (*y, 0.0),
        (None, None) => (0.0, 0.0),
    }
}
