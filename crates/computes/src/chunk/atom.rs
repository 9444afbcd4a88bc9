//! compute chunk/atom: assigns particles to chunks by spatial bins, by type or by any value.

use super::assign::{Task, key, window};
use super::words::{Line, Spec, What};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words};
use perigrain_styles::{BuildCx, Chunking, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{BOX, COLUMNS, KIND, MASK, MEMO, MOLECULE, REGIONS, SLOTS, X};
use perigrain_world::{Fields, SlotId, World};

/// The style.
pub struct ChunkAtom;

impl Style for ChunkAtom {
    fn name(&self) -> &'static str {
        "chunk/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Numbers particles into chunks, for computes and fixes that work chunk by chunk.",
            text: "Per-atom vector: the chunk of each particle from 1 to Nchunk, 0 for none.\n\n\
                   A value per particle, `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]` or `v_name`, is rounded towards zero. With `compress yes` \
                   particles whose value or molecule is below 1 form chunks like all others, as in LAMMPS; else they are outside all \
                   chunks.\n\n\
                   A `fix ave/chunk`, or a `fix ave/time` of rows of chunks, holds their number during its windows. \
                   Under `-compat lammps` `mixed` drops what is above the last layer \
                   also where layers end at the box, as LAMMPS 22Jul2025 does. LAMMPS 22Jul2025 ignores or crashes on `limit` together with `compress`; here it \
                   does what LAMMPS' manual says.",
            example: "compute cc all chunk/atom bin/1d z lower 0.1 units reduced",
        }
    }
}

impl ComputeStyle for ChunkAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let spec = Spec::read(args, cx)?;
        if spec.drops_above() {
            cx.fault(cx.span, "what is above the last layer belongs to no chunk", false);
        }
        Ok(Box::new(Declared(spec)))
    }
}

#[derive(Clone)]
struct Declared(Spec);

impl Compute for Declared {
    fn shape(&self) -> Shape {
        let Spec { compress: compressed, once: fixed, .. } = self.0;
        let (coordinates, bins) = (self.0.coordinates(), self.0.bins());
        let chunks = Chunking { coordinates, compressed, fixed, bins };
        Shape { atom: Some(1), chunks: Some(chunks), ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(key(&self.0.id));
        w.columns.remove(key(&self.0.id));
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (spec, span) = (self.0.clone(), cx.span());
        let keys = [key(&spec.id), window(&spec.id)];
        let value = match &spec.what {
            What::Value(r) => Some(cx.reading(r, Wants::PerAtom, stage, when)?),
            _ => None,
        };
        let molecules = if matches!(spec.what, What::Molecule) { MOLECULE } else { Fields::NONE };
        let access = Needs::new()
            .read(X | MASK | KIND | molecules | BOX | COLUMNS | REGIONS)
            .write(SLOTS)
            .keep(MEMO | COLUMNS);
        let op = StepOp::new(format!("compute {}", spec.id), stage, access, move |w: &mut World, t| {
            let region = match &spec.region {
                None => None,
                Some(key) => match w.regions.get(*key).cloned() {
                    Some(r) => Some(r),
                    None => {
                        return fail(
                            Code::UNKNOWN_NAME,
                            span,
                            format!("there is no region `{key}` any more"),
                        );
                    }
                },
            };
            let mut out = w.slots.take(slot);
            let task = Task { spec: &spec, keys, region: region.as_ref(), value: value.as_ref(), span };
            let outcome = task.run(w, t.step, &mut out);
            w.slots.put(slot, out, t.step);
            outcome
        });
        Ok(op.when(when.clone()).in_setup(true).boxed())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn numbers(words: &str) -> Vec<f64> {
        let mut b =
            Bench::new(AtomStyle::default(), &[[-9.0; 3], [0.5, 2.0, 1.0], [7.0, 2.0, 0.0], [0.0; 3]]);
        b.atom.insert("seven".into(), vec![7.9, -3.0, 40.0, 7.0]);
        let c = b.compute(&ChunkAtom, words).unwrap();
        b.evaluate(&*c).unwrap().atom.clone()
    }

    #[test]
    fn values_are_limited_and_compressed() {
        assert_eq!(numbers("v_seven"), [7.0, 0.0, 40.0, 7.0]);
        assert_eq!(numbers("v_seven limit 10 max"), [7.0, 0.0, 0.0, 7.0]);
        assert_eq!(numbers("v_seven limit 10 max discard no"), [7.0, 10.0, 10.0, 7.0]);
        // As in LAMMPS 22Jul2025, compression also makes chunks of values below 1.
        assert_eq!(numbers("v_seven compress yes"), [2.0, 1.0, 3.0, 2.0]);
        assert_eq!(numbers("v_seven limit 10 max compress yes discard no"), [2.0, 1.0, 3.0, 2.0]);
        assert_eq!(numbers("v_seven limit 10 max compress yes"), [2.0, 1.0, 0.0, 2.0]);
        assert_eq!(numbers("v_seven compress yes limit 2 max"), [2.0, 1.0, 0.0, 2.0]);
        assert_eq!(numbers("type"), [1.0; 4]);
    }

    #[test]
    fn mistakes_are_named() {
        let b = Bench::new(AtomStyle::default(), &[]);
        let bad = "|molecule|bin/1d|bin/1d w lower 1|bin/1d x lower 0|bin/1d x low 1|bin/2d x lower 1 x lower 1|type foo|\
                   bin/sphere 0 0 0 2 1 3|type limit 3|type discard mixed|c_no|type region no|type bound x 1|type ids never";
        for words in bad.split('|') {
            assert!(b.compute(&ChunkAtom, words).is_err(), "{words}");
        }
    }
}
