//! `fix extremes`: the smallest and largest value that quantities have had so far.

use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Param};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{MEMO, SLOTS};
use perigrain_world::{Key, Numbers, SlotId, World};

/// The style.
pub struct ExtremesStyle;

impl Style for ExtremesStyle {
    fn name(&self) -> &'static str {
        "extremes"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Remembers the smallest and the largest value of quantities, looked at every N steps.",
            text: "`f_ID[2k-1]` is the smallest and `f_ID[2k]` the largest value the k-th quantity has had since the \
                   fix was declared; several runs count as one. The group is without meaning. Not in LAMMPS.",
            example: "fix peak all extremes 1 v_force",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Looks at the start of a run and at multiples of N [steps].
    #[word(name = "N", what = "the number of steps between two looks", from = 1)]
    every: i64,
    /// Single numbers: `v_name`, `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`.
    #[word(name = "value", with = quantity, kind = Kind::Value, least = 1)]
    values: Vec<Param>,
}

fn quantity(args: &mut Args, cx: &BuildCx) -> Result<Param> {
    let (span, value) = (args.here(), args.param("a value such as v_name or c_ID")?);
    if matches!(value, Param::Number(_)) {
        return fail(Code::WRONG_KIND, span, "a number has no extremes: name a value");
    }
    cx.param(&value, false)?;
    Ok(value)
}

impl FixStyle for ExtremesStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, values } = read(args, cx)?;
        Ok(Box::new(Extremes { id: cx.id.to_string(), every, values }))
    }
}

/// A declared fix.
#[derive(Clone)]
struct Extremes {
    id: String,
    every: i64,
    values: Vec<Param>,
}

impl Extremes {
    fn memo(&self) -> Numbers {
        Key::new(&format!("extremes/{}", self.id))
    }
}

impl Fix for Extremes {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, ..Facts::default() }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every).or(When::First);
        let readings = self.values.iter().map(|p| cx.param(p, Stage::EndOfStep, &when));
        Ok(vec![Box::new(Watch {
            name: format!("fix {} extremes", self.id),
            memo: self.memo(),
            when: when.clone(),
            readings: readings.collect::<Result<_>>()?,
            slot: cx.slot(&format!("f_{}", self.id)),
        })])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        let none = [f64::INFINITY, f64::NEG_INFINITY].repeat(self.values.len());
        w.memo.insert(self.memo(), none);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.memo());
    }

    fn shape(&self) -> Shape {
        Shape { vector: 2 * self.values.len(), ..Shape::default() }
    }
}

/// The op that updates the extremes.
struct Watch {
    name: String,
    memo: Numbers,
    when: When,
    readings: Vec<Reading>,
    slot: SlotId,
}

impl Op for Watch {
    fn about(&self) -> About {
        let needs = Needs::new().read(SLOTS).write(SLOTS).keep(MEMO).only(&[self.memo.text()]);
        About { when: self.when.clone(), in_setup: true, ..About::new(&self.name, Stage::EndOfStep, needs) }
    }

    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let mut known = w.memo.remove(self.memo).unwrap_or_default();
        widen(&mut known, self.readings.iter().map(|r| r.get(w)));
        let mut slot = w.slots.take(self.slot);
        slot.vector.clone_from(&known);
        w.slots.put(self.slot, slot, t.step);
        w.memo.insert(self.memo, known);
        Ok(())
    }
}

/// Extends each pair (smallest, largest) of `known` by the next value.
fn widen(known: &mut [f64], values: impl Iterator<Item = f64>) {
    for (pair, v) in known.chunks_exact_mut(2).zip(values) {
        pair[0] = pair[0].min(v);
        pair[1] = pair[1].max(v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_take_in_values() {
        let mut known = [f64::INFINITY, f64::NEG_INFINITY].repeat(2);
        for v in [[1.0, -5.0], [3.0, -7.0], [2.0, -6.0]] {
            widen(&mut known, v.into_iter());
        }
        assert_eq!(known, [1.0, 3.0, -7.0, -5.0]);
    }
}
