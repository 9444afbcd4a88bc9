//! compute chunk/spread/atom: assigns to each particle a value of its chunk.

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
pub struct SpreadAtom;

impl Style for SpreadAtom {
    fn name(&self) -> &'static str {
        "chunk/spread/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives each particle what is known of its chunk.",
            text: "Per-atom vector for one input, array for several. Each particle of the group has the row of its chunk; 0 outside all chunks and where an input has fewer rows. Whether an \
                   input has rows of the same chunks is not checked.",
            example: "compute cc all chunk/atom type\ncompute c all com/chunk cc\ncompute s all chunk/spread/atom cc c_c[*]",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    /// The vector of a compute …/chunk or a column of its array (`c_ID`, `c_ID[k]`, `c_ID[*]`), and the vector or a column of a
    /// fix (`fix ave/chunk`, `fix ave/time … mode vector`).
    #[word(name = "input", what = "at least one input, as `c_ID`", kind = Kind::Value, least = 1)]
    inputs: Vec<Word>,
}

impl ComputeStyle for SpreadAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks, inputs: words } = read(args, cx)?;
        let mut inputs = vec![];
        for word in &words {
            for word in cx.expand(word, Wants::Vector)? {
                let known = |r: &ValueRef| matches!(r.kind, RefKind::Compute | RefKind::Fix);
                let Some(r) = ValueRef::parse(&word.text, word.span)?.filter(known) else {
                    let text = format!("`{}` is no input of compute chunk/spread/atom", word.text);
                    return Err(Diagnostic::error(Code::UNKNOWN_KEYWORD, word.span, text)
                        .help("inputs are c_ID, c_ID[k], f_ID and f_ID[k]")
                        .into());
                };
                let style = cx.names.compute_style(&r.name).filter(|_| r.kind == RefKind::Compute);
                if let Some(style) = style.filter(|s| !s.ends_with("/chunk")) {
                    let text = format!("compute `{}` (style {style}) has no values of chunks", r.name);
                    return Err(Diagnostic::error(Code::WRONG_KIND, r.span, text)
                        .help("name a compute whose style ends with `/chunk`")
                        .into());
                }
                cx.reading(&r, Wants::Vector)?;
                inputs.push(r);
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, chunks, inputs }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    inputs: Vec<ValueRef>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.inputs.len()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (bit, kind) = (self.group.bit(), self.chunks.kind);
        let chunks = self.chunks.seal(cx, stage, when)?;
        let inputs: Vec<Reading> =
            self.inputs.iter().map(|r| cx.reading(r, Wants::Vector, stage, when)).collect::<Result<_>>()?;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, MASK, move |w, _, out| {
            let chunks = Chunks::of(w, chunks, kind);
            let lists: Vec<Vec<f64>> = inputs.iter().map(|r| r.list(w)).collect();
            out.cols = lists.len();
            out.atom.clear();
            for i in 0..w.n() {
                let chunk = chunks.chunk(i).filter(|_| w.particles.mask[i] & bit != 0);
                let value = |list: &Vec<f64>| chunk.and_then(|k| list.get(k)).copied().unwrap_or(0.0);
                out.atom.extend(lists.iter().map(value));
            }
            Ok(())
        }))
    }
}
