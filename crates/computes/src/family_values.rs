//! Computes of one number that peridynamic families know of each particle.

use super::Compute;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_peri::families::Families;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::{BuildCx, SealCx, Shape};
use perigrain_world::field::Fields;
use perigrain_world::{GroupId, SlotId, World};

/// What the families of a world know of the particle of an index, after they have been looked at.
type Value = for<'a> fn(&'a World, &'a Families) -> Box<dyn Fn(usize) -> f64 + Sync + 'a>;

/// A value that families of some pair styles know.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// The compute's name.
    pub name: &'static str,
    /// The pair styles that know it. `bond_style bpm/peri` knows whatever its laws know.
    pub by: &'static [&'static str],
    /// What it reads.
    pub reads: Fields,
    /// The value.
    pub value: Value,
}

/// The compute of this value: 0 before the first run and outside the group. It takes no further words.
///
/// # Errors
/// Further words; a scene without peridynamic particles.
pub(super) fn of_families(known: Known, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
    args.finish()?;
    super::need_bonds(known.name, cx)?;
    Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, span: cx.span, known }))
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    span: Span,
    known: Known,
}

impl Declared {
    /// Refuses scenes in which nobody knows the value, so that no zeros are taken for it.
    fn is_known(&self, cx: &dyn SealCx) -> Result<()> {
        let Known { name, by, .. } = self.known;
        let bonds = cx.bonds().is_some_and(|b| b.name() == "bpm/peri");
        if bonds || cx.pair_styles().iter().any(|style| by.contains(style)) {
            return Ok(());
        }
        let text = format!("compute `{}` ({name}): no pair style in force knows this value", self.id);
        let help = format!("{name} goes with pair_style {}", by.join(", "));
        Err(Diagnostic::error(Code::CONFLICT, self.span, text).help(help).into())
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        self.is_known(cx)?;
        let (group, value) = (self.group, self.known.value);
        Ok(fill(&self.id, &Wanted { slot, stage, when }, self.known.reads, move |w, _, out| {
            let value = w.families.as_ref().map(|f| value(w, f));
            per_particle(w, group, out, |i| value.as_ref().map_or(0.0, |value| value(i)));
            Ok(())
        }))
    }
}
