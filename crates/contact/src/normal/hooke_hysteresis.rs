//! `hooke/hysteresis E eta nu V stiffen stick phi`: grains that yield, linear in every branch (Luding 2008,
//! doi 10.1007/s10035-008-0099-x, eq. 6; LIGGGHTS manual, gran_model_hooke_hysteresis; branches measured with LIGGGHTS 3.8.0).
//!
//! With k_1 of `hooke/velocity`, K = stiffen k_1, k_c = stick k_1, the largest overlap δ_m of the contact, at most
//! δ* = 2 φ R̄ K/(K − k_1), and k_2 = k_1 + (K − k_1) δ_m/δ*, the force is
//!
//! ```text
//! loading              k_1 δ                 where δ ≥ δ_m, up to δ*
//! unloading, reloading k_2 (δ − δ_0)         δ_0 = (1 − k_1/k_2) δ_m; beyond δ* this line with k_2 = K both ways
//! sticking             −k_c δ                where the line lies below: there δ_m falls so that the line passes through the force
//! ```
//!
//! The history of a contact is δ_m.

use super::hooke_velocity::{HookeVelocity, VELOCITY};
use super::{Bound, Geometry, NormalLaw, Number, Push, Real, Role, Style};

/// The style.
pub const HOOKE_HYSTERESIS: Style = Style {
    name: "hooke/hysteresis",
    numbers: &[
        Number::YOUNG,
        Number::ETA,
        Number::POISSON,
        VELOCITY,
        Number {
            word: "stiffen",
            name: "the ratio K/k_1",
            bound: Bound::Where {
                ok: |ratio| ratio > 1.0,
                wrong: "unloading at most K/k_1 times as stiff as loading needs K/k_1 above 1, {} is not",
                help: Some("hooke/velocity is the law of grains that do not yield"),
            },
            role: Role::Own,
        },
        Number::own("stick", "the ratio k_c/k_1", Role::Own),
        Number { word: "phi", name: "the plasticity depth phi", bound: Bound::Positive, role: Role::Own },
    ],
    formula: "Grains that yield, linear in every branch, below.",
    text: include_str!("hooke_hysteresis.md"),
    exponent: |_| 1.0,
    pulls: |numbers| numbers[5] > 0.0,
    force: |pair| {
        let [_, _, _, velocity, stiffen, stick, depth, ..] = pair.numbers;
        let loading = HookeVelocity { young: pair.young, velocity };
        HookeHysteresis { loading, stiffen, stick, depth }.into()
    },
    ..Style::PUSHES
};

/// Loading, unloading and sticking branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HookeHysteresis {
    /// k_1 δ.
    loading: HookeVelocity,
    /// K/k_1.
    stiffen: f64,
    /// k_c/k_1.
    stick: f64,
    /// φ.
    depth: f64,
}

impl HookeHysteresis {
    /// δ*/R̄.
    fn reach(&self) -> f64 {
        2.0 * self.depth * self.stiffen / (self.stiffen - 1.0)
    }

    /// k_2 at the largest overlap `most`, and dk_2/dδ_m.
    #[inline(always)]
    fn unloading<R: Real>(&self, loading: R, curvature: R, most: R) -> [R; 2] {
        let rise = loading * (self.stiffen - 1.0) / (curvature * self.reach());
        [loading + rise * most, rise]
    }
}

impl NormalLaw for HookeHysteresis {
    const BY_RADIUS: bool = false;
    const BY_MASS: bool = true;
    const FLOWS: bool = true;
    const MEMORY: usize = 1;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, memory: &mut [R]) -> Push<R> {
        let zero = g.overlap.like(0.0);
        let depth = g.overlap.most(zero);
        let loading = self.loading.stiffness(g.curvature, g.mass);
        let most = memory[0].most(depth).least(g.curvature * self.reach());
        let [unloading, rise] = self.unloading(loading, g.curvature, most);
        let line = unloading * depth - rise * most * most;
        let pull = -(loading * depth * self.stick);
        let apart = pull.above(line);
        // k_2 (δ − δ_0) = −k_c δ, solved for δ_m.
        let square = depth * depth + loading * depth * (4.0 * (1.0 + self.stick)) / rise;
        let fallen = (depth + square.sqrt()) * 0.5;
        memory[0] = R::choose(apart, fallen, most);
        Push { force: R::choose(apart, pull, line), secant: loading, hold: zero }
    }

    /// The energy of the unloading branch between δ and δ_0.
    fn energy(&self, g: &Geometry, memory: &[f64]) -> f64 {
        let depth = g.overlap.max(0.0);
        let loading = self.loading.stiffness(g.curvature, g.mass);
        let most = memory[0].max(depth).min(g.curvature * self.reach());
        let [unloading, rise] = self.unloading(loading, g.curvature, most);
        let line = unloading * depth - rise * most * most;
        0.5 * line * line / unloading
    }

    /// K, the stiffness of the steepest branch.
    fn tangent(&self, g: &Geometry) -> f64 {
        self.stiffen * self.loading.stiffness(g.curvature, g.mass)
    }

    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
        Some([self.stiffen * self.loading.stiffness(curvature, mass), 1.0])
    }
}
