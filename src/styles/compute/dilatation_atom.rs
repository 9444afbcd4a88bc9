//! compute dilatation/atom: the relative change of volume of each peridynamic particle.

use super::{Compute, ComputeStyle};
use crate::diag::Result;
use crate::lang::Args;
use crate::plan::{Op, Stage, When};
use crate::styles::step_op::{Wanted, fill, per_particle};
use crate::styles::{BuildCx, Doc, SealCx, Shape, Style};
use crate::world::families::Families;
use crate::world::{GroupId, SlotId};

/// The style.
pub struct DilatationAtom;

impl Style for DilatationAtom {
    fn name(&self) -> &'static str {
        "dilatation/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "compute ID group dilatation/atom",
            summary: "Dilatation of each particle of a state-based peridynamic body.",
            text: "Per-atom vector: θ of the latest force evaluation, without dimension (see pair_style peri/lps). 0 under \
                   peri/pmb, before the first run, for particles without a family, and outside the group.",
            example: "compute swell all dilatation/atom",
        }
    }
}

impl ComputeStyle for DilatationAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        state_of_particles("dilatation/atom", Families::dilatation, args, cx)
    }
}

/// A compute of what state-based families know of each particle.
pub(super) fn state_of_particles(
    name: &str,
    value: fn(&Families, usize) -> f64,
    args: &mut Args,
    cx: &BuildCx,
) -> Result<Box<dyn Compute>> {
    args.finish()?;
    super::need_bonds(name, cx)?;
    Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, value }))
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    value: fn(&Families, usize) -> f64,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, value) = (self.group, self.value);
        Ok(fill(&self.id, &Wanted { slot, stage, when }, "families mask", move |w, _, out| {
            per_particle(w, group, out, |i| w.families.as_ref().map_or(0.0, |f| value(f, i)));
            Ok(())
        }))
    }

    fn boxed(&self) -> Box<dyn Compute> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::AtomStyle;

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
