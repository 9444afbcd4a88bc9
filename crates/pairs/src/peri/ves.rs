//! `pair_style peri/ves`: the viscoelastic peridynamic solid, whose shear stiffness relaxes.

use super::lines::forms;
use super::start;
use crate::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_styles::words::{Form, Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, Style};
use std::sync::LazyLock;

/// The style.
pub struct PeriVes;

impl Style for PeriVes {
    fn name(&self) -> &'static str {
        "peri/ves"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "State-based viscoelasticity: a share of the shear stiffness relaxes.",
            text: "As `peri/lps`, but of the deviatoric extension e_d = e − θ|ξ|/3 the share `lambda` sits in a Maxwell \
                element: t_d = (15Gω/m) ((1 − λ) e_d + λ D), where D, the element's extension, follows dD/dt = de_d/dt − D/τ \
                (Mitchell 2011). A step takes e_d to change at a constant rate, which is exact: \
                D ← D exp(−dt/τ) + (τ/dt)(1 − exp(−dt/τ)) Δe_d. Where types differ in \
                lambda or tau each end of a bond relaxes by its own.\n\n\
                LAMMPS gives each end of a bond its own dilatation in place of both, so that ends pull with different \
                forces and momentum is not conserved; `compat lammps` does that too.\n\n\
                Units: lambda without dimension, from 0 to 1; tau time; the rest as in `peri/lps`, `peri_modify` too.",
            example: "pair_style peri/ves\npair_coeff * * 14.9e9 8.94e9 0.0015001 5.0e-4 0.25 0.5 1.0e-6",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::VES.style(), Grammar::NONE, false));

impl PairStyle for PeriVes {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/ves", law::VES, cx)
    }
}
