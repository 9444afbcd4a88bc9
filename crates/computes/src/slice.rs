//! compute slice: selected elements of vectors.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::SlotId;
use perigrain_world::field::SLOTS;

/// The style.
pub struct Slice;

impl Style for Slice {
    fn name(&self) -> &'static str {
        "slice"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes some elements of vectors.",
            text: "From each input the elements Nstart, Nstart + Nskip … below Nstop, counted from 1: as in LAMMPS 22Jul2025, \
                   Nstop itself is not among them, except where it is the only one (LAMMPS lacks the last one where Nskip does not divide Nstop − Nstart, or crashes). One input gives a vector, several an array with a \
                   column each. Whether values grow with the scene follows from the inputs. The group means nothing.",
            example: "compute diagonal all slice 1 4 1 c_thermo_press",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The first element, counted from 1.
    #[word(name = "Nstart", from = 1)]
    start: usize,
    /// The last element, itself not taken unless it is the first.
    #[word(name = "Nstop", from = 1)]
    stop: At<usize>,
    /// The distance of elements.
    #[word(name = "Nskip", from = 1)]
    skip: usize,
    /// Global vectors: `c_ID`, `f_ID`, `v_name` of a vector-style variable, or a column `c_ID[k]`, `f_ID[k]` of a global array.
    #[word(name = "input", what = "an input", kind = Kind::Value, least = 1)]
    inputs: Vec<Word>,
}

impl ComputeStyle for Slice {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { start, stop: At { value: stop, span, unknown }, skip, inputs: words } = read(args, cx)?;
        if stop < start && !unknown {
            return fail(
                Code::BAD_VALUE,
                span,
                format!("the last element, {stop}, is before the first, {start}"),
            );
        }
        let mut inputs = vec![];
        let mut extensive = false;
        for word in &words {
            for word in cx.expand(word, Wants::Vector)? {
                let r = match ValueRef::parse(&word.text, word.span)? {
                    Some(r) if !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom) => r,
                    _ => {
                        let text =
                            format!("`{}` is no input of compute slice: c_ID, f_ID or v_name", word.text);
                        return fail(Code::WRONG_KIND, word.span, text);
                    }
                };
                cx.reading(&r, Wants::Vector)?;
                let shape = cx.shape(&r).unwrap_or_default();
                let (length, grows) = match r.index.len() {
                    0 => (shape.vector, shape.vector_extensive),
                    _ => (shape.array_rows, shape.array_extensive),
                };
                if stop > length {
                    return fail(
                        Code::BAD_VALUE,
                        word.span,
                        format!("`{r}` has {length} elements, not {stop}"),
                    );
                }
                extensive |= grows && r.kind != RefKind::Variable;
                inputs.push(r);
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), start, stop, skip, inputs, extensive }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// First element, from 1.
    start: usize,
    stop: usize,
    skip: usize,
    inputs: Vec<ValueRef>,
    extensive: bool,
}

impl Declared {
    /// The number of elements taken.
    fn count(&self) -> usize {
        (self.stop - self.start).div_ceil(self.skip)
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        match self.inputs.len() {
            1 => Shape { vector: self.count(), vector_extensive: self.extensive, ..Shape::default() },
            n => Shape {
                array: n,
                array_rows: self.count(),
                array_extensive: self.extensive,
                ..Shape::default()
            },
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut readings = vec![];
        for r in &self.inputs {
            readings.push((cx.reading(r, Wants::Vector, stage, when)?, r.clone()));
        }
        let (first, skip, count) = (self.start - 1, self.skip, self.count());
        Ok(fill(&self.id, &Wanted { slot, stage, when }, SLOTS, move |w, t, out| {
            let mut columns = vec![];
            for (reading, r) in &readings {
                let list = reading.list(w);
                let taken: Vec<f64> =
                    (0..count).filter_map(|k| list.get(first + k * skip).copied()).collect();
                if taken.len() < count {
                    let (has, at) = (list.len(), t.step);
                    let text = format!("`{r}` has {has} elements at step {at}: too few for compute slice");
                    return fail(Code::BAD_VALUE, r.span, text);
                }
                columns.push(taken);
            }
            match columns.len() {
                1 => out.vector = columns.swap_remove(0),
                n => {
                    out.array_cols = n;
                    out.array = (0..count).flat_map(|k| columns.iter().map(move |c| c[k])).collect();
                }
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

    fn bench() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.computes.insert("p".into(), Shape { vector: 6, ..Shape::default() });
        b.computes.insert("g".into(), Shape { vector: Shape::OPEN, ..Shape::default() });
        for (name, list) in [("c_p", vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), ("c_g", vec![7.0, 8.0])] {
            let slot = b.world.slots.id(name);
            b.world.slots.get_mut(slot).vector = list;
        }
        b
    }

    #[test]
    fn every_third_element_below_the_last() {
        let mut b = bench();
        let slice = b.compute(&Slice, "1 6 3 c_p").unwrap();
        assert_eq!(b.evaluate(&*slice).unwrap().vector, [1.0, 4.0]);
        let slice = b.compute(&Slice, "1 2 1 c_p c_g").unwrap();
        assert_eq!(slice.shape().array, 2);
        assert_eq!(b.evaluate(&*slice).unwrap().array, [1.0, 7.0]);
    }

    #[test]
    fn too_short_a_vector_is_named() {
        let mut b = bench();
        for words in ["0 6 3 c_p", "3 2 1 c_p", "1 7 1 c_p", "1 6 0 c_p", "1 6 1", "1 6 1 x", "1 6 1 c_q"] {
            assert!(b.compute(&Slice, words).is_err(), "{words}");
        }
        let slice = b.compute(&Slice, "1 9 1 c_g").unwrap();
        assert!(b.evaluate(&*slice).is_err());
    }
}
