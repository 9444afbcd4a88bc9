//! compute gyration/chunk: radius or tensor of gyration of each chunk.

use super::ChunkRef;
use super::moments::{Members, Rows};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{SIX, dot};
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::World;

/// The style.
pub struct GyrationChunk;

impl Style for GyrationChunk {
    fn name(&self) -> &'static str {
        "gyration/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Radius of gyration of each chunk.",
            text: "Global vector (intensive) of length Nchunk: √(Σ m r² / Σ m) over the particles of the chunk that are in the group, \
                   with r from their centre of mass and positions unwrapped across periodic faces, in distance units. Zeros for chunks without \
                   mass.",
            example: "compute cc all chunk/atom type\ncompute g all gyration/chunk cc tensor",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
    /// A global array of 6 columns xx, yy, zz, xy, xz, yz in place of the vector: Σ m r_a r_b / Σ m, in distance² units.
    #[word(flag)]
    tensor: bool,
}

impl ComputeStyle for GyrationChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { chunks, tensor } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(match tensor {
            true => Rows { id, group, chunks, columns: 6, of: tensors },
            false => Rows { id, group, chunks, columns: 1, of: radii },
        }))
    }
}

fn over(mass: f64, sum: f64) -> f64 {
    if mass > 0.0 { sum / mass } else { 0.0 }
}

fn radii(_w: &World, m: &Members) -> Vec<f64> {
    let sums = m.sums(|_, mass, d| [dot(d, d) * mass]);
    sums.iter().zip(&m.mass).map(|([sum], mass)| over(*mass, *sum).sqrt()).collect()
}

fn tensors(_w: &World, m: &Members) -> Vec<f64> {
    let sums = m.sums(|_, mass, d| SIX.map(|(a, b)| mass * d[a] * d[b]));
    sums.iter().zip(&m.mass).flat_map(|(row, mass)| row.map(|sum| over(*mass, sum))).collect()
}
