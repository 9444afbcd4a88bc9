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
    formula: "plastic grains, below",
    text: "`mdr` (Zunker & Kamrin 2024, doi 10.1016/j.jmps.2023.105492 and .105493; 2025, doi 10.31224/4289) is for powders \
           under pressure: grains that yield, flow and grow. Each grain is pressed by a rigid plane through the circle \
           in which the spheres cut each other; the force is the mean of both sides. Elastic, it is Hertz' with \
           E_c = E/(1−ν²). Where Hertz' mean pressure reaches the hardness p_Y = Y (1.75 exp(−4.4 δ/R) + 1) the grain \
           yields, and from then on F = p_Y π a², a² = 2δR − δ² + δ_Y² − δ_Y R, while the contact gets deeper. Unloading is \
           that of a plane on springs under an ellipse of height 2 p_Y a/E_c; with `gamma` the surfaces stick as \
           those of Johnson, Kendall & Roberts, but no contact reaches beyond δ = 0. What flow displaces raises the \
           whole free surface: the radius of a grain grows (its mass stays). Where the free part of its surface falls below \
           `psi_b` (0 … 1; 0: never) the grain grows no more, and the mean approach of all its planes \
           squeezes it with the bulk modulus E/(3 (1−2ν)). A contact that reaches through a third grain pushes less. All \
           grains have the same numbers; walls too, but for `gamma`, and LAMMPS wants those of fix wall/gran/region. \
           `damping none` or `damping mdr` goes with it: η = e √(m̄ k) with k = 2 E_c (a_i + a_j), on walls E_c a/2 (`1`), or η = e \
           (`2`). Friction takes a = √(R̄ δ) as everywhere. Decks can read `d_Ro` (first radius), `d_Velas`, \
           `d_Acon1` (area of contact), `d_psi`, `d_eps_bar`, `d_sigmaxx` `…yy` `…zz` (mean stress, also `…xy` `…xz` `…yz`) and others of LAMMPS' \
           names by compute property/atom, dump or formula. Heat, `average` and `curvature` do not go with it. Large overlaps are what it is made for.",
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

    fn power_law(&self, curvature: f64) -> Option<[f64; 2]> {
        self.elastic.power_law(curvature)
    }
}
