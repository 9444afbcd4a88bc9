//! `none`: no normal force.

use super::{Geometry, NormalLaw, Push, Real, Style};

/// The style.
pub const NONE: Style = Style { name: "none", formula: "No force.", ..Style::PUSHES };

/// No force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nothing;

impl NormalLaw for Nothing {
    const BY_RADIUS: bool = false;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, _memory: &mut [R]) -> Push<R> {
        let zero = g.overlap.like(0.0);
        Push { force: zero * g.overlap, secant: zero, hold: zero }
    }

    fn energy(&self, _g: &Geometry, _memory: &[f64]) -> f64 {
        0.0
    }

    fn power_law(&self, _curvature: f64, _mass: f64) -> Option<[f64; 2]> {
        None
    }
}
