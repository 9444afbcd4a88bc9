//! compute msd/chunk, vacf/chunk: state of chunks compared with their state at the first run.

use super::moments::{mean, weighted};
use super::{ChunkRef, Chunks, OfChunks};
use crate::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, sub};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{check_masses, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, IMAGE, KIND, MASK, MASS, MEMO, SLOTS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Key, Numbers, SlotId, World};

/// `compute msd/chunk`.
pub struct MsdChunk;

/// `compute vacf/chunk`.
pub struct VacfChunk;

impl Style for MsdChunk {
    fn name(&self) -> &'static str {
        "msd/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Squared displacement of each chunk's centre of mass.",
            text: "Global array (intensive) of Nchunk rows and 4 columns in distance² units: dx², dy², dz² and their sum, of the centre of \
                   mass of the chunk's particles that are in the group since the first run after this line began; positions are \
                   unwrapped across periodic faces. The number of chunks must stay: `nchunk once` (and `ids once`, if the \
                   particles of a chunk are to stay) of the `compute chunk/atom`. Restart files hold the beginning.",
            example: "compute cc all chunk/atom type nchunk once\ncompute m all msd/chunk cc",
        }
    }
}

impl Style for VacfChunk {
    fn name(&self) -> &'static str {
        "vacf/chunk"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfChunks::GRAMMAR),
            summary: "Velocity autocorrelation of each chunk's centre of mass.",
            text: "Global array (intensive) of Nchunk rows and 4 columns in velocity² units: the products of the three components of the \
                   velocity of the centre of mass, of the chunk's particles that are in the group, with what they were when the first \
                   run after this line began, and their sum. The number of chunks must stay, as for compute msd/chunk. Restart files \
                   hold the beginning.",
            example: "compute cc all chunk/atom type nchunk once\ncompute v all vacf/chunk cc",
        }
    }
}

impl ComputeStyle for MsdChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let compare = |now: Vec3, then: Vec3| sub(now, then).map(|d| d * d);
        declared(self.name(), unwrapped, compare, args, cx)
    }
}

impl ComputeStyle for VacfChunk {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let compare = |now: Vec3, then: Vec3| std::array::from_fn(|d| now[d] * then[d]);
        declared(self.name(), |w, i| w.particles.v[i], compare, args, cx)
    }
}

fn declared(
    style: &'static str,
    of: fn(&World, usize) -> Vec3,
    compare: fn(Vec3, Vec3) -> Vec3,
    args: &mut Args,
    cx: &BuildCx,
) -> Result<Box<dyn Compute>> {
    let OfChunks { chunks } = read(args, cx)?;
    Ok(Box::new(SinceFirst { id: cx.id.to_string(), group: cx.group, style, chunks, of, compare }))
}

#[derive(Clone)]
struct SinceFirst {
    id: String,
    group: GroupId,
    style: &'static str,
    chunks: ChunkRef,
    /// The per-particle quantity.
    of: fn(&World, usize) -> Vec3,
    /// The output from its mean now and its initial mean.
    compare: fn(Vec3, Vec3) -> Vec3,
}

impl SinceFirst {
    /// Key of the initial state.
    fn key(&self) -> Numbers {
        Key::new(&format!("compute {} beginning", self.id))
    }

    fn same_number(&self, now: usize, then: usize) -> Result<()> {
        if now == then {
            return Ok(());
        }
        let text = format!("compute {} {}: there were {then} chunks and now are {now}", self.id, self.style);
        Err(Diagnostic::error(Code::CONFLICT, None, text)
            .help(format!("use `nchunk once` in compute {}", self.chunks.id))
            .into())
    }
}

impl Compute for SinceFirst {
    fn shape(&self) -> Shape {
        Shape { array: 4, array_rows: Shape::OPEN, ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn begins(&self) -> bool {
        true
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, span, key) = (self.clone(), cx.span(), self.key());
        check_masses(cx.world(), span)?;
        let (chunks, kind) = (self.chunks.seal(cx, stage, when)?, self.chunks.kind);
        let name = format!("compute {}", self.id);
        let op = StepOp::new(
            name,
            stage,
            Needs::new()
                .read(X | V | IMAGE | MASS | MASK | BOX | TYPE_MASS | KIND)
                .write(SLOTS)
                .keep(MEMO)
                .only(&[key.text()]),
            move |w: &mut World, t| {
                let now = weighted(w, me.group, &Chunks::of(w, chunks, kind), me.of);
                let now: Vec<Vec3> = now.into_iter().map(mean).collect();
                let first = w.memo.get_or(key, || now.concat());
                me.same_number(now.len(), first.len() / 3)?;
                let rows = now.iter().zip(first.chunks_exact(3)).flat_map(|(now, then)| {
                    let [x, y, z] = (me.compare)(*now, [then[0], then[1], then[2]]);
                    [x, y, z, x + y + z]
                });
                let rows: Vec<f64> = rows.collect();
                let out = w.slots.get_mut(slot);
                (out.step, out.array, out.array_cols) = (Some(t.step), rows, 4);
                out.chunks = me.chunks.varying();
                Ok(())
            },
        );
        Ok(op.when(when.clone()).in_setup(true).boxed())
    }
}
