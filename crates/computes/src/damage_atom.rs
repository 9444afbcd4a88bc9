//! compute damage/atom: the fraction of each particle's family volume that it has lost.

use super::family_values::{Known, of_families};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::field::{FAMILIES, MASK, VOLUME};

/// The style.
pub struct DamageAtom;

impl Style for DamageAtom {
    fn name(&self) -> &'static str {
        "damage/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Damage of each peridynamic particle, from 0 (whole) to 1 (every bond broken).",
            text: "Per-atom vector: φ_i = 1 − Σ V_j over the live bonds / Σ V_j over the family at the first run \
                   (Silling & Askari 2005, equation 29), with plain volumes, without the partial-volume weights of the \
                   force. 0 for particles that never had a bond, before the first run, and outside the group. Needs a pair style \
                   `peri/…` or `bond_style bpm/peri`.",
            example: "compute broken all damage/atom",
        }
    }
}

impl ComputeStyle for DamageAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let known = Known {
            name: self.name(),
            by: &[
                "peri/pmb",
                "peri/pmb/plastic",
                "peri/pmb/softening",
                "peri/lps",
                "peri/ves",
                "peri/eps",
                "peri/cauchy",
            ],
            reads: FAMILIES | VOLUME | MASK,
            value: |w, f| {
                let damages = f.damages(w.volumes());
                Box::new(move |i| damages.of(i))
            },
        };
        of_families(known, args, cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_peri::families::{Bounds, Families, FamilyOptions, PeriView, PmbCoeff, PmbTable};
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn lost_volume_over_all_volume() {
        let places = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &places);
        let c = b.compute(&DamageAtom, "").unwrap();
        b.world.particles.volume = vec![1.0, 2.0, 6.0].into();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 1.2, s00: 1.0, alpha: 0.0 }).unwrap();
        let p = &b.world.particles;
        let bounds = Bounds { lo: [-10.0; 3], hi: [10.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let view = PeriView { x: &p.x, x0: &p.x0, kind: &p.kind, volume: &p.volume, bounds, excluded: None };
        let mut families = Families::build(&view, &table, FamilyOptions::new(1.0)).unwrap();
        // Only 1-2 and 1-3 are within 1.2; the bonds of particle 2 end with it: 2 of 8 volumes lost.
        families.remap(&[Some(0), None, Some(1)]);
        b.world.particles.gather(&[0, 2]);
        b.world.families = Some(families).into();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.25, 0.0]);
        b.world.particles.mask[0] = 0;
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 0.0]);
    }

    // Broken bonds are compared with LAMMPS' damage in tests/lammps.
    #[test]
    fn whole_before_the_first_run_and_refused_without_bonds() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        let c = b.compute(&DamageAtom, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 0.0]);
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(b.compute(&DamageAtom, "").is_err());
    }
}
