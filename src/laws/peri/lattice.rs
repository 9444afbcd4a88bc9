//! Forces of a body on a lattice: displacements gathered into rows, slabs swept, forces handed back.

use super::chunk::{self, Chunk, Kernels, Various, constant};
use super::pmb::{UP_TO_3, UP_TO_5, UP_TO_7};
use crate::par::{self, Shared};
use crate::world::families::lattice::{
    CONSTANTS, LANES, LatticeBody, MIXED, PAD, PAGE, RowMotion, STAGGER, greater, lesser, staggered,
};
use crate::world::families::{FamilyOptions, ForceUnit, PeriView, PmbTable, Window};

/// How one force evaluation treats the bonds of a body.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Keep what this step measures.
    pub advance: bool,
    /// Bonds may break.
    pub armed: bool,
    /// Leave out what is at rest.
    pub skip: bool,
}

/// Bits of [`LatticeBody::flagged`].
pub const MAY_BREAK: u8 = 1;
/// Bonded pairs close enough for short-range contact.
pub const SQUEEZED: u8 = 2;

/// Fills the tables of constants, row types and per-cell data from coefficients, types and volumes.
pub fn refresh(body: &mut LatticeBody, view: &PeriView, table: &PmbTable, options: &FamilyOptions) {
    let some = body.particle.iter().copied().filter(|&p| p != u32::MAX);
    let first = some.clone().next().map_or(0.0, |p| view.volume[p as usize]);
    let mut various = some.clone().any(|p| view.volume[p as usize].to_bits() != first.to_bits());
    body.kinds.clear();
    for p in some {
        let kind = view.kind[p as usize];
        if !body.kinds.contains(&kind) {
            body.kinds.push(kind);
        }
    }
    body.kinds.sort_unstable();
    for row in &mut body.rows {
        let cells = row.start as usize..(row.start + row.len) as usize;
        let mut of_row = body.particle[cells].iter().filter(|&&p| p != u32::MAX);
        let kind = of_row.next().map_or(0, |&p| local(&body.kinds, view.kind[p as usize]));
        let same = of_row.all(|&p| local(&body.kinds, view.kind[p as usize]) == kind);
        row.kind = if same { kind } else { MIXED };
        various |= !same;
    }
    body.cell_kind.clear();
    body.cell_volume.clear();
    if various {
        let cells = body.particle.len();
        body.cell_kind.resize(cells + 2 * PAD, 0);
        body.cell_volume.resize(cells + 2 * PAD, 0.0);
        for (cell, &p) in body.particle.iter().enumerate() {
            if p != u32::MAX {
                body.cell_kind[PAD + cell] = local(&body.kinds, view.kind[p as usize]) as u8;
                body.cell_volume[PAD + cell] = view.volume[p as usize];
            }
        }
    }
    fill_tables(body, table, options, first);
}

fn local(kinds: &[u16], kind: u16) -> u16 {
    kinds.iter().position(|&k| k == kind).unwrap_or(0) as u16
}

fn fill_tables(body: &mut LatticeBody, table: &PmbTable, options: &FamilyOptions, volume: f64) {
    let n = body.kinds.len();
    let various = !body.cell_kind.is_empty();
    body.tables.clear();
    body.pairs.clear();
    for pair in 0..n * n {
        let coeff = table.get(body.kinds[pair / n], body.kinds[pair % n]);
        body.pairs.push(coeff.map_or([0.0, f64::INFINITY, 0.0], |k| [k.c, k.s00, k.alpha]));
        let volumes = match options.unit {
            ForceUnit::Density => volume,
            ForceUnit::Newton => volume * volume,
        };
        let c = if various { 1.0 } else { coeff.map_or(0.0, |k| k.c) * volumes };
        for step in &body.stencil {
            let mut row = [0.0; CONSTANTS];
            let mut xi = [0.0; 3];
            for k in 0..3 {
                xi[body.axes[k]] = f64::from(step[k]) * body.spacing;
            }
            row[constant::XI..constant::XI + 3].copy_from_slice(&xi);
            let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
            let inverse = 1.0 / (length * length);
            let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
            let factor = c * weight / length;
            row[constant::DEAD] = options.dead_band(length) * length * length;
            let mut scale = factor * inverse;
            for (k, a) in super::pmb::SERIES.iter().enumerate() {
                row[constant::SERIES + k] = scale * a;
                scale *= inverse;
            }
            row[constant::INVERSE] = inverse;
            row[constant::FACTOR] = factor;
            row[constant::ENERGY] = c * weight * length;
            body.tables.extend_from_slice(&row);
        }
    }
}

/// Gathers displacements from positions into `u[1]`, and what moved since `u[0]`.
pub fn gather(body: &mut LatticeBody, view: &PeriView, reference: &[[f64; 3]]) {
    let [old, new] = &mut body.u;
    let (new, motion) = (Shared::new(new), Shared::new(&mut body.motion));
    let (rows, particle, stride, width) = (&body.rows, &body.particle, body.stride, body.width);
    par::for_rows(body.planes, |plane| {
        for slot in plane * width..(plane + 1) * width {
            let row = rows[slot];
            let cells = row.start as usize..(row.start + row.len) as usize;
            // SAFETY: rows do not share cells, and each row belongs to one plane.
            let u = unsafe {
                [0, 1, 2].map(|k| new.get(k * stride + PAD + cells.start..k * stride + PAD + cells.end))
            };
            let last = [0, 1, 2].map(|k| &old[k * stride + PAD + cells.start..k * stride + PAD + cells.end]);
            // SAFETY: as above, one entry per row.
            let motion = &mut unsafe { motion.get(slot..slot + 1) }[0];
            *motion = gather_row(&particle[cells], view, reference, u, last, row.lo);
        }
    });
}

fn gather_row(
    particle: &[u32],
    view: &PeriView,
    reference: &[[f64; 3]],
    u: [&mut [f64]; 3],
    last: [&[f64]; 3],
    lo: i32,
) -> RowMotion {
    let n = particle.len();
    let wraps = view.bounds.periodic != [false; 3];
    let [ux, uy, uz] = u;
    let (ux, uy, uz) = (&mut ux[..n], &mut uy[..n], &mut uz[..n]);
    for c in 0..n {
        let p = particle[c] as usize;
        let (Some(x), Some(x0)) = (view.x.get(p), reference.get(p)) else { continue };
        let mut now = [x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]];
        if wraps {
            now = unwrap(now, [last[0][c], last[1][c], last[2][c]], view);
        }
        (ux[c], uy[c], uz[c]) = (now[0], now[1], now[2]);
    }
    // Vacant cells stay at zero: they widen the ranges at most.
    let mut motion = RowMotion::NONE;
    for (k, (now, last)) in [&*ux, &*uy, &*uz].into_iter().zip(last).enumerate() {
        (motion.least[k], motion.most[k]) = range_of_change(now, last);
        if let Some(first) = now.iter().position(|&u| u != 0.0) {
            motion.lo = motion.lo.min(lo + first as i32);
            let last = now.iter().rposition(|&u| u != 0.0).unwrap_or(first);
            motion.hi = motion.hi.max(lo + last as i32);
        }
    }
    motion
}

/// The smallest and the largest difference of two columns whose length is a multiple of [`LANES`].
fn range_of_change(now: &[f64], last: &[f64]) -> (f64, f64) {
    let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for (now, last) in now.chunks_exact(LANES).zip(last.chunks_exact(LANES)) {
        for k in 0..LANES {
            let change = now[k] - last[k];
            least[k] = lesser(change, least[k]);
            most[k] = greater(change, most[k]);
        }
    }
    (least.into_iter().fold(f64::INFINITY, lesser), most.into_iter().fold(f64::NEG_INFINITY, greater))
}

/// The displacement among its periodic images that is nearest to the one before.
fn unwrap(now: [f64; 3], before: [f64; 3], view: &PeriView) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        if !view.bounds.periodic[k] {
            return now[k];
        }
        let length = view.bounds.hi[k] - view.bounds.lo[k];
        now[k] - length * ((now[k] - before[k]) / length).round()
    })
}

/// One body during one force evaluation, with the columns that its slabs write.
pub struct Sweep<'a> {
    body: &'a LatticeBody,
    tension: Shared<'a, f32>,
    compression: Shared<'a, f32>,
    measure: Shared<'a, f32>,
    flagged: Shared<'a, u8>,
    mode: Mode,
    newton: bool,
}

/// The body's per-chunk columns, taken out so that slabs can share the rest.
#[derive(Debug, Default)]
pub struct ChunkColumns {
    tension: Vec<f32>,
    compression: Vec<f32>,
    measure: Vec<f32>,
    flagged: Vec<u8>,
}

impl ChunkColumns {
    /// Takes them out of a body.
    pub fn take(body: &mut LatticeBody) -> Self {
        Self {
            tension: std::mem::take(&mut body.tension),
            compression: std::mem::take(&mut body.compression),
            measure: std::mem::take(&mut body.measure),
            flagged: std::mem::take(&mut body.flagged),
        }
    }

    /// Puts them back.
    pub fn give(self, body: &mut LatticeBody) {
        body.tension = self.tension;
        body.compression = self.compression;
        body.measure = self.measure;
        body.flagged = self.flagged;
    }
}

/// What a row needs to know before its chunks are swept.
struct RowPlan {
    /// Coordinates beyond which everything is at rest.
    active: (i32, i32),
    /// Bound on the change of z of any bond since the last step.
    growth: f64,
    /// Smallest s00 and largest alpha of its bonds.
    limit: (f64, f64),
}

impl<'a> Sweep<'a> {
    /// Prepares the sweep of a body.
    pub fn new(body: &'a LatticeBody, columns: &'a mut ChunkColumns, mode: Mode, newton: bool) -> Self {
        Self {
            body,
            tension: Shared::new(&mut columns.tension),
            compression: Shared::new(&mut columns.compression),
            measure: Shared::new(&mut columns.measure),
            flagged: Shared::new(&mut columns.flagged),
            mode,
            newton,
        }
    }

    /// Adds the forces of the bonds of one slab's cells to `f`: written are the particles of this slab and
    /// of the next.
    pub fn slab<K: Kernels>(&self, slab: usize, window: &mut Window, f: &Shared<[f64; 3]>) {
        let body = self.body;
        let own = slab * body.thickness..((slab + 1) * body.thickness).min(body.planes);
        let end = (own.end + body.reach as usize).min(body.planes);
        let first = body.rows[body.slot(own.start, 0)].start as usize;
        let last = body.rows[body.slot(end, 0)].start as usize;
        let (base, stride) = open(window, body, first, last - first);
        let mut touched = false;
        for slot in body.slot(own.start, 0)..body.slot(own.end, 0) {
            if body.rows[slot].len > 0 {
                let plan = self.plan(slot, &mut window.meets, &mut window.to);
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

    /// Looks at the rows that a row's bonds lead to.
    fn plan(&self, slot: usize, meets: &mut Vec<(i32, u32)>, to: &mut Vec<(i32, u32)>) -> RowPlan {
        let body = self.body;
        let mut motion = body.motion[slot];
        partners(body, slot, meets, to);
        for &step in &body.steps {
            motion = motion.with(&body.motion[meet(body, slot, step).0]);
        }
        let limit = row_limit(body, slot);
        let range = [0, 1, 2].map(|k| (motion.most[k] - motion.least[k]).max(0.0) / body.spacing);
        let d = range.iter().map(|r| r * r).sum::<f64>().sqrt();
        // |z' - z| <= (|eta' - eta|/|xi|) (r + r')/|xi| with r < 1.007 |xi|, r' <= r + |eta' - eta|.
        let growth = d * (2.02 + d);
        RowPlan {
            active: (motion.lo.saturating_sub(body.reach), motion.hi.saturating_add(body.reach)),
            growth,
            limit,
        }
    }

    /// Sweeps a row's chunks; returns whether any was not at rest.
    fn row<K: Kernels>(
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
        let (tension, compression, measure, flagged) = unsafe {
            (
                self.tension.get(chunks.clone()),
                self.compression.get(chunks.clone()),
                self.measure.get(chunks.clone()),
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
            let fragile = self.mode.armed && self.mode.advance && high >= floor;
            let track = !rest && (fragile || bound >= f64::from(measure[k]) || !self.mode.advance);
            let cell = chunk * LANES;
            let chunk_data = self.chunk(cell, entries, window, (base, stride, first));
            // SAFETY: live bonds lead to cells of the body that the window covers; both have PAD cells around.
            let measured = unsafe { chunk::run::<K>(&chunk_data, degree, !body.intact[chunk], track) };
            if track {
                (high, low) = measured;
                if fragile && high >= floor {
                    flagged[k] |= MAY_BREAK;
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

    fn chunk<'b>(
        &'b self,
        cell: usize,
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
            to: &window.to,
            tables: &body.tables,
            various,
        }
    }
}

/// The row slot that bonds with a row step lead to, and the pair of local types if both rows have one each.
fn meet(body: &LatticeBody, slot: usize, (across, up): (i32, usize)) -> (usize, Option<usize>) {
    let other = (slot + up * body.width).wrapping_add_signed(across as isize);
    let (a, b) = (body.rows[slot].kind, body.rows[other].kind);
    let uniform = a != MIXED && b != MIXED;
    (other, uniform.then(|| usize::from(a) * body.kinds.len() + usize::from(b)))
}

/// The smallest s00 and the largest alpha of a row's bonds.
pub fn row_limit(body: &LatticeBody, slot: usize) -> (f64, f64) {
    let mut limit = (f64::INFINITY, 0.0f64);
    for &step in &body.steps {
        let pair = meet(body, slot, step).1;
        let known = pair.map_or(&body.pairs[..], |pair| &body.pairs[pair..=pair]);
        for [_, s00, alpha] in known {
            limit = (limit.0.min(*s00), limit.1.max(*alpha));
        }
    }
    limit
}

/// Finds for each stencil vector how many cells further it leads from a row's cells, and the place of its
/// constants; `meets` is scratch.
pub fn partners(body: &LatticeBody, slot: usize, meets: &mut Vec<(i32, u32)>, to: &mut Vec<(i32, u32)>) {
    let row = &body.rows[slot];
    let various = !body.cell_kind.is_empty();
    meets.clear();
    for &step in &body.steps {
        let (other, uniform) = meet(body, slot, step);
        let other = &body.rows[other];
        let offset =
            if other.len == 0 { 0 } else { other.start as i32 - row.start as i32 + row.lo - other.lo };
        let table = if various { 0 } else { uniform.unwrap_or(0) * body.stencil.len() };
        meets.push((offset, (table * CONSTANTS) as u32));
    }
    to.clear();
    for (e, (vector, &step)) in body.stencil.iter().zip(&body.step_of).enumerate() {
        let (offset, table) = meets[usize::from(step)];
        to.push((offset + vector[0], table + (e * CONSTANTS) as u32));
    }
}

/// Makes room for the forces of `cells` cells from `first` on, all zero. Returns where the first one lies and
/// how far components are apart: not at the page offsets of the displacements of the same cells.
fn open(window: &mut Window, body: &LatticeBody, first: usize, cells: usize) -> (usize, usize) {
    let stride = staggered(cells);
    let length = 3 * stride + PAGE + PAD;
    if window.force.len() < length {
        window.force.resize(length, 0.0);
    }
    let page = |p: *const f64| p.addr() / size_of::<f64>() % PAGE;
    let want = (page(body.u[1].as_ptr()) + PAD + first + 3 * STAGGER) % PAGE;
    let base = PAD + (want + 2 * PAGE - page(window.force.as_ptr()) - PAD) % PAGE;
    window.force[base - PAD..base + 3 * stride - PAD].fill(0.0);
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
        _ => chunk::CLOSED,
    }
}

/// The bound at which a chunk that was found at `z` is measured again.
fn next_measure(z: f64) -> f64 {
    [UP_TO_3, UP_TO_5, UP_TO_7].into_iter().find(|&edge| z < 0.95 * edge).unwrap_or(0.0)
}

fn round_up(z: f64) -> f32 {
    (z * (1.0 + 1e-6)) as f32
}
