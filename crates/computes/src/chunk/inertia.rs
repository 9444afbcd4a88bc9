//! compute inertia/chunk: inertia tensor of each chunk.

use super::OfChunks;
use super::moments::Rows;
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::matter::solid;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct InertiaChunk;

impl Style for InertiaChunk {
    fn name(&self) -> &'static str {
        "inertia/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Inertia tensor of each chunk.",
            text: "Global array (intensive) of Nchunk rows and 6 columns xx, yy, zz, xy, yz, xz: Σ m (r² δ_ab − r_a r_b) over the \
                   particles of the chunk that are in the group, with r from their centre of mass and positions unwrapped across \
                   periodic faces, in mass distance² units. Spheres add 2/5 m R² of their own (LAMMPS since 2026; in 22Jul2025, and \
                   under `compat lammps/2025`, they are points).",
            example: "compute cc all chunk/atom type\ncompute i all inertia/chunk cc",
        }
    }
}

impl ComputeStyle for InertiaChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Rows { id, group, chunks, columns: 6, of: |w, m| m.inertia(solid(w)).concat() }))
    }
}
