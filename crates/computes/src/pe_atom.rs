//! compute pe/atom: potential energy of each particle.

use super::{Compute, ComputeStyle, EnergyTerms, Terms};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{MASK, TALLY};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct PeAtom;

impl Style for PeAtom {
    fn name(&self) -> &'static str {
        "pe/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(EnergyTerms::GRAMMAR),
            summary: "Potential energy of each particle.",
            text: "Per-atom vector, in energy units (energy density for peridynamic particles in LAMMPS' convention): \
                   half of the energy of each pair goes to either particle. Without terms all count, with terms only those named. No \
                   fix but `fix external` has energies per particle. 0 outside the group.",
            example: "compute w all pe/atom",
        }
    }
}

impl ComputeStyle for PeAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let terms = read::<EnergyTerms>(args, cx)?.chosen();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, terms }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    terms: Terms,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, Terms { pair, bond, fix }) = (self.group, self.terms);
        let any = pair || bond || fix;
        if any {
            cx.request_atom_energy(when);
        }
        Ok(fill(&self.id, &Wanted { slot, stage, when }, TALLY | MASK, move |w, t, out| {
            let tally = &w.tally;
            if any && (tally.step.is_some_and(|s| s != t.step) || (tally.step.is_some() && !tally.with_atoms))
            {
                return fail(
                    Code::WRONG_ORDER,
                    None,
                    format!("energies per particle are not known at step {}", t.step),
                );
            }
            let of = |yes: bool, list: &[f64], i: usize| {
                if yes { list.get(i).copied().unwrap_or(0.0) } else { 0.0 }
            };
            let bonded = |i: usize| of(pair, &tally.atom, i) + of(bond, &tally.bond_atom, i);
            per_particle(w, group, out, |i| bonded(i) + of(fix, &tally.fix_atom, i));
            Ok(())
        }))
    }

    fn tallied(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn shares_of_pairs() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.tally.clear(0, false, true, 2);
        b.world.tally.atom = vec![1.5, 2.5];
        b.world.tally.fix_atom[1] = 4.0;
        b.world.particles.mask[0] = 0;
        for (words, second) in [("", 6.5), ("pair", 2.5), ("fix", 4.0)] {
            let c = b.compute(&PeAtom, words).unwrap();
            assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, second], "{words}");
        }
        let c = b.compute(&PeAtom, "").unwrap();
        b.world.tally.clear(0, false, false, 2);
        assert!(b.evaluate(&*c).is_err());
    }
}
