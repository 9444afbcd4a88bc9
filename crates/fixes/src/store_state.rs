//! fix store/state: stores attributes and values of particles.

use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_computes::property_atom::{Getter, find_attribute, read_attribute};
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::centre;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::{BOX, COLUMNS, F, IMAGE, KIND, MASK, MASS, MEMO, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Key, Numbers, Slot, SlotId, World};

/// The style.
pub struct StoreState;

impl Style for StoreState {
    fn name(&self) -> &'static str {
        "store/state"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Keeps per-atom attributes and values as they were at one moment, or every N steps.",
            text: "Per-atom vector for one input, array for several; 0 for particles outside the group and those that come later.",
            example: "fix start all store/state 0 xu yu zu\ncompute far all reduce max f_start[1]",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Kept at first (attributes when the fix is declared, values and properties such as `d_NAME` in the setup of the next run) and
    /// anew at multiples of N [steps]; 0: at first alone.
    #[word(name = "N", what = "the number of steps N", from = 0)]
    every: i64,
    /// What is kept: the attributes of `compute property/atom` (positions, velocities, forces, radius …), `c_ID`, `c_ID[k]`,
    /// `f_ID`, `f_ID[k]` with ranges such as `[*]`, and `v_name` of an atom-style variable.
    #[word(name = "input", what = "an input such as xu or c_ID", kind = Kind::Attribute, least = 1)]
    inputs: Vec<Word>,
    /// Whether `xu yu zu` are kept relative to the centre of mass of the group.
    #[word(keyword, what = "com", default = false)]
    com: bool,
}

/// One input.
#[derive(Clone)]
enum Input {
    /// An attribute, by name.
    Attribute(&'static str, Getter),
    /// A value.
    Value(ValueRef),
}

impl FixStyle for StoreState {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, inputs: words, com: relative } = read(args, cx)?;
        let mut inputs = vec![];
        for word in &words {
            let custom = cx.world.columns.custom(&word.text).map(|_| "");
            match find_attribute(&word.text).or(custom) {
                Some(name) => inputs.push(Input::Attribute(name, read_attribute(word, cx)?)),
                None => value(word, every, cx, &mut inputs)?,
            }
        }
        let filled: Numbers = Key::new(&format!("store/state/{}", cx.id));
        let columns = (0..inputs.len()).map(|k| filled.with(&format!("/{k}"))).collect();
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { id, group, every, inputs, relative, filled, columns }))
    }
}

fn value(word: &Word, every: i64, cx: &BuildCx, inputs: &mut Vec<Input>) -> Result<()> {
    if ValueRef::parse(word.text.split('[').next().unwrap_or(""), word.span)?.is_none() {
        // Lists the available attributes.
        return read_attribute(word, cx).map(drop);
    }
    for word in cx.expand(word, Wants::PerAtom)? {
        let Some(r) = ValueRef::parse(&word.text, word.span)? else { continue };
        cx.value(&r, true)?;
        super::compatible(&r, &cx.shape(&r).unwrap_or_default(), every, "N")?;
        inputs.push(Input::Value(r));
    }
    Ok(())
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    inputs: Vec<Input>,
    relative: bool,
    /// Key of the flag that values have been stored.
    filled: Numbers,
    /// Columns of the inputs.
    columns: Vec<Numbers>,
}

impl Input {
    /// The inputs not stored at this time: attributes are stored when the fix is declared; values and
    /// properties of fix property/atom in the setup of a run.
    fn left_out_at(&self) -> Which {
        match self {
            Input::Attribute(_, Getter::Own(_) | Getter::Whole(_)) => Which::Values,
            _ => Which::Attributes,
        }
    }
}

/// Which inputs are stored.
#[derive(Clone, Copy, PartialEq)]
enum Which {
    Attributes,
    Values,
    All,
}

impl Declared {
    /// Stores inputs; `readings` are those of values.
    fn keep(&self, w: &mut World, which: Which, readings: &[Option<Reading>]) {
        let (n, bit) = (w.n(), self.group.bit());
        let center = if self.relative { centre(w, self.group).1 } else { [0.0; 3] };
        for (k, input) in self.inputs.iter().enumerate() {
            let column = self.columns[k];
            let world = &*w;
            let list: Vec<f64> = match input {
                Input::Attribute(name, getter) if which != input.left_out_at() => {
                    let less = match *name {
                        "xu" => center[0],
                        "yu" => center[1],
                        "zu" => center[2],
                        _ => 0.0,
                    };
                    let values = getter.values(world);
                    (0..n).map(|i| values.get(i) - less).collect()
                }
                Input::Value(_) if which != input.left_out_at() => {
                    let Some(reading) = readings.get(k).copied().flatten() else { continue };
                    (0..n).map(|i| reading.atom(world, i)).collect()
                }
                _ => continue,
            };
            let inside = |i: usize| w.particles.mask[i] & bit != 0;
            let kept = (0..n).map(|i| if inside(i) { list[i] } else { 0.0 }).collect();
            *w.columns.scalar(column, n) = kept;
        }
    }

    /// Offers the stored values.
    fn show(&self, w: &mut World, slot: SlotId, step: i64) {
        let (n, cols) = (w.n(), self.inputs.len());
        let lists: Vec<&[f64]> =
            self.columns.iter().map(|column| w.columns.get_scalar(*column).unwrap_or_default()).collect();
        let atom: Vec<f64> =
            (0..n).flat_map(|i| lists.iter().map(move |l| l.get(i).copied().unwrap_or(0.0))).collect();
        let out = w.slots.get_mut(slot);
        (out.step, out.cols, out.atom) = (Some(step), cols, atom);
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        w.spread_type_masses();
        self.keep(w, Which::Attributes, &[]);
        let name = format!("f_{}", self.id);
        let slot = w.slots.id(&name);
        *w.slots.get_mut(slot) = Slot { name, ..Slot::default() };
        self.show(w, slot, w.clock.step);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.filled);
        self.columns.iter().for_each(|column| w.columns.remove(*column));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = if self.every == 0 { When::First } else { When::First.or(When::Every(self.every)) };
        let (mut me, mut readings) = (self.clone(), vec![]);
        // Values that are stored once may no longer be computable.
        let stored = self.every == 0 && cx.world().memo.contains(self.filled);
        for input in &mut me.inputs {
            readings.push(match input {
                _ if stored => None,
                Input::Attribute(_, getter) => {
                    let span = cx.span();
                    *getter = getter.present(cx.world(), span)?;
                    None
                }
                Input::Value(r) => Some(cx.reading(r, Wants::PerAtom, Stage::EndOfStep, &when)?),
            });
        }
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new()
            .read(SLOTS | X | V | F | MASK | MASS | IMAGE | TYPE_MASS | KIND | BOX)
            .write(SLOTS)
            .keep(COLUMNS | MEMO);
        let op =
            StepOp::new(format!("fix {} store/state", self.id), Stage::EndOfStep, access, move |w, t| {
                if !t.setup {
                    me.keep(w, Which::All, &readings);
                } else if w.memo.insert(me.filled, vec![]).is_none() {
                    me.keep(w, Which::Values, &readings);
                }
                me.show(w, slot, t.step);
                Ok(())
            });
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, ..Facts::default() }
    }

    fn shape(&self) -> Shape {
        Shape { atom: Some(self.inputs.len()), every: self.every, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn the_moment_of_the_declaration_stays() {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 2.0, 3.0], [3.0, 2.0, 3.0]]);
        b.atom.insert("a".into(), vec![7.0, 8.0]);
        let fix = b.fix(&StoreState, "0 xu y v_a com yes").unwrap();
        fix.declare(&mut b.world).unwrap();
        assert_eq!(b.slot_of("f_f").atom, [-1.0, 2.0, 0.0, 1.0, 2.0, 0.0]);
        b.world.particles.x[0] = [9.0; 3];
        let mut ops = b.seal(&*fix).unwrap();
        let t = perigrain_plan::Tick { setup: true, ..b.tick() };
        ops[0].run(&mut b.world, &t).unwrap();
        assert_eq!(b.slot_of("f_f").atom, [-1.0, 2.0, 7.0, 1.0, 2.0, 8.0]);
        fix.remove(&mut b.world);
        assert!(b.world.memo.is_empty() && b.world.columns.names().is_empty());
        for words in ["", "0", "-1 x", "0 radius", "0 zz", "0 v_no", "0 x com maybe"] {
            assert!(b.fix(&StoreState, words).is_err(), "{words}");
        }
    }
}
