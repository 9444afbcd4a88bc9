//! compute pe: potential energy.

use super::{Compute, ComputeStyle, EnergyTerms, Terms};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::TALLY;
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct Pe;

impl Style for Pe {
    fn name(&self) -> &'static str {
        "pe"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(EnergyTerms::GRAMMAR),
            summary: "Potential energy of the whole scene.",
            text: "Scalar (extensive), in energy units. Without terms all count, with terms only those named; those that no \
                   style of the scene has are 0. The group is `all`. For peridynamic particles in LAMMPS' \
                   convention it is a sum of energy densities.",
            example: "compute bonds all pe pair",
        }
    }
}

impl ComputeStyle for Pe {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "compute pe must use the group `all`");
        }
        let terms = read::<EnergyTerms>(args, cx)?.chosen();
        Ok(Box::new(Declared { id: cx.id.to_string(), terms }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    terms: Terms,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let Terms { pair, bond, fix } = self.terms;
        if pair || bond {
            cx.request_energy(when);
        }
        let names = if fix { cx.energy_fixes() } else { vec![] };
        let fixes: Vec<SlotId> = names.iter().map(|n| cx.slot(n)).collect();
        Ok(fill(&self.id, &Wanted { slot, stage, when }, TALLY, move |w, t, out| {
            let mut energy = 0.0;
            if pair || bond {
                match w.tally.step {
                    Some(step) if step != t.step => {
                        return fail(
                            Code::WRONG_ORDER,
                            None,
                            format!("the energy is known for step {step}, not for step {}", t.step),
                        );
                    }
                    _ => {
                        energy += if pair { w.tally.pair } else { 0.0 };
                        energy += if bond { w.tally.bond } else { 0.0 };
                    }
                }
            }
            for &f in &fixes {
                energy += w.slots.get(f).scalar;
            }
            out.scalar = energy;
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
    fn pairs_and_fixes_that_count() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.world.tally.clear(0, false, false, 1);
        b.world.tally.pair = 3.0;
        let f = b.world.slots.id("f_ball");
        b.world.slots.get_mut(f).scalar = 0.5;
        b.energy_fixes = vec!["f_ball".to_string()];
        for (words, energy) in [("", 3.5), ("pair", 3.0), ("fix", 0.5), ("kspace", 0.0), ("pair fix", 3.5)] {
            let c = b.compute(&Pe, words).unwrap();
            assert_eq!(b.evaluate(&*c).unwrap().scalar, energy, "{words}");
        }
        assert!(b.compute(&Pe, "pairs").err().unwrap().0[0].help[0].contains("pair"));
        b.world.clock.step = 7;
        let c = b.compute(&Pe, "").unwrap();
        assert!(b.evaluate(&*c).is_err());
    }
}
