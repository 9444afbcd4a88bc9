//! fix vector: accumulates values over a run.

use super::window::forget;
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{GlobalValue, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{MEMO, SLOTS};
use perigrain_world::{Key, Numbers, Slot, World};

/// The style.
pub struct VectorFix;

impl Style for VectorFix {
    fn name(&self) -> &'static str {
        "vector"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Keeps single numbers every Nevery steps as a vector that grows.",
            text: "At multiples of Nevery, the start of the first run among them, each value adds an element: one value \
                   gives a vector, several an array with a row per time and a column per value. For formulas such as \
                   `trap(f_ID)`. The group means nothing.",
            example: "fix keep all vector 1 v_force v_speed",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Distance of the elements [steps].
    #[word(name = "Nevery", what = "Nevery", from = 1)]
    every: i64,
    /// What is kept: `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`, with ranges such as `[*]`, or `v_name`.
    #[word(name = "value", least = 1)]
    values: Vec<GlobalValue>,
    /// Only the last N elements are kept.
    #[word(keyword, name = "N", what = "the number of values to keep", from = 1)]
    nmax: Option<usize>,
}

impl FixStyle for VectorFix {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let (mut values, mut extensive) = (vec![], vec![]);
        for GlobalValue(word) in &line.values {
            for word in cx.expand(word, Wants::Number)? {
                let Some(r) = ValueRef::parse(&word.text, word.span)? else { continue };
                cx.value(&r, false)?;
                super::compatible(&r, &cx.shape(&r).unwrap_or_default(), line.every, "Nevery")?;
                extensive.push(cx.names.extensive(&r));
                values.push(r);
            }
        }
        if extensive.iter().any(|e| *e != extensive[0]) {
            let text = "values that grow with the scene and values that do not cannot share an array";
            return fail(Code::CONFLICT, cx.span, text);
        }
        let grows = extensive.contains(&true);
        Ok(Box::new(Declared { id: cx.id.to_string(), every: line.every, values, most: line.nmax, grows }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    every: i64,
    values: Vec<ValueRef>,
    most: Option<usize>,
    grows: bool,
}

impl Declared {
    fn key(&self) -> Numbers {
        Key::new(&format!("vector/{}", self.id))
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, counts_steps: true, ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let name = format!("f_{}", self.id);
        let slot = w.slots.id(&name);
        *w.slots.get_mut(slot) = Slot { name, array_cols: self.values.len(), ..Slot::default() };
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every);
        let mut readings = vec![];
        for r in &self.values {
            readings.push(cx.reading(r, Wants::Number, Stage::EndOfStep, &when)?);
        }
        let slot = cx.slot(&format!("f_{}", self.id));
        let (most, cols, key) = (self.most, self.values.len(), self.key());
        let (last, list) = (key.with("/last"), key.with("/list"));
        let access = Needs::new().read(SLOTS).write(SLOTS).keep(MEMO).only(&[last.text(), list.text()]);
        let op = StepOp::new(format!("fix {} vector", self.id), Stage::EndOfStep, access, move |w, t| {
            // The setup of a run may be at a step that the previous run has stored already.
            if w.memo.get(last).is_some_and(|s| s.first() == Some(&(t.step as f64))) {
                return Ok(());
            }
            w.memo.insert(last, vec![t.step as f64]);
            let row: Vec<f64> = readings.iter().map(|r| r.get(w)).collect();
            let list = w.memo.get_or(list, Vec::new);
            let before = list.len();
            let grow = |list: &mut Vec<f64>| {
                list.extend(&row);
                if let Some(most) = most
                    && list.len() > most.saturating_mul(cols)
                {
                    list.drain(..cols);
                }
            };
            grow(list);
            let out = w.slots.get_mut(slot);
            out.step = Some(t.step);
            let shown = if cols == 1 { &mut out.vector } else { &mut out.array };
            // The output grows with the stored values: copying all of it each time would make long runs
            // quadratic.
            if shown.len() == before {
                grow(shown);
            } else {
                shown.clone_from(list);
            }
            if cols > 1 {
                out.array_cols = cols;
            }
            Ok(())
        });
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn shape(&self) -> Shape {
        let rows = self.most.unwrap_or(Shape::OPEN);
        match self.values.len() {
            1 => Shape { vector: rows, vector_extensive: self.grows, every: self.every, ..Shape::default() },
            n => Shape {
                array: n,
                array_rows: rows,
                array_extensive: self.grows,
                every: self.every,
                ..Shape::default()
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn values_queue_up() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.equal.insert("e".into(), 7.0);
        b.equal.insert("g".into(), 8.0);
        for (words, wanted) in [("1 v_e", vec![7.0; 3]), ("1 v_e nmax 2", vec![7.0; 2])] {
            let fix = b.fix(&VectorFix, words).unwrap();
            fix.declare(&mut b.world).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            for step in [0, 0, 1, 2] {
                b.world.clock.step = step;
                b.stage(&mut ops, Stage::EndOfStep).unwrap();
            }
            assert_eq!(b.slot_of("f_f").vector, wanted);
            // A slot that was emptied is complete again after the next step.
            let slot = b.world.slots.id("f_f");
            b.world.slots.get_mut(slot).empty();
            b.world.clock.step = 3;
            b.stage(&mut ops, Stage::EndOfStep).unwrap();
            assert_eq!(b.slot_of("f_f").vector, vec![7.0; if wanted.len() == 3 { 4 } else { 2 }]);
        }
        let fix = b.fix(&VectorFix, "1 v_e v_g").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::EndOfStep).unwrap();
        assert_eq!(b.slot_of("f_f").array, [7.0, 8.0]);
        for words in ["", "0 v_e", "1", "1 x", "1 v_e nmax 0", "1 v_e foo"] {
            assert!(b.fix(&VectorFix, words).is_err(), "{words}");
        }
    }
}
