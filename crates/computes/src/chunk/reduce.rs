//! compute reduce/chunk: sum or extreme of per-particle values for each chunk.

use super::{ChunkRef, Chunks};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::MASK;
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct ReduceChunk;

impl Style for ReduceChunk {
    fn name(&self) -> &'static str {
        "reduce/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sums and extremes of per-atom values, chunk by chunk.",
            text: "Global vector of length Nchunk for one input, array for several (intensive). Only particles of the \
                   group count. A chunk without particles has the sum 0, the minimum 1e20 and the maximum −1e20.",
            example: "compute cc all chunk/atom type\ncompute k all ke/atom\ncompute s all reduce/chunk cc sum c_k",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    #[word(name = "mode")]
    mode: Mode,
    /// Values per particle: `c_ID`, `c_ID[k]`, `c_ID[*]`, `f_ID`, `f_ID[k]` and `v_name` of an atom-style variable.
    #[word(name = "input", what = "at least one input, as `c_ID`", kind = Kind::Value, least = 1)]
    inputs: Vec<Word>,
}

/// What is made of the values of a chunk.
#[derive(Clone, Copy, Words)]
#[word(what = "mode of compute reduce/chunk")]
enum Mode {
    /// Their sum.
    Sum,
    /// The smallest.
    Min,
    /// The largest.
    Max,
}

impl Mode {
    fn start(self) -> f64 {
        match self {
            Mode::Sum => 0.0,
            Mode::Min => 1e20,
            Mode::Max => -1e20,
        }
    }

    fn join(self, a: f64, b: f64) -> f64 {
        match self {
            Mode::Sum => a + b,
            Mode::Min => a.min(b),
            Mode::Max => a.max(b),
        }
    }
}

impl ComputeStyle for ReduceChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks, mode, inputs: words } = read(args, cx)?;
        let mut inputs = vec![];
        for word in &words {
            for word in cx.expand(word, Wants::PerAtom)? {
                let known = |r: &ValueRef| !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom);
                let Some(r) = ValueRef::parse(&word.text, word.span)?.filter(known) else {
                    let text = format!("`{}` is no input of compute reduce/chunk", word.text);
                    return Err(Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text)
                        .help("inputs are c_ID, c_ID[k], f_ID, f_ID[k] and v_name; `compute property/atom` gives attributes")
                        .into());
                };
                cx.reading(&r, Wants::PerAtom)?;
                inputs.push(r);
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, chunks, mode, inputs }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    mode: Mode,
    inputs: Vec<ValueRef>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        match self.inputs.len() {
            1 => Shape { vector: Shape::OPEN, ..Shape::default() },
            n => Shape { array: n, array_rows: Shape::OPEN, ..Shape::default() },
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, kind, mode) = (self.group, self.chunks.kind, self.mode);
        let (chunks, varying) = (self.chunks.seal(cx, stage, when)?, self.chunks.varying());
        let inputs: Vec<Reading> =
            self.inputs.iter().map(|r| cx.reading(r, Wants::PerAtom, stage, when)).collect::<Result<_>>()?;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, MASK, move |w, _, out| {
            out.chunks = varying;
            let chunks = Chunks::of(w, chunks, kind);
            let columns = inputs.len();
            let into = if columns == 1 { &mut out.vector } else { &mut out.array };
            into.clear();
            into.resize(chunks.count() * columns, mode.start());
            for i in (0..w.n()).filter(|&i| w.particles.mask[i] & group.bit() != 0) {
                let Some(k) = chunks.chunk(i) else { continue };
                for (c, reading) in inputs.iter().enumerate() {
                    let at = &mut into[k * columns + c];
                    *at = mode.join(*at, reading.atom(w, i));
                }
            }
            out.array_cols = columns;
            Ok(())
        }))
    }
}
