//! Forces of a body on a lattice: tiles swept into their windows.
//!
//! Rows, stencil, bits of bonds and lengths of columns are as `setup::lattice` makes them; of bodies from restart files
//! `families::sound` has looked at each of them.

use crate::families::lattice::{
    LANES, LatticeBody, MAY_BREAK, PAD, PAGE, RowMotion, SQUEEZED, STAGGER, staggered,
};
use crate::families::shares::BodyShare;
use crate::families::tiles::{TileWindow, Tiles};
use crate::lattice::chunk::{self, Chunk, Various};
use crate::lattice::leads::{ahead, find_leads, row_limit};
use crate::lattice::owed;
use crate::lattice::states::States;
use crate::law::polynomials::{FAR, FARTHEST, UP_TO_FAR, UP_TO_FARTHEST};
use crate::law::series::{UP_TO_3, UP_TO_5, UP_TO_7};
use crate::pass::{Over, pass};
use crate::shares::dues::{OfLattice, with_share};
use perigrain_base::math::form::Form;
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
    /// Which kernels.
    pub form: Form,
}

/// Any coordinate.
const EVERYWHERE: (i32, i32) = (i32::MIN, i32::MAX);

/// One body during one force evaluation, with the columns that its tiles write.
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

/// The body's columns by chunks and rows, taken out so that tiles can share the rest.
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

    /// Adds the forces of all bonds to `f`.
    /// Of several ranks each sweeps its share.
    pub(crate) fn all(
        &self,
        (tiles, windows): (&Tiles, &mut [TileWindow]),
        share: Option<&mut BodyShare>,
        f: &Shared<[f64; 3]>,
    ) {
        let owing = OfLattice { body: self.body, tiles, components: 3 };
        with_share(&owing, share, |share| {
            pass(
                Over { graph: &tiles.graph, windows, times: &tiles.graph.times, share },
                |tile, window| self.tile((tiles, tile), window),
                |tile, windows| owed::forces(self.mode.form, self.body, (tiles, tile), windows, f),
            );
        });
    }

    /// Sweeps a tile: the forces of its cells' bonds go into its window. Returns whether any bond was not at rest; else the
    /// window is not touched.
    fn tile(&self, (tiles, tile): (&Tiles, usize), window: &mut TileWindow) -> bool {
        let mut room = Room { body: self.body, tiles, tile, components: 3, window, open: false };
        for (slot, first) in room.rows() {
            let plan = self.plan(slot);
            self.row(slot, &plan, &mut room, first);
        }
        room.open
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
        // SAFETY: bounds are written by one tile, between sweeps that ask for degrees.
        let (tension, compression) =
            unsafe { (self.tension.get(chunk..chunk + 1)[0], self.compression.get(chunk..chunk + 1)[0]) };
        degree(f64::from(tension.max(compression)) + plan.growth)
    }

    /// Looks at the rows that a row's bonds lead to. How far these move is looked up in the first sweep of an evaluation.
    pub(crate) fn plan(&self, slot: usize) -> RowPlan {
        let body = self.body;
        // SAFETY: a row belongs to one tile.
        let growth = unsafe { &mut self.growth.get(slot..slot + 1)[0] };
        let spread = self.states.spread;
        let motion = (!spread || self.states.law.bond_based).then(|| self.motion(slot));
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
        let active = match body.scatter.heated() {
            true => EVERYWHERE,
            false => (at.0.saturating_sub(body.reach[0]), at.1.saturating_add(body.reach[0])),
        };
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

    /// Sweeps a row's chunks; `first` is the cell with which the window would begin were all its planes like this one.
    fn row(&self, slot: usize, plan: &RowPlan, room: &mut Room, first: usize) {
        let body = self.body;
        let row = &body.rows[slot];
        let chunks = row.start as usize / LANES..(row.start + row.len) as usize / LANES;
        // SAFETY: a row's chunks belong to it alone, and a row to one tile.
        let (tension, compression, measure, floors, flagged) = unsafe {
            (
                self.tension.get(chunks.clone()),
                self.compression.get(chunks.clone()),
                self.measure.get(chunks.clone()),
                self.floor.get(chunks.clone()),
                self.flagged.get(chunks.clone()),
            )
        };
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
            let chunk_data = self.chunk((slot, cell), &body.tables, room.at(cell, first));
            let measured = self.states.pull(body, chunk, &chunk_data, degree, track);
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
    }

    /// What the loop over a chunk's bonds needs, with constants, and the place of its cells in a window.
    pub(crate) fn chunk<'b>(
        &'b self,
        (slot, cell): (usize, usize),
        tables: &'b [f64],
        f: [*mut f64; 3],
    ) -> Chunk<'b> {
        let (body, entries) = (self.body, self.body.stencil.len());
        let u = body.u[1].as_ptr();
        let various = (!body.cell_kind.is_empty()).then(|| Various {
            kind: body.cell_kind.as_ptr().wrapping_add(PAD + cell),
            volume: body.cell_volume.as_ptr().wrapping_add(PAD + cell),
            pairs: &body.pairs,
            kinds: body.kinds.len(),
            newton: self.newton,
        });
        let u = [0, 1, 2].map(|k| u.wrapping_add(k * body.stride + PAD + cell));
        let alive = &body.alive[cell / LANES * entries..][..entries];
        // SAFETY: columns have a place for each cell and PAD more around; live bonds lead to cells of the body that the window covers, which
        // has PAD cells around as well.
        unsafe { Chunk::new((u, f), (alive, body.leads_of(slot), tables), various) }
    }
}

/// A tile being swept, and its window, which is opened when the first of its bonds is not at rest.
pub(crate) struct Room<'a> {
    pub(crate) body: &'a LatticeBody,
    pub(crate) tiles: &'a Tiles,
    pub(crate) tile: usize,
    /// Sums for each cell, at most three.
    pub(crate) components: usize,
    pub(crate) window: &'a mut TileWindow,
    /// Whether it has been opened.
    pub(crate) open: bool,
}

impl<'a> Room<'a> {
    /// The row slots of the tile that have cells, with [`Reached::first`](crate::families::tiles::Reached::first) of their plane.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<'a> {
        let (body, tile) = (self.body, &self.tiles.all[self.tile]);
        let planes = tile.planes.clone().zip(self.tiles.reached(self.tile));
        let slots = planes
            .flat_map(move |(plane, at)| tile.rows.clone().map(move |row| (body.slot(plane, row), at.first)));
        slots.filter(|(slot, _)| body.rows[*slot].len > 0)
    }

    /// Where a cell's sums are: of one of the tile's own, in a plane whose window would begin with the cell `first`.
    pub(crate) fn at(&mut self, cell: usize, first: usize) -> [*mut f64; 3] {
        if !self.open {
            self.open = true;
            self.open();
        }
        let TileWindow { sums, base, stride, .. } = &mut *self.window;
        let sums = sums.as_mut_ptr();
        // All components lie within the window, which covers the tile's cells.
        [0, 1, 2].map(|k| sums.wrapping_add(*base + k * *stride + cell - first))
    }

    /// Makes room for the sums of all cells that the tile's bonds reach, all zero. They do not lie at the page offsets of the
    /// displacements of the same cells.
    fn open(&mut self) {
        let reached = self.tiles.reached(self.tile);
        let [Some(bottom), Some(top)] = [reached.first(), reached.last()] else { return };
        let stride = staggered(top.cells[1] - top.first);
        let length = 3 * stride + PAGE + PAD;
        self.window.sums = self.tiles.graph.take_room();
        let TileWindow { sums, .. } = &mut *self.window;
        if sums.len() < length {
            sums.resize(length, 0.0);
        }
        let page = |p: *const f64| p.addr() / size_of::<f64>() % PAGE;
        let want = (page(self.body.u[1].as_ptr()) + PAD + bottom.first + 3 * STAGGER) % PAGE;
        let base = PAD + (want + 2 * PAGE - page(sums.as_ptr()) - PAD) % PAGE;
        for k in 0..self.components {
            for at in reached {
                let from = base + k * stride;
                sums[from + at.cells[0] - at.first..from + at.cells[1] - at.first].fill(0.0);
            }
        }
        (self.window.base, self.window.stride) = (base, stride);
    }
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
