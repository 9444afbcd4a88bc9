//! compute vcm/chunk: velocity of the centre of mass of each chunk.

use super::OfChunks;
use super::com::Means;
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct VcmChunk;

impl Style for VcmChunk {
    fn name(&self) -> &'static str {
        "vcm/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Velocity of the centre of mass of each chunk.",
            text: "Global array (intensive) of Nchunk rows and 3 columns: Σ m v / Σ m over the particles of the chunk that \
                   are in the group, in velocity units; zeros for chunks without mass.",
            example: "compute cc all chunk/atom type\ncompute v all vcm/chunk cc",
        }
    }
}

impl ComputeStyle for VcmChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        Ok(Box::new(Means { id: cx.id.to_string(), group: cx.group, chunks, of: |w, i| w.particles.v[i] }))
    }
}
