//! `hooke kn eta`: F = k_n δ, k_n [force/length].

use super::{Geometry, NormalLaw, Number, Push, Real, Role, Style};

/// The style.
pub const HOOKE: Style = Style {
    name: "hooke",
    numbers: &[Number::own("kn", "the stiffness kn", Role::Own), Number::ETA],
    formula: "F_n = kn δ.",
    exponent: |_| 1.0,
    force: |pair| Hooke { stiffness: pair.numbers[0] }.into(),
    ..Style::PUSHES
};

/// F = k δ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hooke {
    /// k [force/length].
    pub stiffness: f64,
}

impl NormalLaw for Hooke {
    const BY_RADIUS: bool = false;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, _memory: &mut [R]) -> Push<R> {
        let secant = g.overlap.like(self.stiffness);
        Push { force: secant * g.overlap, secant, hold: g.overlap.like(0.0) }
    }

    fn energy(&self, g: &Geometry, _memory: &[f64]) -> f64 {
        let depth = g.overlap.max(0.0);
        0.5 * self.stiffness * depth * depth
    }

    fn tangent(&self, g: &Geometry) -> f64 {
        let small = 1e-6 * g.overlap.abs();
        if small == 0.0 {
            return self.stiffness;
        }
        // Central difference as for every law, to keep the last digit of compute dt/critical.
        (self.stiffness * (g.overlap + small) - self.stiffness * (g.overlap - small)) / (2.0 * small)
    }

    fn power_law(&self, _curvature: f64, _mass: f64) -> Option<[f64; 2]> {
        (self.stiffness > 0.0).then_some([self.stiffness, 1.0])
    }
}
