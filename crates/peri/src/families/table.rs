//! Coefficients of bond-based bodies by pair of types.

use perigrain_base::diag::{Code, Diagnostic, Result};

/// Coefficients of the prototype microelastic brittle model for one pair of types.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PmbCoeff {
    /// Micromodulus, energy per distance and volume squared.
    pub c: f64,
    /// Horizon, a distance.
    pub horizon: f64,
    /// Critical stretch of an otherwise unstretched family.
    pub s00: f64,
    /// How much compression raises the critical stretch; not negative.
    pub alpha: f64,
}

/// Coefficients by pair of types (1-based), symmetric; unset pairs belong to other styles or to none.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PmbTable {
    pub(super) types: usize,
    pub(super) pairs: Vec<Option<PmbCoeff>>,
}

impl PmbTable {
    /// A table for `types` types with nothing set.
    pub fn new(types: usize) -> Self {
        Self { types, pairs: vec![None; types * types] }
    }

    /// The number of types.
    pub fn types(&self) -> usize {
        self.types
    }

    /// Sets types `a`, `b` and `b`, `a`.
    ///
    /// # Errors
    /// A coefficient that makes no sense is refused by name; the caller knows the place in the deck.
    pub fn set(&mut self, a: u16, b: u16, coeff: PmbCoeff) -> Result<()> {
        let bad = |what: &str| {
            Err(Diagnostic::error(Code::BAD_VALUE, None, format!("peri/pmb: {what}"))
                .help("pair_coeff I J c horizon s00 alpha")
                .into())
        };
        if !(coeff.c.is_finite() && coeff.c >= 0.0) {
            return bad("c must be finite and not negative");
        }
        if !(coeff.horizon.is_finite() && coeff.horizon > 0.0) {
            return bad("the horizon must be positive");
        }
        if coeff.s00.is_nan() || coeff.s00 < 0.0 {
            return bad("s00 must not be negative");
        }
        if !(coeff.alpha.is_finite() && coeff.alpha >= 0.0) {
            return bad("alpha must be finite and not negative");
        }
        let (a, b) = (usize::from(a) - 1, usize::from(b) - 1);
        self.pairs[a * self.types + b] = Some(coeff);
        self.pairs[b * self.types + a] = Some(coeff);
        Ok(())
    }

    /// The coefficients of types `a` and `b` if they were set.
    pub fn get(&self, a: u16, b: u16) -> Option<&PmbCoeff> {
        self.pairs[(usize::from(a) - 1) * self.types + usize::from(b) - 1].as_ref()
    }

    /// The pairs that were set.
    pub fn iter(&self) -> impl Iterator<Item = &PmbCoeff> {
        self.pairs.iter().flatten()
    }
}
