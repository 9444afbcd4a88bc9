//! `pair_style peri/pmb/plastic`: bonds that flow in compression.

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
pub struct PeriPmbPlastic;

impl Style for PeriPmbPlastic {
    fn name(&self) -> &'static str {
        "peri/pmb/plastic"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "Bond-based peridynamics whose bonds are perfectly plastic in compression.",
            text: "As `peri/pmb`, but a bond never pushes with more than c |syc| (Walayat et al. 2023, equation 6); `syc` is a \
                stretch below zero. The paper does not say what happens on the way back. `plastic` (the default): the bond \
                remembers what has flowed, its force is c (s − s_p), and s_p follows so that s − s_p never falls below syc; \
                after unloading the bond is left shorter. `nonlinear`: the force is a function of the present stretch, \
                c max(s, syc). One rule holds for all pairs. Breaking looks at the whole stretch s.\n\n\
                perigrain's own style; options of `peri_modify` as under `peri/pmb`, but for `influence`. Bodies of one type and one volume on a \
                lattice run fast, all others as lists.",
            example: "pair_style peri/pmb/plastic\npair_coeff * * 1.6863e22 0.0015001 5.0e-4 0.25 -0.002",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::PLASTIC.style(), Grammar::NONE, false));

impl PairStyle for PeriPmbPlastic {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/pmb/plastic", law::PLASTIC, cx)
    }
}
