//! compute torque/chunk: torque on each chunk.

use super::OfChunks;
use super::moments::{Members, Rows};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::cross;
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::World;

/// The style.
pub struct TorqueChunk;

impl Style for TorqueChunk {
    fn name(&self) -> &'static str {
        "torque/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Torque on each chunk about its centre of mass.",
            text: "Global array (intensive) of Nchunk rows and 3 columns: Σ r × f over the particles of the chunk that are in the \
                   group, with r from their centre of mass and positions unwrapped across periodic faces, in force distance units \
                   (of force densities for peridynamic particles in LAMMPS' convention). Torques on single spheres are left out, as \
                   in LAMMPS.",
            example: "compute cc all chunk/atom type\ncompute t all torque/chunk cc",
        }
    }
}

impl ComputeStyle for TorqueChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        let of = |w: &World, m: &Members| m.sums(|i, _, d| cross(d, w.particles.f[i])).concat();
        Ok(Box::new(Rows { id, group, chunks, columns: 3, of }))
    }
}
