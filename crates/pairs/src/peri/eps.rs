//! `pair_style peri/eps`: the elastic, perfectly plastic peridynamic solid.

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
pub struct PeriEps;

impl Style for PeriEps {
    fn name(&self) -> &'static str {
        "peri/eps"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "State-based plasticity: solids that flow at a yield stress (von Mises, no hardening).",
            text: "As `peri/lps`, but each end of a bond has a plastic extension e_p, and t_d = (15Gω/m)(e − θ|ξ|/3 − e_p). \
                Where the norm √(Σ t_d² w V_j) of a particle exceeds its limit, all its t_d are scaled back to the limit \
                and e_p takes up the rest (radial return; Mitchell 2011). The limit is the norm in simple shear at \
                `yield`/√3, reckoned for the particle's own family: √(5 Σ ω² w |ξ|² V_j) yield/m; for a whole ball and ω = 1 \
                its square is twice 25 yield²/(8πδ⁵). `compute plasticity/atom` has the plastic multiplier.\n\n\
                LAMMPS' return (its norm has θ in it, and what is elastic again forgets e_p) diverges soon after the \
                onset of flow; `compat lammps` follows it nonetheless.\n\n\
                Units: yield is a pressure; the rest as in `peri/lps`, `peri_modify` too.",
            example: "pair_style peri/eps\npair_coeff * * 14.9e9 8.94e9 0.0015001 0.02 0.25 2.0e8",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::EPS.style(), Grammar::NONE, false));

impl PairStyle for PeriEps {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/eps", law::EPS, cx)
    }
}
