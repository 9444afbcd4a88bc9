//! compute dilatation/atom: the relative change of volume of each peridynamic particle.

use super::family_values::{Known, of_families};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::field::{FAMILIES, MASK, SITES};

/// The style.
pub struct DilatationAtom;

impl Style for DilatationAtom {
    fn name(&self) -> &'static str {
        "dilatation/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Dilatation of each particle of a state-based peridynamic body.",
            text: "Per-atom vector: θ of the latest force evaluation, without dimension (see pair_style peri/lps). 0 \
                   before the first run, for particles without a family, and outside the group. Needs `pair_style peri/lps`, \
                   `peri/ves` or `peri/eps`, or `bond_style bpm/peri`.",
            example: "compute swell all dilatation/atom",
        }
    }
}

impl ComputeStyle for DilatationAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let known = Known {
            name: self.name(),
            by: &["peri/lps", "peri/ves", "peri/eps"],
            reads: FAMILIES | SITES | MASK,
            value: |_, f| Box::new(|i| f.dilatation(i)),
        };
        of_families(known, args, cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // Values are compared with LAMMPS' in tests/lammps (pd_lps_wave).
    #[test]
    fn nothing_before_the_first_run_and_refused_without_bonds() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        let c = b.compute(&DilatationAtom, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 0.0]);
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(b.compute(&DilatationAtom, "").is_err());
    }
}
