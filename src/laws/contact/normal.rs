//! Elastic forces along the normal: Hertz, by stiffness or by material.

/// A normal model with the coefficients a deck gives it. `eta` is the damping coefficient or, for damping
/// models that ask for it, the coefficient of restitution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// `hertz kn eta`: F = k_n √(R̄ δ) δ, k_n [pressure].
    Hertz {
        /// Stiffness [pressure].
        stiffness: f64,
        /// Damping coefficient or restitution.
        eta: f64,
    },
    /// `hertz/material E eta nu`: F = (4/3) E* √(R̄ δ) δ.
    HertzMaterial {
        /// Young's modulus [pressure].
        young: f64,
        /// Damping coefficient or restitution.
        eta: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
}

impl Normal {
    /// The word decks use.
    pub fn name(&self) -> &'static str {
        match self {
            Normal::Hertz { .. } => "hertz",
            Normal::HertzMaterial { .. } => "hertz/material",
        }
    }

    /// Damping coefficient or restitution.
    pub fn eta(&self) -> f64 {
        match *self {
            Normal::Hertz { eta, .. } | Normal::HertzMaterial { eta, .. } => eta,
        }
    }

    /// Young's modulus and Poisson's ratio, where the model has them.
    pub fn material(&self) -> Option<(f64, f64)> {
        match *self {
            Normal::HertzMaterial { young, poisson, .. } => Some((young, poisson)),
            Normal::Hertz { .. } => None,
        }
    }

    /// k in F = k a δ with the contact radius a = √(R̄ δ), for a pair of grains with these models of one kind
    /// [pressure]; stiffnesses mix geometrically, materials as E*.
    pub fn stiffness(&self, other: &Normal) -> f64 {
        match (*self, *other) {
            (
                Normal::HertzMaterial { young: e1, poisson: n1, .. },
                Normal::HertzMaterial { young: e2, poisson: n2, .. },
            ) => 4.0 / 3.0 * effective_young([e1, e2], [n1, n2]),
            (Normal::Hertz { stiffness: k1, .. }, Normal::Hertz { stiffness: k2, .. }) => geometric(k1, k2),
            (Normal::Hertz { stiffness, .. }, _) | (_, Normal::Hertz { stiffness, .. }) => stiffness,
        }
    }
}

/// The geometric mean √(a b); a itself when both are the same number.
pub fn geometric(a: f64, b: f64) -> f64 {
    if a == b { a } else { (a * b).sqrt() }
}

/// E* = 1 / ((1 − ν_i²)/E_i + (1 − ν_j²)/E_j).
pub fn effective_young(e: [f64; 2], nu: [f64; 2]) -> f64 {
    1.0 / ((1.0 - nu[0] * nu[0]) / e[0] + (1.0 - nu[1] * nu[1]) / e[1])
}

/// G* = 1 / ((2 − ν_i)/G_i + (2 − ν_j)/G_j) with G = E / (2 (1 + ν)).
pub fn effective_shear(e: [f64; 2], nu: [f64; 2]) -> f64 {
    let part = |k: usize| 2.0 * (2.0 - nu[k]) * (1.0 + nu[k]) / e[k];
    1.0 / (part(0) + part(1))
}
