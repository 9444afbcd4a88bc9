//! Yield stresses that grow with plastic strain.

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
}

/// Where a yield stress is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Flowing {
    /// Equivalent plastic strain before the step.
    pub before: f64,
    /// Its increment in the step Δε̄ ≥ 0.
    pub step: f64,
}

impl Hardening {
    /// σ_y at ε̄ = `before` + `step` and its derivative by `step` [pressure].
    #[inline]
    pub fn limit(&self, at: Flowing) -> (f64, f64) {
        let strain = at.before + at.step;
        match self {
            Self::Linear { yields, modulus } => (yields + modulus * strain, *modulus),
        }
    }
}
