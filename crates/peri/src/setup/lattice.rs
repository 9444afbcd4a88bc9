//! Laying out a body on a lattice: rows, half stencil, alive bits.

use crate::families::lattice::{LANES, LatticeBody, Row, RowMotion, staggered};
use crate::families::{FamilyOptions, PeriView, PmbTable};
use crate::setup::detect::distance;
use crate::setup::sites::Sites;
use perigrain_base::math::cell::{Basis, Turn, beside, point, reciprocal};
use perigrain_base::math::vec3::{dot, length};

/// Types mixed in a row cost this many cells' worth each when the direction of rows is chosen.
const TYPE_CHANGE: usize = 64;

/// Horizons beyond so many spacings have stencils that no body fills.
const FARTHEST: f64 = 12.0;

/// A body's bounding box may have this many sites per particle.
const SPARSEST: usize = 64;

/// The lattice layout of a body, and initial partners' volumes and numbers added up; `None`
/// if the body has several horizons, or leaves so many sites vacant that a list is better.
pub fn lay_out(
    view: &PeriView,
    members: &[u32],
    sites: &Sites,
    table: &PmbTable,
    options: &FamilyOptions,
    family_volume: &mut [f64],
    family_size: &mut [u16],
) -> Option<LatticeBody> {
    let horizon = one_horizon(view, members, table)?;
    let cut = options.volume.reach(horizon, options.lattice_spacing);
    if cut > FARTHEST * sites.nearest {
        return None;
    }
    let frames = sites.directions.iter().filter_map(|&along| Frame::of(view, members, sites, along));
    let frame = frames.min_by_key(|frame| frame.cost)?;
    let mut body = LatticeBody { spacing: sites.nearest, basis: frame.basis, horizon, ..Default::default() };
    stencil(&mut body, cut)?;
    rows(&mut body, members, &frame);
    let all = std::mem::take(&mut body.stencil);
    let Pruned { stencil, steps, step_of } = prune(&body, all);
    (body.stencil, body.steps, body.step_of) = (stencil, steps, step_of);
    columns(&mut body);
    connect(&mut body, view, table, options, (family_volume, family_size));
    Some(body)
}

fn one_horizon(view: &PeriView, members: &[u32], table: &PmbTable) -> Option<f64> {
    let mut kinds: Vec<u16> = members.iter().map(|&i| view.kind[i as usize]).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let pairs = kinds.iter().flat_map(|&a| kinds.iter().map(move |&b| (a, b)));
    let mut horizons = pairs.filter_map(|(a, b)| table.get(a, b)).map(|c| c.horizon);
    let first = horizons.next()?;
    (kinds.len() < 256 && horizons.all(|h| h == first)).then_some(first)
}

/// Sites as (along rows, across rows, across planes) from 0, with rows in one direction.
struct Frame {
    basis: Basis,
    at: Vec<[i32; 3]>,
    size: [usize; 3],
    /// Cells with padding.
    cells: usize,
    /// What a sweep over them costs.
    cost: usize,
}

impl Frame {
    /// `None` where the box around the body would have too many rows, or rows too many vacant cells.
    fn of(view: &PeriView, members: &[u32], sites: &Sites, along: [i32; 3]) -> Option<Self> {
        let mut turn = beside(&sites.basis, along)?;
        let extent = |turn: &Turn| {
            let (mut lo, mut hi) = ([i32::MAX; 3], [i32::MIN; 3]);
            for at in sites.at.iter().map(|at| turn.of(*at)) {
                (lo, hi) = ([0, 1, 2].map(|k| lo[k].min(at[k])), [0, 1, 2].map(|k| hi[k].max(at[k])));
            }
            (lo, [0, 1, 2].map(|k| (hi[k] - lo[k] + 1) as usize))
        };
        let (mut lo, mut size) = extent(&turn);
        // Planes follow each other along the longer direction. In the order of creation rows of a disc
        // half as high as wide are gathered sooner, which is 5 to 8 % of its steps on one core.
        if size[1] > size[2] {
            turn = turn.exchanged();
            (lo, size) = extent(&turn);
        }
        let slots = size[1].checked_mul(size[2])?;
        if slots > SPARSEST * members.len() + 65_536 {
            return None;
        }
        let at = sites.at.iter().map(|at| turn.of(*at)).map(|at| [0, 1, 2].map(|k| at[k] - lo[k])).collect();
        let mut frame = Self { basis: turn.basis(&sites.basis), at, size, cells: 0, cost: 0 };
        let changes = frame.count(view, members)?;
        // Along x, LAMMPS' creation order makes gathering cheaper.
        let easy = frame.basis[0][0] > (1.0 - 1e-9) * length(frame.basis[0]);
        frame.cost = (frame.cells + TYPE_CHANGE * changes) * if easy { 20 } else { 23 };
        Some(frame)
    }

    /// Counts cells with padding; returns how often types change along rows, or `None` if too many cells are vacant.
    fn count(&mut self, view: &PeriView, members: &[u32]) -> Option<usize> {
        let slot = |at: &[i32; 3]| at[1] as usize + self.size[1] * at[2] as usize;
        let mut extent = vec![(i32::MAX, i32::MIN); self.size[1] * self.size[2]];
        for at in &self.at {
            let e = &mut extent[slot(at)];
            *e = (e.0.min(at[0]), e.1.max(at[0]));
        }
        let length = |e: &(i32, i32)| if e.0 > e.1 { 0 } else { (e.1 - e.0 + 1) as usize };
        self.cells = extent.iter().map(|e| length(e).next_multiple_of(LANES)).sum();
        if self.cells > 4 * members.len() + 512 || self.cells > u32::MAX as usize / 32 {
            return None;
        }
        let first = view.kind[members[0] as usize];
        if members.iter().all(|&i| view.kind[i as usize] == first) {
            return Some(0);
        }
        let mut start = vec![0];
        start.extend(extent.iter().scan(0, |sum, e| {
            *sum += length(e);
            Some(*sum)
        }));
        let mut kind = vec![0u16; start[extent.len()]];
        for (&i, at) in members.iter().zip(&self.at) {
            kind[start[slot(at)] + (at[0] - extent[slot(at)].0) as usize] = view.kind[i as usize];
        }
        let rows = start.windows(2).map(|ends| &kind[ends[0]..ends[1]]);
        Some(rows.map(|row| row.windows(2).filter(|w| w[0] != w[1] && w[0] != 0 && w[1] != 0).count()).sum())
    }
}

/// Half of all lattice vectors within the cut; `None` if there are more than can be numbered.
fn stencil(body: &mut LatticeBody, cut: f64) -> Option<()> {
    body.reach = reach(&body.basis, cut)?;
    body.stencil = half_stencil(&body.basis, body.reach, cut * cut);
    (body.stencil.len() < usize::from(u16::MAX)).then_some(())
}

/// How far vectors up to a length reach along those of a lattice.
pub fn reach(basis: &Basis, cut: f64) -> Option<[i32; 3]> {
    // n is the product of a vector with a reciprocal one.
    Some(reciprocal(basis)?.map(|r| (cut * length(r) * (1.0 + 1e-9)).floor() as i32))
}

/// Half of all lattice vectors within this reach whose square is no larger, in the order of stencils.
pub fn half_stencil(basis: &Basis, reach: [i32; 3], square: f64) -> Vec<[i32; 3]> {
    let most = square * (1.0 + 2e-9);
    let mut stencil = vec![];
    for along in -reach[0]..=reach[0] {
        for up in 0..=reach[2] {
            for across in -reach[1]..=reach[1] {
                let xi = point(basis, [along, across, up]);
                if (up, across, along) > (0, 0, 0) && dot(xi, xi) <= most {
                    stencil.push([along, across, up]);
                }
            }
        }
    }
    stencil
}

/// What of a stencil leads from rows to rows.
pub struct Pruned {
    /// Its vectors.
    pub stencil: Vec<[i32; 3]>,
    /// The row steps in it.
    pub steps: Vec<(i32, usize)>,
    /// Which of the steps each vector takes.
    pub step_of: Vec<u16>,
}

/// Leaves of a stencil what leads from rows to rows of a body, and finds the row steps in it.
pub fn prune(body: &LatticeBody, all: Vec<[i32; 3]>) -> Pruned {
    let slots: Vec<usize> = (0..body.planes * body.width).filter(|&slot| body.rows[slot].len > 0).collect();
    let mut known: Vec<((i32, usize), bool)> = vec![];
    let mut leads = |step: (i32, usize)| {
        let found = known.iter().position(|s| s.0 == step).unwrap_or_else(|| {
            let ahead = |slot: &usize| (slot + step.1 * body.width).wrapping_add_signed(step.0 as isize);
            known.push((step, slots.iter().any(|slot| body.rows[ahead(slot)].len > 0)));
            known.len() - 1
        });
        known[found].1
    };
    let step = |vector: &[i32; 3]| (vector[1], vector[2] as usize);
    let stencil: Vec<[i32; 3]> = all.into_iter().filter(|vector| leads(step(vector))).collect();
    let (mut steps, mut step_of): (Vec<(i32, usize)>, _) = (vec![], vec![]);
    for step in stencil.iter().map(step) {
        let known = steps.iter().position(|&s| s == step);
        step_of.push(known.unwrap_or(steps.len()) as u16);
        if known.is_none() {
            steps.push(step);
        }
    }
    Pruned { stencil, steps, step_of }
}

fn rows(body: &mut LatticeBody, members: &[u32], frame: &Frame) {
    let [_, across, up] = frame.size;
    let [_, beside, above] = body.reach.map(|r| r as usize);
    body.planes = up;
    body.width = across + 2 * beside;
    let mut extent = vec![(i32::MAX, i32::MIN); body.width * (up + above + 1)];
    let slot = |at: &[i32; 3]| at[2] as usize * body.width + at[1] as usize + beside;
    for at in &frame.at {
        let e = &mut extent[slot(at)];
        *e = (e.0.min(at[0]), e.1.max(at[0]));
    }
    let mut start = 0;
    body.rows = Vec::with_capacity(extent.len());
    for (lo, hi) in extent {
        let len = if lo > hi { 0 } else { ((hi - lo + 1) as u32).next_multiple_of(LANES as u32) };
        body.rows.push(Row { start, len, lo: if len > 0 { lo } else { 0 }, kind: 0 });
        start += len;
    }
    body.particle = vec![u32::MAX; start as usize];
    for (&i, at) in members.iter().zip(&frame.at) {
        let row = &body.rows[slot(at)];
        body.particle[row.start as usize + (at[0] - row.lo) as usize] = i;
    }
}

/// Columns by cells, chunks and rows.
fn columns(body: &mut LatticeBody) {
    let cells = body.particle.len();
    let chunks = cells / LANES;
    body.stride = staggered(cells);
    body.u = [(); 2].map(|()| vec![0.0; 3 * body.stride]);
    body.alive = vec![0; chunks * body.stencil.len()];
    body.intact = vec![false; chunks];
    body.tension = vec![0.0; chunks];
    body.compression = vec![0.0; chunks];
    body.measure = vec![0.0; chunks];
    body.floor = vec![0.0; chunks];
    body.flagged = vec![0; chunks];
    body.motion = vec![RowMotion::NONE; body.rows.len()];
}

/// Sets the alive bits of all bonds.
fn connect(
    body: &mut LatticeBody,
    view: &PeriView,
    table: &PmbTable,
    options: &FamilyOptions,
    (family_volume, family_size): (&mut [f64], &mut [u16]),
) {
    let entries = body.stencil.len();
    body.contact = f64::NEG_INFINITY;
    for slot in 0..body.planes * body.width {
        let row = body.rows[slot];
        for e in 0..entries {
            let [along, across, up] = body.stencil[e];
            if row.len == 0 {
                break;
            }
            let other = body.rows[(slot + up as usize * body.width).wrapping_add_signed(across as isize)];
            let shift = along + row.lo - other.lo;
            for c in 0..row.len as i32 {
                let to = c + shift;
                if to < 0 || to >= other.len as i32 {
                    continue;
                }
                let cell = row.start as usize + c as usize;
                let (i, j) = (body.particle[cell], body.particle[other.start as usize + to as usize]);
                if i == u32::MAX || j == u32::MAX {
                    continue;
                }
                let (a, b) = (i as usize, j as usize);
                let Some(coeff) = table.get(view.kind[a], view.kind[b]) else { continue };
                let cut = options.volume.reach(coeff.horizon, options.lattice_spacing);
                let (rsq, _) = distance(view, i, j);
                if rsq <= cut * cut && !view.excludes(i, j) {
                    body.alive[cell / LANES * entries + e] |= 1 << (cell % LANES);
                    family_volume[a] += view.volume[b];
                    family_volume[b] += view.volume[a];
                    family_size[a] += 1;
                    family_size[b] += 1;
                    let contact = options.contact_range(view, i, j);
                    body.contact = body.contact.max(contact * contact / rsq - 1.0);
                }
            }
        }
    }
    for slot in 0..body.planes * body.width {
        let row = body.rows[slot];
        let leads = |e: &usize| {
            let [_, across, up] = body.stencil[*e];
            body.rows[(slot + up as usize * body.width).wrapping_add_signed(across as isize)].len > 0
        };
        let vectors: Vec<usize> = if row.len > 0 { (0..entries).filter(leads).collect() } else { vec![] };
        for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
            let whole = |&e: &usize| body.alive[chunk * entries + e] == u8::MAX;
            body.intact[chunk] = vectors.iter().all(whole);
        }
    }
}
