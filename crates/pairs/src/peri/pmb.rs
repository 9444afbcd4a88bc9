//! `pair_style peri/pmb`: bond-based peridynamics with the prototype microelastic brittle model.

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
pub struct PeriPmb;

impl Style for PeriPmb {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(*FORMS),
            summary: "Bond-based peridynamics: elastic bonds that break when stretched too far.",
            text: include_str!("pmb.md"),
            example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

static FORMS: LazyLock<&[Form]> = LazyLock::new(|| forms(law::PMB.style(), Grammar::NONE, true));

impl PairStyle for PeriPmb {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/pmb", law::PMB, cx)
    }
}
