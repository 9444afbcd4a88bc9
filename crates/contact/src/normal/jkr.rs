//! `jkr E eta nu gamma` (Johnson, Kendall & Roberts 1971): sticks until it is pulled off at −3π γ R̄, beyond
//! touching.

use super::hertz::Hertz;
use super::{Geometry, NormalLaw, Number, Push, Real, Style};
use std::f64::consts::PI;

/// The style.
pub const JKR: Style = Style {
    name: "jkr",
    numbers: &[Number::YOUNG, Number::ETA, Number::POISSON, Number::GAMMA],
    formula: "F_n = 4/3 E* a³/R̄ − 4 a √(π γ E* a) with δ = a²/R̄ − 2 √(π γ a/E*): a contact that has been made lasts until it \
              is torn off at −3π γ R̄, beyond touch.",
    pulls: |_| true,
    restitution: false,
    force: |pair| Jkr { stiffness: 4.0 / 3.0 * pair.young, cohesion: pair.numbers[3] }.into(),
    ..Style::PUSHES
};

/// F = k a³/R̄ − 4 a √(π γ E* a), δ = a²/R̄ − 2 √(π γ a/E*), k = (4/3) E*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jkr {
    /// k [pressure].
    stiffness: f64,
    /// Surface energy γ [energy/area].
    cohesion: f64,
}

impl Jkr {
    /// E* [pressure].
    #[inline(always)]
    fn young(&self) -> f64 {
        0.75 * self.stiffness
    }
}

impl NormalLaw for Jkr {
    const STICKS: bool = true;

    /// a(δ), the largest root of δ = a²/R̄ − 2 √(π γ a/E*), in the closed form of Parteli et al. (2014),
    /// doi 10.1038/srep06227, eq. 7.
    #[inline(always)]
    fn radius<R: Real>(&self, g: &Geometry<R>) -> R {
        // No closures: they are not inlined into code for wide registers.
        let (curvature, overlap) = (g.curvature, g.overlap);
        let (e, gamma) = (self.young(), self.cohesion);
        let zero = overlap.like(0.0);
        let depth = curvature * overlap;
        let square = curvature * curvature;
        let attraction = square * square * (gamma * gamma * e);
        let own = attraction * (27.0 * PI * PI);
        let elastic = depth * depth * depth * (8.0 * e * e * e);
        let inner = (attraction * (own + elastic * 2.0)).most(zero).sqrt();
        let cube = (own + elastic + inner * (3.0 * 3.0_f64.sqrt() * PI)).each(f64::cbrt);
        let part = depth * depth * (4.0 * e) / cube + cube / e;
        let first = (depth * 2.0 + part).most(zero).sqrt();
        let last = square * (6.0 * 6.0_f64.sqrt() * gamma * PI / e) / first;
        let a = (first + (depth * 4.0 - part + last).most(zero).sqrt()) / 6.0_f64.sqrt();
        // Without adhesion the quotients are 0/0 at first touch.
        R::choose(cube.above(zero), a, depth.most(zero).sqrt())
    }

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, a: R, _memory: &mut [R]) -> Push<R> {
        let secant = a * self.stiffness;
        let adhesion = a * (a * (PI * self.cohesion * self.young())).sqrt() * 4.0;
        let force = secant * a * a / g.curvature - adhesion;
        Push { force, secant, hold: g.curvature * (3.0 * PI * self.cohesion) * 2.0 }
    }

    fn energy(&self, g: &Geometry, _memory: &[f64]) -> f64 {
        // Simpson's rule; the force is smooth in δ except at the tear, where the slope is infinite.
        const PANELS: usize = 64;
        let at = |k: usize| {
            let overlap = g.overlap * k as f64 / PANELS as f64;
            let g = Geometry { overlap, ..*g };
            self.push(&g, self.radius(&g), &mut []).force
        };
        let weight = |k: usize| [1.0, 4.0, 2.0][usize::from(k != 0 && k != PANELS) * (2 - k % 2)];
        let sum: f64 = (0..=PANELS).map(|k| weight(k) * at(k)).sum();
        sum * g.overlap / (3 * PANELS) as f64
    }

    /// −δ at which the contact tears under a given force, a³ = 9π γ R̄²/(4 E*).
    fn gap(&self, curvature: f64) -> f64 {
        if self.cohesion == 0.0 {
            return 0.0;
        }
        let e = self.young();
        let a = (9.0 * PI * self.cohesion * curvature * curvature / (4.0 * e)).cbrt();
        2.0 * (PI * self.cohesion * a / e).sqrt() - a * a / curvature
    }

    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
        Hertz { stiffness: self.stiffness }.power_law(curvature, mass)
    }
}
