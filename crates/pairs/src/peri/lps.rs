//! `pair_style peri/lps`: the linear peridynamic solid, ordinary state-based.

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
pub struct PeriLps;

impl Style for PeriLps {
    fn name(&self) -> &'static str {
        "peri/lps"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "State-based peridynamics: linear elastic solids of any Poisson's ratio, with bonds that break.",
            text: include_str!("lps.md"),
            example: "pair_style peri/lps\npair_coeff * * 14.9e9 8.94e9 0.0015001 5.0e-4 0.25",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::LPS.style(), Grammar::NONE, true));

impl PairStyle for PeriLps {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/lps", law::LPS, cx)
    }
}
