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
            text: "With e the change of length of a bond of reference length |ξ|, ω its influence and w the partial volume \
                weight, a particle has the weighted volume m = Σ ω w |ξ|² V_j of its family at the first run and the \
                dilatation θ = (3/m) Σ ω w |ξ| e V_j. Each end of a bond acts along it with the force density \
                t = ω w (3Kθ |ξ|/m + 15G (e − θ|ξ|/3)/m), and a particle feels t of both ends times V_j \
                (Silling et al. 2007). m keeps its value when bonds break, as in LAMMPS; the extension of a broken bond is \
                free, so that breaking never makes energy: θ = (3/m) Σ ω w |ξ| e V_j/D over living bonds, D = φ + (1 − φ) \
                3K/(5G), φ being their share of m (`compat lammps`: D = 1, which may make energy where ν is not 1/4). `K` and \
                `G` belong to particles: between two types each end has its own, from `pair_coeff i i`; the line of the \
                pair itself gives horizon, s00 and alpha. Bonds break, and close particles repel each other, as under \
                `peri/pmb` with c = 18K/(πδ⁴).\n\n\
                The energy density is ½Kθ² + ½(15G/m) Σ ω w (e − θ|ξ|/3)² V_j; it and the kinetic energy add up to a \
                constant while no bond breaks. LAMMPS counts half of the second term (so does `compat lammps`).\n\n\
                Units: K and G pressure; the rest as in `peri/pmb`. A `material` gives K and G from E and ν, and \
                s00 = √(G_c/((3G + (3/4)⁴(K − 5G/3)) δ)) (Madenci & Oterkus 2014), and makes forces true forces. \
                `influence` is 1/|ξ| (`inverse`, as LAMMPS), `one` or exp(−|ξ|²/δ²) (`gaussian`).\n\n\
                Where families are cut off by a surface, m makes up for the growth of a body and too much for a pull along \
                the surface: a bar of ten particles across it is 16 % too stiff in tension (at ν = 1/4 as much as `peri/pmb` \
                under `surface energy`). `peri_modify surface tensor` and `horizon own` as under `peri/pmb`: with \
                `volume full` bars of four particles and more across have E to 1 %. Under `horizon own` a bond has the mean of ω over \
                the weighted volume of a whole ball of each horizon.",
            example: "pair_style peri/lps\npair_coeff * * 14.9e9 8.94e9 0.0015001 5.0e-4 0.25",
        }
    }
}

impl PairStyle for PeriLps {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        start("peri/lps", law::LPS, cx)
    }
}
