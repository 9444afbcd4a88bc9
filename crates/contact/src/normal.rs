//! Elastic and cohesive forces along the normal, as decks name them: by stiffness or by material.

use super::elastic::{Elastic, Form};
use super::powder::Material;

/// A normal model with the coefficients a deck gives it. `eta` is the damping coefficient or, for damping
/// models that ask for it, the coefficient of restitution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// `none`: no force along the normal.
    None,
    /// `hooke kn eta`: F = k_n δ, k_n [force/length].
    Hooke {
        /// Stiffness [force/length].
        stiffness: f64,
        /// Damping coefficient or restitution.
        eta: f64,
    },
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
    /// `dmt E eta nu gamma` (Derjaguin, Muller & Toporov 1975): F = (4/3) E* √(R̄ δ) δ − 4π γ R̄.
    Dmt {
        /// Young's modulus [pressure].
        young: f64,
        /// Damping coefficient.
        eta: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Surface energy γ [energy/area].
        cohesion: f64,
    },
    /// `jkr E eta nu gamma` (Johnson, Kendall & Roberts 1971), lasts until it is pulled off at −3π γ R̄.
    Jkr {
        /// Young's modulus [pressure].
        young: f64,
        /// Damping coefficient.
        eta: f64,
        /// Poisson's ratio.
        poisson: f64,
        /// Surface energy γ [energy/area].
        cohesion: f64,
    },
    /// `mdr E nu Y gamma psi_b eta` (Zunker & Kamrin 2024): plastic, adhesive grains, see [`super::powder`].
    Mdr {
        /// What the grains are made of.
        material: Material,
        /// Coefficient of `damping mdr`.
        eta: f64,
    },
}

impl Normal {
    /// The words decks use.
    pub const NAMES: [&'static str; 7] = ["none", "hooke", "hertz", "hertz/material", "dmt", "jkr", "mdr"];

    /// The word decks use.
    pub fn name(&self) -> &'static str {
        match self {
            Normal::None => "none",
            Normal::Hooke { .. } => "hooke",
            Normal::Hertz { .. } => "hertz",
            Normal::HertzMaterial { .. } => "hertz/material",
            Normal::Dmt { .. } => "dmt",
            Normal::Jkr { .. } => "jkr",
            Normal::Mdr { .. } => "mdr",
        }
    }

    /// The numbers of plastic grains that are the grain's alone: E, ν, Y, ψ_b and restitution.
    pub fn plastic(&self) -> Option<[f64; 5]> {
        let Normal::Mdr { material: m, eta } = self else { return None };
        Some([m.young, m.poisson, m.yield_stress, m.confinement, *eta])
    }

    /// Damping coefficient or restitution.
    pub fn eta(&self) -> f64 {
        match *self {
            Normal::None => 0.0,
            Normal::Hooke { eta, .. }
            | Normal::Hertz { eta, .. }
            | Normal::HertzMaterial { eta, .. }
            | Normal::Dmt { eta, .. }
            | Normal::Jkr { eta, .. }
            | Normal::Mdr { eta, .. } => eta,
        }
    }

    /// Young's modulus and Poisson's ratio, where the model has them.
    pub fn material(&self) -> Option<(f64, f64)> {
        match *self {
            Normal::HertzMaterial { young, poisson, .. }
            | Normal::Dmt { young, poisson, .. }
            | Normal::Jkr { young, poisson, .. } => Some((young, poisson)),
            Normal::Mdr { material, .. } => Some((material.young, material.poisson)),
            _ => None,
        }
    }

    /// Surface energy γ [energy/area]; `None` for models that only push.
    pub fn cohesion(&self) -> Option<f64> {
        match *self {
            Normal::Dmt { cohesion, .. } | Normal::Jkr { cohesion, .. } => Some(cohesion),
            _ => None,
        }
    }

    /// Whether the force grows as δ, not as δ^(3/2).
    pub fn linear(&self) -> bool {
        matches!(self, Normal::Hooke { .. })
    }

    /// The force between two grains with these models of one kind: stiffnesses and surface energies mix
    /// geometrically, materials as E*.
    pub fn elastic(&self, other: &Normal) -> Elastic {
        let cohesion = geometric(self.cohesion().unwrap_or(0.0), other.cohesion().unwrap_or(0.0));
        let form = match self {
            Normal::None => Form::None,
            Normal::Hooke { .. } => Form::Hooke,
            Normal::Hertz { .. } | Normal::HertzMaterial { .. } => Form::Hertz,
            Normal::Dmt { .. } => Form::Dmt,
            Normal::Jkr { .. } => Form::Jkr,
            Normal::Mdr { .. } => Form::Mdr,
        };
        Elastic { form, stiffness: self.stiffness(other), cohesion }
    }

    fn stiffness(&self, other: &Normal) -> f64 {
        if let (Some((e1, nu1)), Some((e2, nu2))) = (self.material(), other.material()) {
            return 4.0 / 3.0 * effective_young([e1, e2], [nu1, nu2]);
        }
        let own = |n: &Normal| match *n {
            Normal::Hooke { stiffness, .. } | Normal::Hertz { stiffness, .. } => stiffness,
            _ => 0.0,
        };
        geometric(own(self), own(other))
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
