//! Forces of a body on a lattice: slabs swept, forces handed back.
//!
//! Rows, stencil, bits of bonds and lengths of columns are as `build::lattice` makes them; of bodies from restart files
//! `families::sound` has looked at each of them.

use crate::families::Window;
use crate::families::lattice::{LANES, LatticeBody, PAD, PAGE, RowMotion, STAGGER, staggered};
use crate::lanes::isa::Isa;
use crate::lattice::chunk::{self, Chunk, Various};
use crate::lattice::leads::{ahead, find_leads, row_limit};
use crate::lattice::states::States;
use crate::law::polynomials::{FAR, FARTHEST, UP_TO_FAR, UP_TO_FARTHEST};
use crate::law::series::{UP_TO_3, UP_TO_5, UP_TO_7};
use perigrain_base::par::Shared;

/// How one force evaluation treats the bonds of a body.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Keep what this step measures.
    pub advance: bool,
    /// Bonds may break.
    pub breaking_enabled: bool,
    /// Leave out what is at rest.
    pub skip: bool,
}

/// Any coordinate.
const EVERYWHERE: (i32, i32) = (i32::MIN, i32::MAX);

/// Bits of [`LatticeBody::flagged`].
pub const MAY_BREAK: u8 = 1;
/// Bonded pairs close enough for short-range contact.
pub const SQUEEZED: u8 = 2;

/// One body during one force evaluation, with the columns that its slabs write.
pub struct Sweep<'a> {
    body: &'a LatticeBody,
    tension: Shared<'a, f32>,
    compression: Shared<'a, f32>,
    measure: Shared<'a, f32>,
    floor: Shared<'a, f32>,
    flagged: Shared<'a, u8>,
    growth: Shared<'a, f64>,
    mode: Mode,
    newton: bool,
    states: States<'a>,
}

/// The body's columns by chunks and rows, taken out so that slabs can share the rest.
#[derive(Debug, Default)]
pub struct ChunkColumns {
    tension: Vec<f32>,
    compression: Vec<f32>,
    measure: Vec<f32>,
    floor: Vec<f32>,
    flagged: Vec<u8>,
    growth: Vec<f64>,
}

impl ChunkColumns {
    /// Takes them out of a body.
    pub fn take(body: &mut LatticeBody) -> Self {
        find_leads(body);
        Self {
            tension: std::mem::take(&mut body.tension),
            compression: std::mem::take(&mut body.compression),
            measure: std::mem::take(&mut body.measure),
            floor: std::mem::take(&mut body.floor),
            flagged: std::mem::take(&mut body.flagged),
            growth: std::mem::take(&mut body.growth),
        }
    }

    /// Puts them back.
    pub fn give(self, body: &mut LatticeBody) {
        body.tension = self.tension;
        body.compression = self.compression;
        body.measure = self.measure;
        body.floor = self.floor;
        body.flagged = self.flagged;
        body.growth = self.growth;
    }
}

/// What a row needs to know before its chunks are swept.
pub(crate) struct RowPlan {
    /// Coordinates beyond which everything is at rest.
    pub(crate) active: (i32, i32),
    /// Bound on the change of z of any bond since the last step.
    growth: f64,
    /// Smallest s00 and largest alpha of its bonds.
    limit: (f64, f64),
}

impl<'a> Sweep<'a> {
    /// Prepares the sweep of a body, with what its sites have under its law.
    pub fn new(
        body: &'a LatticeBody,
        columns: &'a mut ChunkColumns,
        mode: Mode,
        newton: bool,
        states: States<'a>,
    ) -> Self {
        Self {
            body,
            states,
            tension: Shared::new(&mut columns.tension),
            compression: Shared::new(&mut columns.compression),
            measure: Shared::new(&mut columns.measure),
            floor: Shared::new(&mut columns.floor),
            flagged: Shared::new(&mut columns.flagged),
            growth: Shared::new(&mut columns.growth),
            mode,
            newton,
        }
    }

    /// Adds the forces of the bonds of one slab's cells to `f`: written are the particles of this slab and
    /// of the next.
    pub fn slab<K: Isa>(&self, slab: usize, window: &mut Window, f: &Shared<[f64; 3]>) {
        let body = self.body;
        let (own, first, last) = extent(body, slab);
        let (base, stride) = open(window, body, first, (last - first, 3));
        let mut touched = false;
        for slot in body.slot(own.start, 0)..body.slot(own.end, 0) {
            if body.rows[slot].len > 0 {
                let plan = self.plan(slot);
                touched |= self.row::<K>(slot, &plan, window, (base, stride, first));
            }
        }
        if !touched {
            return;
        }
        let [fx, fy, fz] = [0, 1, 2].map(|k| &window.force[base + k * stride..][..last - first]);
        for (c, &p) in body.particle[first..last].iter().enumerate() {
            let p = p as usize;
            if p < f.len() {
                // SAFETY: in bounds; a particle has one cell, and slabs that reach it run one after the other.
                let f = unsafe { &mut *f.as_ptr().add(p) };
                *f = [f[0] + fx[c], f[1] + fy[c], f[2] + fz[c]];
            }
        }
    }

    /// The body.
    pub(crate) fn body(&self) -> &'a LatticeBody {
        self.body
    }

    /// What sites have under the law.
    pub(crate) fn states(&self) -> &States<'a> {
        &self.states
    }

    /// Whether what is at rest is left out.
    pub(crate) fn skips(&self) -> bool {
        self.mode.skip
    }

    /// The degree of series that a chunk's bonds need.
    pub(crate) fn degree(&self, chunk: usize, plan: &RowPlan) -> usize {
        // SAFETY: bounds are written by one slab, between sweeps that ask for degrees.
        let (tension, compression) =
            unsafe { (self.tension.get(chunk..chunk + 1)[0], self.compression.get(chunk..chunk + 1)[0]) };
        degree(f64::from(tension.max(compression)) + plan.growth)
    }

    /// Looks at the rows that a row's bonds lead to. How far these move is looked up in the first sweep of an evaluation.
    pub(crate) fn plan(&self, slot: usize) -> RowPlan {
        let body = self.body;
        // SAFETY: a row belongs to one slab.
        let growth = unsafe { &mut self.growth.get(slot..slot + 1)[0] };
        let spread = self.states.spread;
        let motion = (!spread || self.states.kind.bond_based()).then(|| self.motion(slot));
        if let Some(motion) = &motion {
            let range = [0, 1, 2].map(|k| (motion.most[k] - motion.least[k]).max(0.0) / body.spacing);
            let d = range.iter().map(|r| r * r).sum::<f64>().sqrt();
            // |z' - z| <= (|eta' - eta|/|xi|) (r + r')/|xi| with r' <= r + |eta' - eta|; bonds longer than those of the
            // last polynomial are measured in every step.
            *growth = d * (2.0 * (1.0 + UP_TO_FARTHEST).sqrt() + d);
        }
        let at = match &motion {
            Some(motion) if !spread => (motion.lo, motion.hi),
            _ => self.reached(slot),
        };
        let active = (at.0.saturating_sub(body.reach[0]), at.1.saturating_add(body.reach[0]));
        RowPlan { active, growth: *growth, limit: row_limit(body, slot) }
    }

    /// What has moved in a row and in those that its bonds lead to.
    fn motion(&self, slot: usize) -> RowMotion {
        let (body, motion) = (self.body, &self.body.motion);
        body.steps.iter().fold(motion[slot], |m, &step| m.with(&motion[ahead(body, slot, step)]))
    }

    /// Where sites that a row's bonds join have dilatations.
    fn reached(&self, slot: usize) -> (i32, i32) {
        let (body, active) = (self.body, &self.body.state.active);
        if active.is_empty() {
            return EVERYWHERE;
        }
        body.steps.iter().fold(active[slot], |at, &step| {
            let other = active[ahead(body, slot, step)];
            (at.0.min(other.0), at.1.max(other.1))
        })
    }

    /// Sweeps a row's chunks; returns whether any was not at rest.
    fn row<K: Isa>(
        &self,
        slot: usize,
        plan: &RowPlan,
        window: &mut Window,
        (base, stride, first): (usize, usize, usize),
    ) -> bool {
        let body = self.body;
        let row = &body.rows[slot];
        let entries = body.stencil.len();
        let chunks = row.start as usize / LANES..(row.start + row.len) as usize / LANES;
        // SAFETY: a row's chunks belong to it alone, and a row to one slab.
        let (tension, compression, measure, floors, flagged) = unsafe {
            (
                self.tension.get(chunks.clone()),
                self.compression.get(chunks.clone()),
                self.measure.get(chunks.clone()),
                self.floor.get(chunks.clone()),
                self.flagged.get(chunks.clone()),
            )
        };
        let mut touched = false;
        for (k, chunk) in chunks.enumerate() {
            let lo = row.lo + (LANES * k) as i32;
            let rest = lo > plan.active.1 || lo + (LANES as i32) <= plan.active.0;
            flagged[k] = 0;
            if rest && self.mode.advance {
                (tension[k], compression[k], measure[k]) = (0.0, 0.0, UP_TO_3 as f32);
            }
            if rest && self.mode.skip {
                continue;
            }
            touched = true;
            let before = f64::from(tension[k]);
            let (mut high, mut low) = (before + plan.growth, f64::from(compression[k]) + plan.growth);
            let bound = high.max(low);
            let degree = degree(bound);
            let floor = least_critical(plan.limit, before);
            let fragile = self.mode.breaking_enabled && self.mode.advance && high >= floor;
            let squeezed = low >= -body.contact;
            let due = fragile || squeezed || bound >= f64::from(measure[k]);
            let track = !rest && (due || !self.mode.advance);
            let cell = chunk * LANES;
            let chunk_data = self.chunk((slot, cell), entries, window, (base, stride, first));
            // SAFETY: live bonds lead to cells of the body that the window covers; both have PAD cells around.
            let measured = unsafe { self.states.pull::<K>(body, chunk, &chunk_data, degree, track) };
            if track {
                (high, low) = measured;
                if fragile && high >= floor {
                    flagged[k] |= MAY_BREAK;
                    floors[k] = round_down(floor);
                }
                if low >= -body.contact {
                    flagged[k] |= SQUEEZED;
                }
                if self.mode.advance {
                    measure[k] = next_measure(high.max(low)) as f32;
                }
            }
            if self.mode.advance && !rest {
                tension[k] = round_up(high);
                compression[k] = round_up(low);
            }
        }
        touched
    }

    pub(crate) fn chunk<'b>(
        &'b self,
        (slot, cell): (usize, usize),
        entries: usize,
        window: &'b mut Window,
        (base, stride, first): (usize, usize, usize),
    ) -> Chunk<'b> {
        let body = self.body;
        let u = body.u[1].as_ptr();
        let f = window.force.as_mut_ptr();
        let various = (!body.cell_kind.is_empty()).then(|| Various {
            // SAFETY: within the column, which has a place for each cell and PAD more around.
            kind: unsafe { body.cell_kind.as_ptr().add(PAD + cell) },
            // SAFETY: as above.
            volume: unsafe { body.cell_volume.as_ptr().add(PAD + cell) },
            pairs: &body.pairs,
            kinds: body.kinds.len(),
            newton: self.newton,
        });
        Chunk {
            // SAFETY: within `u`, as above.
            u: [0, 1, 2].map(|k| unsafe { u.add(k * body.stride + PAD + cell) }),
            // SAFETY: the window was opened for cells from `first` on that include this one.
            f: [0, 1, 2].map(|k| unsafe { f.add(base + k * stride + cell - first) }),
            alive: &body.alive[cell / LANES * entries..][..entries],
            to: body.leads_of(slot),
            tables: &body.tables,
            various,
        }
    }
}

/// The planes of a slab, and the cells that its bonds touch: those of the slab and of what it reaches.
pub(crate) fn extent(body: &LatticeBody, slab: usize) -> (std::ops::Range<usize>, usize, usize) {
    let own = slab * body.thickness..((slab + 1) * body.thickness).min(body.planes);
    let end = (own.end + body.reach[2] as usize).min(body.planes);
    let first = body.rows[body.slot(own.start, 0)].start as usize;
    let last = body.rows[body.slot(end, 0)].start as usize;
    (own, first, last)
}

/// Makes room for so many components (at most 3) of forces of `cells` cells from `first` on, all zero. Returns where the first one
/// lies and how far components are apart: not at the page offsets of the displacements of the same cells.
pub(crate) fn open(
    window: &mut Window,
    body: &LatticeBody,
    first: usize,
    (cells, components): (usize, usize),
) -> (usize, usize) {
    let stride = staggered(cells);
    let length = 3 * stride + PAGE + PAD;
    if window.force.len() < length {
        window.force.resize(length, 0.0);
    }
    let page = |p: *const f64| p.addr() / size_of::<f64>() % PAGE;
    let want = (page(body.u[1].as_ptr()) + PAD + first + 3 * STAGGER) % PAGE;
    let base = PAD + (want + 2 * PAGE - page(window.force.as_ptr()) - PAD) % PAGE;
    window.force[base - PAD..base + components * stride - PAD].fill(0.0);
    (base, stride)
}

/// A z no bond can break below, for (s00, alpha) and a bound of the bonds' z at the step before: the critical
/// stretch is s00 − alpha s_min with s_min no larger than the bond's own previous stretch, z ≥ 2 s, s ≤ z/2.
pub fn least_critical((s00, alpha): (f64, f64), before: f64) -> f64 {
    (2.0 * s00 - alpha * before) * (1.0 - 1e-6)
}

fn degree(bound: f64) -> usize {
    match bound {
        b if b < UP_TO_3 => 3,
        b if b < UP_TO_5 => 5,
        b if b < UP_TO_7 => 7,
        b if b < UP_TO_FAR => FAR,
        b if b < UP_TO_FARTHEST => FARTHEST,
        _ => chunk::CLOSED,
    }
}

/// The bound at which a chunk that was found at `z` is measured again.
fn next_measure(z: f64) -> f64 {
    let edges = [UP_TO_3, UP_TO_5, UP_TO_7, UP_TO_FAR, UP_TO_FARTHEST];
    edges.into_iter().find(|&edge| z < 0.95 * edge).unwrap_or(0.0)
}

fn round_up(z: f64) -> f32 {
    (z * (1.0 + 1e-6)) as f32
}

fn round_down(z: f64) -> f32 {
    (z - 1e-6 * z.abs()) as f32
}
