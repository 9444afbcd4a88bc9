//! Chunks: sets of particles numbered by `compute chunk/atom`, and the data that other styles read about
//! them.

pub mod angmom;
mod assign;
pub mod atom;
mod bins;
pub mod com;
pub mod continuum;
mod fields;
pub mod first;
mod grid;
pub mod gyration;
pub mod inertia;
mod kernel;
mod moments;
pub mod omega;
pub mod property;
pub mod reduce;
pub mod spread;
pub mod temp;
pub mod torque;
pub mod vcm;
mod words;

pub use assign::{hold, let_go, window};

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Stage, When};
use perigrain_styles::words::{Kind, Value, Words};
use perigrain_styles::{BuildCx, Chunking, SealCx, Wants};
use perigrain_world::{Numbers, Slot, SlotId, World};

/// A `compute chunk/atom` that another style refers to.
#[derive(Clone, Debug)]
pub struct ChunkRef {
    /// Its ID.
    pub id: String,
    /// The kind of its chunks.
    pub kind: Chunking,
    /// Key of the window in which their number is locked.
    pub window: Numbers,
    span: Span,
}

/// The line of a compute that needs no other words than its chunks.
#[derive(Words)]
struct OfChunks {
    /// The `compute chunk/atom` that makes the chunks.
    #[word(name = "chunkID")]
    chunks: ChunkRef,
}

/// The ID of a `compute chunk/atom`.
impl Value for ChunkRef {
    const KIND: Kind = Kind::Compute;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a compute chunk/atom")?;
        let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
        if let Some(shape) = cx.shape(&r) {
            cx.uses(perigrain_styles::UseKind::Compute, &r.name);
            if let Some(kind) = shape.chunks {
                return Ok(Self::new(r.name, kind, word.span));
            }
            let text = format!("compute `{}` makes no chunks", r.name);
            return Err(Diagnostic::error(Code::WRONG_KIND, word.span, text)
                .help("name a `compute … chunk/atom`")
                .into());
        }
        cx.reading(&r, Wants::PerAtom)?;
        Ok(Self::new(r.name, Chunking::default(), word.span))
    }
}

impl ChunkRef {
    fn new(id: String, kind: Chunking, span: Span) -> Self {
        Self { window: window(&id), id, kind, span }
    }

    /// Key of the lock on the number of chunks, if that number can change: for values with a row per chunk.
    fn varying(&self) -> Option<Numbers> {
        (!self.kind.fixed).then_some(self.window)
    }

    /// The slot with the chunks, updated whenever `when` fires.
    ///
    /// # Errors
    /// As `SealCx::value`.
    pub fn seal(&self, cx: &mut dyn SealCx, stage: Stage, when: &When) -> Result<SlotId> {
        let r = ValueRef { kind: RefKind::Compute, name: self.id.clone(), index: vec![], span: self.span };
        cx.reading(&r, Wants::PerAtom, stage, when)?;
        Ok(cx.slot(&format!("c_{}", self.id)))
    }
}

/// Entries before the coordinates of a chunk in the slot: its original number and its volume.
const HEAD: usize = 2;

/// The chunks of the current step.
#[derive(Clone, Copy)]
pub struct Chunks<'a> {
    slot: &'a Slot,
    stride: usize,
}

impl<'a> Chunks<'a> {
    /// The chunks in the slot of a `compute chunk/atom`.
    pub fn of(w: &'a World, slot: SlotId, kind: Chunking) -> Self {
        Self { slot: w.slots.get(slot), stride: HEAD + kind.coordinates }
    }

    /// The number of chunks.
    pub fn count(&self) -> usize {
        self.slot.inner.len() / self.stride
    }

    /// The chunk of a particle, counted from 0.
    pub fn chunk(&self, i: usize) -> Option<usize> {
        let id = self.slot.atom.get(i).copied().unwrap_or(0.0);
        if id >= 1.0 && id <= self.count() as f64 { Some(id as usize - 1) } else { None }
    }

    /// The number a chunk had before `compress`.
    pub fn original(&self, k: usize) -> f64 {
        self.slot.inner[k * self.stride]
    }

    /// The volume of a chunk's bin, or of the box.
    pub fn volume(&self, k: usize) -> f64 {
        self.slot.inner[k * self.stride + 1]
    }

    /// A coordinate of a chunk's bin.
    pub fn coordinate(&self, k: usize, d: usize) -> f64 {
        self.slot.inner[k * self.stride + HEAD + d]
    }
}

/// Sums `term(i)` by chunk over the particles of a group: rows of `N` numbers. The sums run in storage order
/// and are the same for any number of threads.
pub fn sums<const N: usize>(
    w: &World,
    group: perigrain_world::GroupId,
    chunks: &Chunks,
    term: impl Fn(usize) -> [f64; N],
) -> Vec<[f64; N]> {
    let mut rows = vec![[0.0; N]; chunks.count()];
    for i in (0..w.n()).filter(|&i| w.particles.mask[i] & group.bit() != 0) {
        if let Some(k) = chunks.chunk(i) {
            let t = term(i);
            (0..N).for_each(|d| rows[k][d] += t[d]);
        }
    }
    rows
}
