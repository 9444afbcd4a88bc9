//! fix ave/atom: averages of per-atom values over time.

use super::window::{Kept, Samples, Schedule, forget};
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::{COLUMNS, F, MASK, MEMO, SLOTS, V, X};
use perigrain_world::{GroupId, Key, Numbers, Slot, World};

/// The style.
pub struct AveAtom;

impl Style for AveAtom {
    fn name(&self) -> &'static str {
        "ave/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Averages per-atom values over time for each particle of the group.",
            text: "At every multiple of Nfreq the average is offered as `f_ID` (one value) or `f_ID[k]` (several). 0 for \
                   particles outside the group and before the first average.",
            example: "fix mean all ave/atom 1 2 2 vx vy c_dmg",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    samples: Samples,
    /// What is averaged: `x y z vx vy vz fx fy fz`, `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]` with ranges such as `[*]`, and
    /// `v_name` of an atom-style variable.
    #[word(name = "value", what = "a value such as vx or c_ID", kind = Kind::Attribute, least = 1)]
    values: Vec<Word>,
}

/// A per-atom input.
#[derive(Clone)]
pub enum Input {
    /// Component (0 to 2) of position, velocity or force.
    Column(char, usize),
    /// Value of a compute, fix or variable.
    Value(ValueRef),
}

impl Input {
    /// The input named by one of the words `x` … `fz`.
    pub fn attribute(word: &str) -> Option<Self> {
        let (kind, axis) = match word.as_bytes() {
            [axis] => ('x', axis),
            [b'v', axis] => ('v', axis),
            [b'f', axis] => ('f', axis),
            _ => return None,
        };
        matches!(axis, b'x'..=b'z').then(|| Input::Column(kind, usize::from(axis - b'x')))
    }

    /// Plans the reading of this input.
    ///
    /// # Errors
    /// As `SealCx::reading`.
    pub fn source(&self, cx: &mut dyn SealCx, wants: Wants, stage: Stage, when: &When) -> Result<Source> {
        match self {
            Input::Column(kind, d) => Ok(Source::Column(*kind, *d)),
            Input::Value(r) => cx.reading(r, wants, stage, when).map(Source::Reading),
        }
    }
}

/// Location of an input during a step.
#[derive(Clone, Copy)]
pub enum Source {
    /// As in [`Input::Column`].
    Column(char, usize),
    /// In a slot.
    Reading(Reading),
}

impl Source {
    /// The value of particle `i`.
    pub fn atom(&self, w: &World, i: usize) -> f64 {
        match self {
            Source::Column('x', d) => w.particles.x[i][*d],
            Source::Column('v', d) => w.particles.v[i][*d],
            Source::Column(_, d) => w.particles.f[i][*d],
            Source::Reading(r) => r.atom(w, i),
        }
    }
}

impl FixStyle for AveAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let schedule = Schedule::new(&line.samples, 0)?;
        let mut inputs = vec![];
        for word in &line.values {
            match Input::attribute(&word.text) {
                Some(input) => inputs.push(input),
                None => {
                    for word in cx.expand(word, Wants::PerAtom)? {
                        inputs.push(Input::Value(reference(&word, schedule.every, cx)?));
                    }
                }
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, schedule, inputs }))
    }
}

fn reference(word: &Word, every: i64, cx: &BuildCx) -> Result<ValueRef> {
    let Some(r) = ValueRef::parse(&word.text, word.span)? else {
        let text = format!("`{}` is no per-atom value: x … fz, c_ID, f_ID or v_name is expected", word.text);
        return fail(perigrain_base::diag::Code::WRONG_KIND, word.span, text);
    };
    cx.value(&r, true)?;
    super::compatible(&r, &cx.shape(&r).unwrap_or_default(), every, "Nevery")?;
    Ok(r)
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    schedule: Schedule,
    inputs: Vec<Input>,
}

impl Declared {
    fn kept(&self) -> Kept {
        Kept::below(Key::new(&format!("ave/atom/{}", self.id)))
    }

    /// Columns that hold the sums.
    fn columns(&self) -> Vec<Numbers> {
        let key = self.kept().key;
        (0..self.inputs.len()).map(|k| key.with(&format!("/{k}"))).collect()
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, counts_steps: true, ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        self.schedule.declare(w, &self.kept());
        let (name, cols) = (format!("f_{}", self.id), self.inputs.len());
        let slot = w.slots.id(&name);
        let step = Some(w.clock.step);
        *w.slots.get_mut(slot) = Slot { name, step, cols, atom: vec![0.0; w.n() * cols], ..Slot::default() };
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.kept().key);
        self.columns().into_iter().for_each(|column| w.columns.remove(column));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = self.schedule.when();
        let mut sources = vec![];
        for input in &self.inputs {
            sources.push(input.source(cx, Wants::PerAtom, Stage::EndOfStep, &when)?);
        }
        let (me, kept, columns) = (self.clone(), self.kept(), self.columns());
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(SLOTS | X | V | F | MASK).write(SLOTS).keep(MEMO | COLUMNS);
        let op = StepOp::new(format!("fix {} ave/atom", self.id), Stage::EndOfStep, access, move |w, t| {
            let Some(due) = me.schedule.due(w, &kept, t.step) else { return Ok(()) };
            let (n, cols, bit) = (w.n(), sources.len(), me.group.bit());
            let mut means = vec![0.0; if due.last { n * cols } else { 0 }];
            for (k, (source, column)) in sources.iter().zip(&columns).enumerate() {
                let mut sums = std::mem::take(w.columns.scalar(*column, n));
                let world = &*w;
                par::each((&mut sums[..], &world.particles.mask[..]), |start, (sums, mask)| {
                    for (i, (sum, mask)) in sums.iter_mut().zip(mask).enumerate() {
                        let before = if due.first { 0.0 } else { *sum };
                        let inside = mask & bit != 0;
                        *sum = if inside { before + source.atom(world, start + i) } else { 0.0 };
                    }
                });
                for (mean, sum) in means.iter_mut().skip(k).step_by(cols).zip(&sums) {
                    *mean = sum / me.schedule.repeat as f64;
                }
                *w.columns.scalar(*column, n) = sums;
            }
            if due.last {
                let out = w.slots.get_mut(slot);
                (out.step, out.atom, out.cols) = (Some(t.step), means, cols);
            }
            Ok(())
        });
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { atom: Some(self.inputs.len()), every: self.schedule.freq, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn means_of_two_samples() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        b.world.particles.mask[1] = 0;
        b.atom.insert("a".into(), vec![3.0, 4.0]);
        let fix = b.fix(&AveAtom, "1 2 2 vy v_a").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        for step in 1..5 {
            b.world.clock.step = step;
            b.world.particles.v = vec![[0.0, step as f64, 0.0]; 2].into();
            b.stage(&mut ops, Stage::EndOfStep).unwrap();
            let wanted = [0.0, 0.0, 1.5, 1.5, 3.5][step as usize];
            assert_eq!(b.slot_of("f_f").atom[0], wanted, "step {step}");
        }
        assert_eq!(b.slot_of("f_f").atom, [3.5, 3.0, 0.0, 0.0]);
        fix.remove(&mut b.world);
        assert!(b.world.memo.is_empty() && b.world.columns.names().is_empty());
        for words in ["1 2", "1 2 2", "1 2 2 vq", "1 3 2 vx", "2 1 3 vx", "1 1 1 c_t"] {
            assert!(b.fix(&AveAtom, words).is_err(), "{words}");
        }
    }
}
