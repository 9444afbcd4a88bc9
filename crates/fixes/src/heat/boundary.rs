//! What fixes at the edges of a body have in common: a value that may be a variable, and the heat that they have brought.

use crate::{AtRest, Facts, Fix};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::publish;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{SealCx, Shape};
use perigrain_world::field::{FACTS, MASK, MEMO, SLOTS};
use perigrain_world::{Constant, GroupId, Key, Named, Numbers, World};

use super::MOVERS;

/// What a fix does to its particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Does {
    /// They have this temperature.
    #[default]
    Holds,
    /// Heat of so much power per area comes to them, over an area that they share evenly.
    Heats {
        /// The area.
        area: f64,
    },
    /// A fluid of this temperature takes or gives it.
    Cools {
        /// Heat per time, area and temperature.
        film: f64,
        /// The area, which they share evenly.
        area: f64,
    },
}

/// A fix at the edge of a body at the present step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boundary {
    /// The bit of its group.
    pub bit: u32,
    /// What it does.
    pub does: Does,
    /// The temperature, or the power per area.
    pub value: f64,
    /// The heat that it has brought in this step.
    pub brought: f64,
}

/// Those of the present step, by ID.
pub static BOUNDARIES: Constant<Named<Boundary>> = Constant::new("heat/boundaries");

/// A declared fix.
#[derive(Clone)]
pub struct Declared {
    pub style: &'static str,
    pub id: String,
    pub group: GroupId,
    pub does: Does,
    pub value: Param,
}

impl Declared {
    fn memo(&self) -> Numbers {
        Key::new(&format!("{}/{}", self.style, self.id))
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, slot, memo) = (cx.span(), cx.slot(&format!("f_{}", self.id)), self.memo());
        let value = cx.param(&self.value, Stage::InitialIntegrate, &When::Always)?;
        let (name, key) = (format!("fix {} {}", self.id, self.style), Key::new(&self.id));
        let (bit, does) = (self.group.bit(), self.does);
        let mut checked = false;
        let needs = Needs::new().read(SLOTS | MASK).write(FACTS);
        let enter = StepOp::new(&name, Stage::InitialIntegrate, needs, move |w, _| {
            if !checked {
                conducts(w, bit, span)?;
                checked = true;
            }
            let now = Boundary { bit, does, value: value.get(w), brought: 0.0 };
            w.facts.get_or_default(*BOUNDARIES).insert(key, now);
            Ok(())
        });
        let needs = Needs::new().read(FACTS).keep(MEMO).write(SLOTS).only(&[memo.text()]);
        let book = StepOp::new(name, Stage::EndOfStep, needs, move |w, t| {
            let brought = match t.setup {
                true => 0.0,
                false => w.facts.get(*BOUNDARIES).and_then(|all| all.get(key)).map_or(0.0, |b| b.brought),
            };
            let sum = w.memo.get_or(memo, || vec![0.0]);
            sum[0] += brought;
            let sum = sum[0];
            publish(w, slot, t, sum, &[]);
            Ok(())
        });
        Ok(vec![enter.in_setup(true).boxed(), book.in_setup(true).boxed()])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        w.memo.insert(self.memo(), vec![0.0]);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.memo());
        let key = Key::new(&self.id);
        w.facts.get_or_default(*BOUNDARIES).remove(key);
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, ..Facts::default() }
    }
}

/// Refuses a group without particles, and particles in which no fix conducts heat.
fn conducts(w: &World, bit: u32, span: Span) -> Result<()> {
    let all = w.facts.get(*MOVERS).into_iter().flat_map(Named::values);
    let solids = all.filter(|mover| mover.bonds).fold(0, |bits, mover| bits | mover.bit);
    let members = w.particles.mask.iter().filter(|mask| **mask & bit != 0);
    let (mut count, mut others) = (0, 0);
    for mask in members {
        count += 1;
        others += usize::from(mask & solids == 0);
    }
    if count == 0 {
        return Err(Diagnostic::error(Code::INCOMPLETE, span, "the group has no particles").into());
    }
    if others == 0 {
        return Ok(());
    }
    let text = format!("heat is conducted in {} of the {count} particles of the group", count - others);
    let d = Diagnostic::error(Code::INCOMPLETE, span, text);
    Err(d.help("write `fix ID GROUP heat/peri` for a group that has them").into())
}

/// The area of a line, which has to be there.
pub fn area(given: Option<f64>, args: &Args) -> Result<f64> {
    given.ok_or_else(|| {
        let d = Diagnostic::error(Code::MISSING_ARGUMENT, args.here(), "the area of the surface is missing");
        d.help("add `area A`: the particles of the group share it evenly").into()
    })
}
