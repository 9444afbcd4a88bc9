//! compute plasticity/atom: plastic flow of each particle.

use super::family_values::{Known, of_families};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::field::{FAMILIES, MASK, SITES};

/// The style.
pub struct PlasticityAtom;

impl Style for PlasticityAtom {
    fn name(&self) -> &'static str {
        "plasticity/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Accumulated plastic flow of each particle under pair_style peri/eps or peri/cauchy.",
            text: "Per-atom vector. Under `pair_style peri/eps` the sum of Δλ = (m/15G)(norm/limit − 1) over the steps in which the particle has flowed, \
                   as LAMMPS defines it (volume²/force·length² with ω = 1/|ξ|). 0 before the first run and outside the group. \
                   Under `pair_style peri/cauchy` the equivalent plastic strain, without dimension. \
                   Needs one of the two or `bond_style bpm/peri`.",
            example: "compute flow all plasticity/atom",
        }
    }
}

impl ComputeStyle for PlasticityAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let known = Known {
            name: self.name(),
            by: &["peri/eps", "peri/cauchy"],
            reads: FAMILIES | SITES | MASK,
            value: |_, f| Box::new(|i| f.plastic_strain(i)),
        };
        of_families(known, args, cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // Values are compared with LAMMPS' at the onset of flow in tests/lammps (pd_eps_tension).
    #[test]
    fn nothing_before_the_first_run_and_refused_without_bonds() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        let c = b.compute(&PlasticityAtom, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 0.0]);
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(b.compute(&PlasticityAtom, "").is_err());
    }
}
