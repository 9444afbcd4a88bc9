//! `pair_style peri/pmb`: bond-based peridynamics with the prototype microelastic brittle model.

use super::start;
use crate::{Pair, PairStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_peri::law;
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct PeriPmb;

impl Style for PeriPmb {
    fn name(&self) -> &'static str {
        "peri/pmb"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "pair_style peri/pmb\n\
                     pair_coeff i j c horizon s00 alpha\n\
                     pair_coeff i j material ID horizon H [form bulk|shear|young] [s00 value] [alpha value]\n\
                     pair_coeff i j mix arithmetic|harmonic|geometric\n\
                     peri_modify [force density|newton] [volume lammps|none|full] [calibrate no|bulk|young] [influence one|inverse|gaussian] [surface no|energy|tensor] [horizon lattice|own] [broken compress no|yes] [nofail region ID]… [repulsion yes|no] [family exclude|broken]",
            ),
            summary: "Bond-based peridynamics: elastic bonds that break when stretched too far.",
            text: include_str!("pmb.md"),
            example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for PeriPmb {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/pmb", law::PMB, cx)
    }
}
