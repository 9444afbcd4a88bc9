//! `pair_style gran/hooke/history`: the older granular style, one model for all pairs of types.

use super::contact::classic::Line;
use super::{Pair, PairStyle, granular};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Form, Grammar, Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct GranHookeHistory;

impl Style for GranHookeHistory {
    fn name(&self) -> &'static str {
        "gran/hooke/history"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", Grammar::NONE)] },
            ),
            summary: "Contacts of spheres: linear springs along and across the normal, damping, friction.",
            text: "F_n = Kn δ − m̄ gamma_n v_n along the normal for an overlap δ > 0, m̄ = m_i m_j/(m_i + m_j); across \
                   it F_t = −Kt ξ − m̄ gamma_t v_t, at most xmu F_n and nothing where F_n pulls (`compat lammps`: xmu |F_n|). ξ is the slip accumulated while the contact \
                   lasts, without its part along the normal, and shortened to what slides.\n\n`arms radius`, LAMMPS' arms of friction, are both together longer than the distance of the \
                   centres by the overlap δ, so that friction turns a pair by F_t δ out of nothing: an oblique impact with overlaps of \
                   10 % of the radius changes the angular momentum by 6 %, one 100 times as stiff by 0.6 %. With `arms middle` \
                   angular momentum is kept to rounding.\n\n`pair_coeff I J` has no words \
                   of its own but must name all types. As a sub-style of hybrid it acts between the types it was named \
                   for. What `fix freeze` holds counts as infinitely heavy.\n\npair_style granular has the same force \
                   with `hooke … damping mass_velocity tangential linear_history_classic` and `hertz … tangential \
                   mindlin_classic`, but with arms that end in the middle of the overlap.",
            example: "pair_style gran/hooke/history 200000.0 NULL 50.0 NULL 0.5 0\npair_coeff * *",
        }
    }
}

impl PairStyle for GranHookeHistory {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        granular::classic(self.name(), false, true, args, cx)
    }
}
