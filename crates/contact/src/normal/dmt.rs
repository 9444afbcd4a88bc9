//! `dmt E eta nu gamma` (Derjaguin, Muller & Toporov 1975): F = (4/3) E* √(R̄ δ) δ − 4π γ R̄.

use super::hertz::Hertz;
use super::{Geometry, NormalLaw, Number, Push, Real, Style};
use std::f64::consts::PI;

/// The style.
pub const DMT: Style = Style {
    name: "dmt",
    numbers: &[Number::YOUNG, Number::ETA, Number::POISSON, Number::GAMMA],
    formula: "F_n = 4/3 E* a δ − 4π γ R̄.",
    pulls: |_| true,
    restitution: false,
    force: |pair| {
        Dmt { elastic: Hertz { stiffness: 4.0 / 3.0 * pair.young }, cohesion: pair.numbers[3] }.into()
    },
    ..Style::PUSHES
};

/// F = k a δ − 4π γ R̄, a = √(R̄ δ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dmt {
    elastic: Hertz,
    /// Surface energy γ [energy/area].
    cohesion: f64,
}

impl NormalLaw for Dmt {
    const STICKS: bool = true;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, a: R, memory: &mut [R]) -> Push<R> {
        let elastic = self.elastic.push(g, a, memory);
        let pull_off = g.curvature * (4.0 * PI * self.cohesion);
        Push { force: elastic.force - pull_off, hold: pull_off * 2.0, ..elastic }
    }

    fn energy(&self, g: &Geometry, memory: &[f64]) -> f64 {
        let pull_off = 4.0 * PI * self.cohesion * g.curvature;
        self.elastic.energy(g, memory) - pull_off * g.overlap
    }

    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
        self.elastic.power_law(curvature, mass)
    }
}
