//! compute com/chunk: centre of mass of each chunk.

use super::{ChunkRef, Chunks, OfChunks, sums};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses, unwrapped};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, IMAGE, KIND, MASK, MASS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct ComChunk;

impl Style for ComChunk {
    fn name(&self) -> &'static str {
        "com/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Centre of mass of each chunk.",
            text: "Global array (intensive) of Nchunk rows and 3 columns: Σ m x / Σ m over the particles of the chunk that \
                   are in the group, with positions unwrapped across periodic faces, in distance units; zeros for chunks \
                   without mass.",
            example: "compute cc all chunk/atom type\ncompute c all com/chunk cc",
        }
    }
}

impl ComputeStyle for ComChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        Ok(Box::new(Means { id: cx.id.to_string(), group: cx.group, chunks, of: unwrapped }))
    }
}

/// Mass-weighted means of a vector per particle.
#[derive(Clone)]
pub(super) struct Means {
    pub(super) id: String,
    pub(super) group: GroupId,
    pub(super) chunks: ChunkRef,
    pub(super) of: fn(&World, usize) -> [f64; 3],
}

impl Compute for Means {
    fn shape(&self) -> Shape {
        Shape { array: 3, array_rows: Shape::OPEN, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, kind, of, span) = (self.group, self.chunks.kind, self.of, cx.span());
        check_masses(cx.world(), span)?;
        let (chunks, varying) = (self.chunks.seal(cx, stage, when)?, self.chunks.varying());
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | V | IMAGE | MASS | MASK | BOX | KIND | TYPE_MASS,
            move |w, _, out| {
                let masses = Masses::of(w);
                let rows = sums(w, group, &Chunks::of(w, chunks, kind), |i| {
                    let (m, [x, y, z]) = (masses.get(i), of(w, i));
                    [x * m, y * m, z * m, m]
                });
                (out.array_cols, out.chunks) = (3, varying);
                out.array.clear();
                for [x, y, z, m] in rows {
                    out.array.extend([x, y, z].map(|a| if m > 0.0 { a / m } else { 0.0 }));
                }
                Ok(())
            },
        ))
    }
}
