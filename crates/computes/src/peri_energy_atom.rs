//! compute peri/energy/atom: the strain energy of each peridynamic particle.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_peri::families::ForceUnit;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{FAMILIES, MASK, TALLY, VOLUME};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct PeriEnergyAtom;

impl Style for PeriEnergyAtom {
    fn name(&self) -> &'static str {
        "peri/energy/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Elastic energy of each peridynamic particle, in units of energy.",
            text: "Per-atom vector, always an energy: where LAMMPS' convention makes forces and energies densities (coefficients given as numbers, \
                   `peri_modify force density`) the density times the particle's volume. Bonds count half for each end, \
                   short-range repulsion too; the dilatation of state-based laws counts for its own particle. With true \
                   forces the same as `compute pe/atom pair`. 0 for particles without a volume and outside the group.",
            example: "compute e all peri/energy/atom",
        }
    }
}

impl ComputeStyle for PeriEnergyAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        super::need_bonds("peri/energy/atom", cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let group = self.group;
        cx.request_atom_energy(when);
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            TALLY | FAMILIES | VOLUME | MASK,
            move |w, t, out| {
                let tally = &w.tally;
                if tally.step.is_some_and(|s| s != t.step || !tally.with_atoms) {
                    let text = format!("energies per particle are not known at step {}", t.step);
                    return fail(Code::WRONG_ORDER, None, text);
                }
                let Some(families) = &*w.families else {
                    per_particle(w, group, out, |_| 0.0);
                    return Ok(());
                };
                let densities = families.options.unit == ForceUnit::Density;
                let volumes = w.volumes();
                let volume = |i: usize| if densities { volumes[i] } else { 1.0 };
                per_particle(w, group, out, |i| tally.atom.get(i).map_or(0.0, |e| e * volume(i)));
                Ok(())
            },
        ))
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

    // The energies are tested in tests/scripts/good/peri_measures.in.
    #[test]
    fn nothing_before_the_first_run_and_refused_without_bonds() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        let c = b.compute(&PeriEnergyAtom, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 0.0]);
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(b.compute(&PeriEnergyAtom, "").is_err());
    }
}
