//! compute angmom/chunk: angular momentum of each chunk.

use super::OfChunks;
use super::moments::Rows;
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::matter::solid;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct AngmomChunk;

impl Style for AngmomChunk {
    fn name(&self) -> &'static str {
        "angmom/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Angular momentum of each chunk about its centre of mass.",
            text: "Global array (intensive) of Nchunk rows and 3 columns: Σ m r × v over the particles of the chunk that are in the \
                   group, with r from their centre of mass and positions unwrapped across periodic faces, in mass distance velocity \
                   units. Spheres add 2/5 m R² ω of their own spin (LAMMPS since 2026; in 22Jul2025, and under `compat lammps/2025`, \
                   they are points).",
            example: "compute cc all chunk/atom type\ncompute l all angmom/chunk cc",
        }
    }
}

impl ComputeStyle for AngmomChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Rows { id, group, chunks, columns: 3, of: |w, m| m.angular_momentum(solid(w)).concat() }))
    }
}
