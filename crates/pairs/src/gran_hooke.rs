//! `pair_style gran/hooke`: the older granular style, one model for all pairs of types.

use super::contact::classic::Line;
use super::{Pair, PairStyle, granular};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Form, Grammar, Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct GranHooke;

impl Style for GranHooke {
    fn name(&self) -> &'static str {
        "gran/hooke"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", Grammar::NONE)] },
            ),
            summary: "Contacts of spheres: linear spring, damping, Coulomb friction without memory.",
            text: "F_n = Kn δ − m̄ gamma_n v_n along the normal for an overlap δ > 0, m̄ = m_i m_j/(m_i + m_j); across \
                   it F_t = −m̄ gamma_t v_t, at most xmu F_n and nothing where F_n pulls (`compat lammps`: xmu |F_n|). Kt has no meaning here.\n\n`pair_coeff` and `arms` are as under pair_style gran/hooke/history.",
            example: "pair_style gran/hooke 200000.0 NULL 50.0 NULL 0.5 1\npair_coeff * *",
        }
    }
}

impl PairStyle for GranHooke {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        granular::classic(self.name(), false, false, args, cx)
    }
}
