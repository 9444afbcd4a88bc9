//! `pair_style peri/lps`: the linear peridynamic solid, ordinary state-based.

use super::start;
use crate::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct PeriLps;

impl Style for PeriLps {
    fn name(&self) -> &'static str {
        "peri/lps"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "pair_style peri/lps\n\
                     pair_coeff i j K G horizon s00 alpha\n\
                     pair_coeff i j material ID horizon H [s00 value] [alpha value]\n\
                     pair_coeff i j mix arithmetic|harmonic|geometric\n\
                     peri_modify [force density|newton] [volume lammps|none|full] [influence inverse|one|gaussian] [surface no|tensor] [horizon lattice|own] [broken compress no|yes] [nofail region ID]… [repulsion yes|no] [family exclude|broken]",
            ),
            summary: "State-based peridynamics: linear elastic solids of any Poisson's ratio, with bonds that break.",
            text: include_str!("lps.md"),
            example: "pair_style peri/lps\npair_coeff * * 14.9e9 8.94e9 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for PeriLps {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/lps", law::LPS, cx)
    }
}
