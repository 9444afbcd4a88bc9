//! Computes with one value per particle from peridynamic families.

use super::Compute;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_peri::families::Families;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::{BuildCx, SealCx, Shape};
use perigrain_world::field::Fields;
use perigrain_world::{GroupId, SlotId, World};

/// Returns the function from particle index to value, for the current families.
type Value = for<'a> fn(&'a World, &'a Families) -> Box<dyn Fn(usize) -> f64 + Sync + 'a>;

/// A value that families of some pair styles provide.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// Name of the compute.
    pub name: &'static str,
    /// The pair styles that provide it. `bond_style bpm/peri` provides the values of its laws.
    pub by: &'static [&'static str],
    /// Fields it reads.
    pub reads: Fields,
    /// The value.
    pub value: Value,
}

/// The compute of this value: 0 before the first run and outside the group. It has no arguments.
///
/// # Errors
/// Extra arguments; a system without peridynamic particles.
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
    /// Refuses systems in which no style provides the value, so that it is not mistaken for zero.
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
