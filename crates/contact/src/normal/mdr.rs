//! `mdr E nu Y gamma psi_b e` (Zunker & Kamrin 2024): plastic grains; the contact histories hold the results
//! of [`crate::mdr`].

use super::hertz::Hertz;
use super::{Bound, Geometry, Normal, NormalLaw, Number, Push, Real, Role, Style};
use crate::mdr::{Material, PRECOMPUTED};

/// The style.
pub const MDR: Style = Style {
    name: "mdr",
    numbers: &[
        Number::YOUNG,
        Number {
            bound: Bound::Where {
                ok: |nu| (0.0..0.5).contains(&nu),
                wrong: "Poisson's ratio of `mdr` is at least 0 and below 0.5, {} is not",
                help: Some("at 0.5 the bulk modulus E/(3 (1 - 2 nu)) is infinite"),
            },
            ..Number::POISSON
        },
        Number { word: "Y", name: "the yield stress Y", bound: Bound::Positive, role: Role::Own },
        Number::GAMMA,
        Number {
            word: "psi_b",
            name: "psi_b",
            bound: Bound::Where {
                ok: |psi| (0.0..=1.0).contains(&psi),
                wrong: "psi_b is a part of the surface, between 0 and 1: {} is not",
                help: None,
            },
            role: Role::Own,
        },
        Number::own("e", "the damping coefficient", Role::Eta),
    ],
    formula: "Plastic grains, below.",
    text: include_str!("mdr.md"),
    in_grains: true,
    force: |pair| Mdr { elastic: Hertz { stiffness: 4.0 / 3.0 * pair.young } }.into(),
    ..Style::PUSHES
};

/// The material of plastic grains; `None` for other models.
pub fn material(normal: &Normal) -> Option<Material> {
    let [young, poisson, yield_stress, cohesion, confinement, ..] = *normal.numbers();
    normal.in_grains().then_some(Material { young, poisson, yield_stress, cohesion, confinement })
}

/// The parameters that belong to the grain alone: E, ν, Y, ψ_b and restitution.
pub fn grain(normal: &Normal) -> Option<[f64; 5]> {
    let m = material(normal)?;
    Some([m.young, m.poisson, m.yield_stress, m.confinement, normal.eta()])
}

/// The force stored in the history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mdr {
    /// An elastic grain with this overlap, for the time step.
    elastic: Hertz,
}

impl NormalLaw for Mdr {
    const IS_PRECOMPUTED: bool = true;
    const FLOWS: bool = true;
    const MEMORY: usize = PRECOMPUTED;

    #[inline(always)]
    fn push<R: Real>(&self, g: &Geometry<R>, _a: R, memory: &mut [R]) -> Push<R> {
        let zero = g.overlap.like(0.0);
        Push { force: memory[0], secant: memory[1], hold: zero }
    }

    /// Energy that both sides return if they unload now; available if an energy ledger is kept.
    fn energy(&self, _g: &Geometry, memory: &[f64]) -> f64 {
        memory[PRECOMPUTED - 1]
    }

    /// The stiffness of elastic grains with this overlap.
    fn tangent(&self, g: &Geometry) -> f64 {
        self.elastic.tangent(g)
    }

    fn power_law(&self, curvature: f64, mass: f64) -> Option<[f64; 2]> {
        self.elastic.power_law(curvature, mass)
    }
}
