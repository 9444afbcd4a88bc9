//! `pair_style gran/hertz/history`: the older granular style, one model for all pairs of types.

use super::contact::classic::Line;
use super::{Pair, PairStyle, granular};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Form, Grammar, Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct GranHertzHistory;

impl Style for GranHertzHistory {
    fn name(&self) -> &'static str {
        "gran/hertz/history"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", Grammar::NONE)] },
            ),
            summary: "Contacts of spheres: Hertz along the normal, a spring across it, damping, friction.",
            text: "F_n = a (Kn δ − m̄ gamma_n v_n) along the normal for an overlap δ > 0, a = √(δ R_i R_j/(R_i + R_j)), \
                   m̄ = m_i m_j/(m_i + m_j); across it F_t = −a (Kt ξ + m̄ gamma_t v_t), at most xmu F_n and nothing where F_n pulls (`compat lammps`: xmu |F_n|). ξ is the \
                   slip accumulated while the contact lasts, without its part along the normal, and shortened to what \
                   slides. Kn is 4G/(3(1−ν)) for equal materials, Kt 4G/(2−ν).\n\n`pair_coeff` and `arms` are as under pair_style gran/hooke/history.",
            example: "pair_style gran/hertz/history 1.0e7 NULL 1.0e5 NULL 0.5 1\npair_coeff * *",
        }
    }
}

impl PairStyle for GranHertzHistory {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        granular::classic(self.name(), true, true, args, cx)
    }
}
