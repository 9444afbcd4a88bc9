//! A normal law that the program does not have: all of it is this file and, in the tests of this crate, one line in the table of
//! `normal`.

use super::*;
use crate::normal::{NormalLaw, Number, Push, Role, Style};

/// The style.
pub const QUADRATIC: Style = Style {
    name: "quadratic",
    numbers: &[Number::own("kn", "the stiffness kn", Role::Own), Number::ETA],
    formula: "kn δ²",
    exponent: |_| 2.0,
    force: |pair| Quadratic { stiffness: pair.numbers[0] }.into(),
    ..Style::PUSHES
};

/// F = k δ².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic {
    /// k [force/length²].
    stiffness: f64,
}

impl NormalLaw for Quadratic {
    const BY_RADIUS: bool = false;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, _memory: &mut [R]) -> Push<R> {
        let secant = g.overlap * self.stiffness;
        Push { force: secant * g.overlap, secant, hold: g.overlap.like(0.0) }
    }

    fn energy(&self, g: &Geometry, _memory: &[f64]) -> f64 {
        self.stiffness * g.overlap.max(0.0).powi(3) / 3.0
    }

    fn power_law(&self, _curvature: f64, _mass: f64) -> Option<[f64; 2]> {
        (self.stiffness > 0.0).then_some([self.stiffness, 2.0])
    }
}

/// Two equal spheres of radius 1 and mass m that meet head on, each with speed ½.
fn head_on(kn: f64, eta: f64, dt: f64) -> (Duel, f64) {
    let style = Normal::style("quadratic").unwrap();
    let law = model(Normal::new(style, &[kn, eta]), Damping::CoeffRestitution, mindlin(0.0, 0.0));
    let ball = |side: f64| Ball::new([side, 0.0, 0.0], [-0.5 * side, 0.0, 0.0], [0.0; 3], 1.0, 1.0);
    let balls = [ball(-1.0), ball(1.0)];
    (Duel::new(balls, law.law(Compat::Perigrain), dt), balls[0].mass)
}

#[test]
fn a_law_in_one_file_and_one_line_follows_its_closed_form() {
    let (kn, dt) = (1e6, 1e-6);
    let (mut duel, mass) = head_on(kn, 1.0, dt);
    // ½ (m/2) v² = ⅓ k δ³ at the turning point, v = 1; there and back takes 2 δ/v ∫₀¹ du/√(1 − u³).
    let deepest = (0.75 * mass / kn).cbrt();
    let duration = 2.0 * deepest * 1.402_182_105_325_454;
    let (mut overlap, mut force, mut steps) = (0.0_f64, 0.0_f64, 0.0);
    loop {
        duel.step();
        steps += 1.0;
        if duel.overlap() <= 0.0 {
            break;
        }
        overlap = overlap.max(duel.overlap());
        force = force.max(duel.balls[1].force[0]);
    }
    // Verlet with 40,000 steps per contact; the duration in whole steps.
    assert!((overlap / deepest - 1.0).abs() < 1e-6, "{overlap} {deepest}");
    assert!((force / (kn * deepest * deepest) - 1.0).abs() < 2e-6, "{force}");
    assert!((steps * dt / duration - 1.0).abs() < 1e-4, "{} {duration}", steps * dt);
    assert!((duel.balls[1].motion.velocity[0] - 0.5).abs() < 1e-6);
    let energy = duel.law.normal.energy(&at(deepest), &[]);
    assert!((energy / (0.25 * mass) - 1.0).abs() < 1e-12, "{energy}");
    assert!((duel.law.normal.tangent(&at(deepest)) / (2.0 * kn * deepest) - 1.0).abs() < 1e-9);
}

/// A contact of this overlap.
fn at(overlap: f64) -> Geometry {
    Geometry::of_spheres([2.0 - overlap, 0.0, 0.0], [1.0; 2], [1.0; 2], 0.0).unwrap()
}

#[test]
fn its_damping_is_that_of_a_restitution() {
    for restitution in [0.3, 0.7] {
        let (mut duel, _) = head_on(1e6, restitution, 1e-5);
        duel.law.limit_damping = false;
        duel.step();
        while duel.overlap() > 0.0 {
            duel.step();
        }
        let left = 2.0 * duel.balls[1].motion.velocity[0];
        assert!((left - restitution).abs() < 1e-3, "{left} {restitution}");
    }
}
