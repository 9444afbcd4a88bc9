//! `hertz kn eta` and `hertz/material E eta nu`: F = k √(R̄ δ) δ, k [pressure].

use super::{Geometry, NormalLaw, Number, Push, Real, Role, Style};

/// The style with a stiffness.
pub const HERTZ: Style = Style {
    name: "hertz",
    numbers: &[Number::own("kn", "the stiffness kn", Role::Own), Number::ETA],
    formula: "F_n = kn a δ.",
    force: |pair| Hertz { stiffness: pair.numbers[0] }.into(),
    ..Style::PUSHES
};

/// The style with a material.
pub const HERTZ_MATERIAL: Style = Style {
    name: "hertz/material",
    numbers: &[Number::YOUNG, Number::ETA, Number::POISSON],
    formula: "F_n = 4/3 E* a δ with 1/E* = (1−ν_i²)/E_i + (1−ν_j²)/E_j.",
    force: |pair| Hertz { stiffness: 4.0 / 3.0 * pair.young }.into(),
    ..Style::PUSHES
};

/// F = k a δ, a = √(R̄ δ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hertz {
    /// k [pressure].
    pub stiffness: f64,
}

impl NormalLaw for Hertz {
    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, a: R, _memory: &mut [R]) -> Push<R> {
        let secant = a * self.stiffness;
        Push { force: secant * g.overlap, secant, hold: g.overlap.like(0.0) }
    }

    fn energy(&self, g: &Geometry, _memory: &[f64]) -> f64 {
        let depth = g.overlap.max(0.0);
        0.4 * self.stiffness * (g.curvature * depth).sqrt() * depth * depth
    }

    fn power_law(&self, curvature: f64, _mass: f64) -> Option<[f64; 2]> {
        (self.stiffness > 0.0).then(|| [self.stiffness * curvature.sqrt(), 1.5])
    }
}
