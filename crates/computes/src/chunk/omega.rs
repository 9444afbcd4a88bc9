//! compute omega/chunk: angular velocity of each chunk.

use super::OfChunks;
use super::moments::{Members, Rows};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_commands::momentum::rotation;
use perigrain_lang::Args;
use perigrain_styles::matter::solid;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::World;

/// The style.
pub struct OmegaChunk;

impl Style for OmegaChunk {
    fn name(&self) -> &'static str {
        "omega/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Angular velocity of each chunk.",
            text: "Global array (intensive) of Nchunk rows and 3 columns: the ω with I ω = L, I and L being the chunk's inertia tensor \
                   and angular momentum (compute inertia/chunk, angmom/chunk), in radians per time. About axes whose moment is \
                   smaller than a millionth of the largest nothing turns: chunks of one particle \
                   and about the line through two (LAMMPS, and `compat lammps`, does so only where det I is below 10⁻⁶).",
            example: "compute cc all chunk/atom type\ncompute w all omega/chunk cc",
        }
    }
}

impl ComputeStyle for OmegaChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfChunks { chunks } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Rows { id, group, chunks, columns: 3, of: omega }))
    }
}

fn omega(w: &World, m: &Members) -> Vec<f64> {
    let lammps = w.settings.lammps();
    // LAMMPS has fixed only the other two computes.
    let solid = solid(w) && !lammps;
    let turning = m.inertia(solid).into_iter().zip(m.angular_momentum(solid));
    let all = turning
        .map(|([xx, yy, zz, xy, yz, xz], l)| rotation([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], l, lammps));
    all.flatten().collect()
}
