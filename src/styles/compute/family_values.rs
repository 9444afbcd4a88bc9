//! Computes of one number that peridynamic families know of each particle.

use super::Compute;
use crate::diag::Result;
use crate::lang::Args;
use crate::plan::{Op, Stage, When};
use crate::styles::step_op::{Wanted, fill, per_particle};
use crate::styles::{BuildCx, SealCx, Shape};
use crate::world::families::Families;
use crate::world::{GroupId, SlotId, World};

/// What the families of a world know of the particle of an index.
type Value = fn(&World, &Families, usize) -> f64;

/// The compute of this value: 0 before the first run and outside the group. It takes no further words.
///
/// # Errors
/// Further words; a scene without peridynamic particles.
pub(super) fn of_families(
    name: &str,
    reads: &'static str,
    value: Value,
    args: &mut Args,
    cx: &BuildCx,
) -> Result<Box<dyn Compute>> {
    args.finish()?;
    super::need_bonds(name, cx)?;
    Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, reads, value }))
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    reads: &'static str,
    value: Value,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, value) = (self.group, self.value);
        Ok(fill(&self.id, &Wanted { slot, stage, when }, self.reads, move |w, _, out| {
            per_particle(w, group, out, |i| w.families.as_ref().map_or(0.0, |f| value(w, f, i)));
            Ok(())
        }))
    }

    fn boxed(&self) -> Box<dyn Compute> {
        Box::new(self.clone())
    }
}
