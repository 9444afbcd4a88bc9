//! compute property/chunk: counts, original numbers and coordinates of chunks.

use super::{ChunkRef, Chunks, sums};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::MASK;
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct PropertyChunk;

impl Style for PropertyChunk {
    fn name(&self) -> &'static str {
        "property/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Attributes of chunks.",
            text: "Global vector of length Nchunk for one attribute, array for several (intensive). \
                   Coordinates are the middle of the bin along the axes in the order in which they were given, in distance \
                   units or, under `units reduced`, as fractions of the box; for bin/sphere the radius; for bin/cylinder the \
                   radius, then the place along the axis.",
            example: "compute cc all chunk/atom bin/1d z lower 1.0\ncompute p all property/chunk cc count coord1",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    #[word(name = "attribute", what = "attribute of chunks", least = 1)]
    list: Vec<At<Attribute>>,
}

#[derive(Clone, Copy, Words)]
enum Attribute {
    /// How many particles of the group are in the chunk.
    Count,
    /// The number that the chunk had before `compress yes` of the `compute chunk/atom`, which it needs.
    Id,
    /// The first coordinate.
    Coord1,
    /// The second coordinate.
    Coord2,
    /// The third coordinate.
    Coord3,
}

impl Attribute {
    /// The number of the coordinate, from 0, and its word.
    fn coordinate(self) -> Option<(usize, &'static str)> {
        match self {
            Attribute::Coord1 => Some((0, "coord1")),
            Attribute::Coord2 => Some((1, "coord2")),
            Attribute::Coord3 => Some((2, "coord3")),
            Attribute::Count | Attribute::Id => None,
        }
    }
}

impl ComputeStyle for PropertyChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks, list } = read(args, cx)?;
        for At { value, span, .. } in &list {
            let n = chunks.kind.coordinates;
            match value.coordinate() {
                Some((k, name)) if k >= n => {
                    let text =
                        format!("the chunks of compute {} have {n} coordinates, no `{name}`", chunks.id);
                    return fail(Code::CONFLICT, *span, text);
                }
                None if matches!(value, Attribute::Id) && !chunks.kind.compressed => {
                    let text = format!(
                        "`id` needs `compress yes` in compute {}: without it ids are 1, 2, 3 …",
                        chunks.id
                    );
                    return fail(Code::CONFLICT, *span, text);
                }
                _ => {}
            }
        }
        let list = list.into_iter().map(|a| a.value).collect();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, chunks, list }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    chunks: ChunkRef,
    list: Vec<Attribute>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        match self.list.len() {
            1 => Shape { vector: Shape::OPEN, ..Shape::default() },
            n => Shape { array: n, array_rows: Shape::OPEN, ..Shape::default() },
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, kind, list) = (self.group, self.chunks.kind, self.list.clone());
        let (chunks, varying) = (self.chunks.seal(cx, stage, when)?, self.chunks.varying());
        Ok(fill(&self.id, &Wanted { slot, stage, when }, MASK, move |w, _, out| {
            out.chunks = varying;
            let chunks = Chunks::of(w, chunks, kind);
            let counts = match list.iter().any(|a| matches!(a, Attribute::Count)) {
                true => sums(w, group, &chunks, |_| [1.0]),
                false => vec![],
            };
            let into = if list.len() == 1 { &mut out.vector } else { &mut out.array };
            into.clear();
            for k in 0..chunks.count() {
                into.extend(list.iter().map(|a| match a.coordinate() {
                    Some((d, _)) => chunks.coordinate(k, d),
                    None if matches!(a, Attribute::Count) => counts[k][0],
                    None => chunks.original(k),
                }));
            }
            out.array_cols = list.len();
            Ok(())
        }))
    }
}
