//! compute property/chunk: counts, original numbers and coordinates of chunks.

use super::{ChunkRef, Chunks, sums};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
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
            syntax: "compute ID group property/chunk chunkID count|id|coord1|coord2|coord3 …",
            summary: "Attributes of chunks.",
            text: "Global vector of length Nchunk for one attribute, array for several (intensive). `count`: how many \
                   particles of the group are in the chunk. `id`: the number the chunk had before `compress yes` of \
                   the `compute chunk/atom`, which it needs. `coord1 coord2 coord3`: the middle of the bin along the axes \
                   in the order in which they were given, in distance units or, under `units reduced`, as fractions of \
                   the box; for bin/sphere the radius; for bin/cylinder the radius, then the place along the axis.",
            example: "compute cc all chunk/atom bin/1d z lower 1.0\ncompute p all property/chunk cc count coord1",
        }
    }
}

#[derive(Clone, Copy)]
enum Attribute {
    Count,
    Id,
    Coordinate(usize),
}

const NAMES: &[&str] = &["count", "id", "coord1", "coord2", "coord3"];

impl ComputeStyle for PropertyChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let chunks = ChunkRef::read(args, cx)?;
        let mut list = vec![];
        while !args.is_empty() || list.is_empty() {
            let span = args.peek().map_or(cx.span, |w| w.span);
            let name = args.choice("attribute of chunks", NAMES)?;
            list.push(match name {
                "count" => Attribute::Count,
                "id" if chunks.kind.compressed => Attribute::Id,
                "id" => {
                    let text = format!(
                        "`id` needs `compress yes` in compute {}: without it ids are 1, 2, 3 …",
                        chunks.id
                    );
                    return fail(Code::CONFLICT, span, text);
                }
                _ => {
                    let k = NAMES.iter().position(|n| *n == name).unwrap_or(2) - 2;
                    if k >= chunks.kind.coordinates {
                        let n = chunks.kind.coordinates;
                        let text =
                            format!("the chunks of compute {} have {n} coordinates, no `{name}`", chunks.id);
                        return fail(Code::CONFLICT, span, text);
                    }
                    Attribute::Coordinate(k)
                }
            });
        }
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
                into.extend(list.iter().map(|a| match *a {
                    Attribute::Count => counts[k][0],
                    Attribute::Id => chunks.original(k),
                    Attribute::Coordinate(d) => chunks.coordinate(k, d),
                }));
            }
            out.array_cols = list.len();
            Ok(())
        }))
    }
}
