//! `hooke/velocity E eta nu V`: a linear spring as stiff as Hertz' contact is in an impact at the velocity V.
//!
//! k_n = (16/15) √R̄ E* (15 m̄ V²/(16 √R̄ E*))^(1/5) (LIGGGHTS manual, gran_model_hooke): at V the spring takes up the
//! energy that a Hertzian contact would at the same overlap.

use super::{Bound, Geometry, NormalLaw, Number, Push, Real, Role, Style};

/// The style.
pub const HOOKE_VELOCITY: Style = Style {
    name: "hooke/velocity",
    numbers: &[Number::YOUNG, Number::ETA, Number::POISSON, VELOCITY],
    formula: "F_n = k_n δ, k_n = 16/15 √R̄ E* (15 m̄ V²/(16 √R̄ E*))^(1/5): as stiff as Hertz' contact in an impact at V.",
    exponent: |_| 1.0,
    force: |pair| HookeVelocity { young: pair.young, velocity: pair.numbers[3] }.into(),
    ..Style::PUSHES
};

/// The velocity of an impact.
pub(super) const VELOCITY: Number =
    Number { word: "V", name: "the velocity V of impacts", bound: Bound::Positive, role: Role::Own };

/// F = k_n δ with the k_n of an impact at V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HookeVelocity {
    /// E* [pressure].
    pub(super) young: f64,
    /// V [length/time].
    pub(super) velocity: f64,
}

impl HookeVelocity {
    /// k_n [force/length].
    #[inline(always)]
    pub(super) fn stiffness<R: Real>(&self, curvature: R, mass: R) -> R {
        let hertz = curvature.sqrt() * (16.0 / 15.0 * self.young);
        let ratio = mass * (self.velocity * self.velocity) / hertz;
        hertz * ratio.each(|x| x.powf(0.2))
    }
}

impl NormalLaw for HookeVelocity {
    const BY_RADIUS: bool = false;
    const BY_MASS: bool = true;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, _memory: &mut [R]) -> Push<R> {
        let secant = self.stiffness(g.curvature, g.mass);
        Push { force: secant * g.overlap, secant, hold: g.overlap.like(0.0) }
    }

    fn energy(&self, g: &Geometry, _memory: &[f64]) -> f64 {
        let depth = g.overlap.max(0.0);
        0.5 * self.stiffness(g.curvature, g.mass) * depth * depth
    }

    fn tangent(&self, g: &Geometry) -> f64 {
        self.stiffness(g.curvature, g.mass)
    }

    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
        Some([self.stiffness(curvature, mass), 1.0])
    }
}
