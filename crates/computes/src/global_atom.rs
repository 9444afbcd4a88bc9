//! compute global/atom: assigns each particle an element of a global vector.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::MASK;
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct GlobalAtom;

impl Style for GlobalAtom {
    fn name(&self) -> &'static str {
        "global/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives each particle the element of a global vector that an index of its own names.",
            text: "Per-atom vector for one input, array for several; 0 where the index \
                   is below 1 or beyond the vector, and outside the group. With the chunk of each particle as index it shows \
                   every particle the value of its chunk.",
            example: "compute cc all chunk/atom type\ncompute com all com/chunk cc\ncompute g all global/atom c_cc c_com[3]",
        }
    }
}

#[derive(Words)]
struct Line {
    /// A value per particle (`c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`, `v_name`), rounded towards zero.
    #[word(name = "index", what = "the index, a value per particle", kind = Kind::Value)]
    index: Word,
    /// Global vectors: `c_ID`, `f_ID`, a column `c_ID[k]`, `c_ID[*]` or `f_ID[k]` of a global array, or `v_name` of a vector-style
    /// variable.
    #[word(name = "input", what = "a global vector, as `c_ID`", kind = Kind::Value, least = 1)]
    inputs: Vec<Word>,
}

/// A reference that can be read during a run.
fn reference(word: &Word) -> Result<ValueRef> {
    let known = |r: &ValueRef| !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom);
    match ValueRef::parse(&word.text, word.span)?.filter(known) {
        Some(r) => Ok(r),
        None => {
            let text = format!("`{}` is no value of a compute, fix or variable", word.text);
            Err(Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text)
                .help("write c_ID, f_ID or v_name")
                .into())
        }
    }
}

impl ComputeStyle for GlobalAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { index, inputs: words } = read(args, cx)?;
        let index = reference(&index)?;
        cx.reading(&index, Wants::PerAtom)?;
        let mut inputs = vec![];
        for word in &words {
            for word in cx.expand(word, Wants::Vector)? {
                let r = reference(&word)?;
                cx.reading(&r, Wants::Vector)?;
                inputs.push(r);
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, index, inputs }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    index: ValueRef,
    inputs: Vec<ValueRef>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.inputs.len()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let index = cx.reading(&self.index, Wants::PerAtom, stage, when)?;
        let inputs: Vec<Reading> =
            self.inputs.iter().map(|r| cx.reading(r, Wants::Vector, stage, when)).collect::<Result<_>>()?;
        let group = self.group;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, MASK, move |w, _, out| {
            let lists: Vec<Vec<f64>> = inputs.iter().map(|r| r.list(w)).collect();
            out.cols = lists.len();
            out.atom.clear();
            for i in 0..w.n() {
                // A negative or missing index becomes 0 in the cast, which is out of range.
                let k = (index.atom(w, i) as usize)
                    .checked_sub(1)
                    .filter(|_| w.particles.mask[i] & group.bit() != 0);
                let of = |list: &Vec<f64>| k.and_then(|k| list.get(k)).copied().unwrap_or(0.0);
                out.atom.extend(lists.iter().map(of));
            }
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn elements_by_index() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 5]);
        b.atom.insert("k".into(), vec![2.9, 1.0, 0.0, -1.0, 3.0]);
        b.computes.insert("v".into(), Shape { vector: 2, ..Shape::default() });
        let s = b.world.slots.id("c_v");
        b.world.slots.get_mut(s).vector = vec![10.0, 20.0];
        let c = b.compute(&GlobalAtom, "v_k c_v").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [20.0, 10.0, 0.0, 0.0, 0.0]);
        for words in ["", "v_k", "v_k c_v[1]", "c_v c_v", "v_k vx", "v_k v_k"] {
            assert!(b.compute(&GlobalAtom, words).is_err(), "{words}");
        }
    }
}
