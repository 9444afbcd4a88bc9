//! Sweeps of bond laws over a body on a lattice.

use crate::families::lattice::{LANES, LatticeBody, PAD, Row, RowMotion};
use crate::families::shares::BodyShare;
use crate::families::tiles::{TileWindow, Tiles};
use crate::lattice::chunk::{CELLS, Chunk, SUMS};
use crate::lattice::energies::Looking;
use crate::lattice::forms::run_term;
use crate::lattice::kernels::Cells;
use crate::lattice::owed;
use crate::lattice::sweep::{Room, Sweep};
use crate::law::moment::Moment;
use crate::law::style::Style;
use crate::law::terms::{Dilatation, Norm, NormLammps, Sum, Term};
use crate::pass::{Over, pass};
use crate::shares::agreed;
use crate::shares::dues::{OfLattice, with_share};
use perigrain_base::math::form::Form;
use perigrain_base::par::Shared;

/// What the sites and bonds of a body have under their law, during one evaluation.
#[derive(Clone, Copy)]
pub struct States<'a> {
    /// Which kernels.
    pub form: Form,
    /// The law.
    pub law: &'static Style,
    /// LAMMPS' forces where they differ.
    pub compat: bool,
    /// What is the same for all bonds.
    pub moment: Moment,
    /// Keep what bonds remember.
    pub keep: bool,
    /// What bonds remember.
    pub memory: &'a Shared<'a, f64>,
    /// Whether a chunk's bonds remember anything.
    pub touched: &'a Shared<'a, u8>,
    /// Sites have dilatations already: they reach farther than displacements.
    pub spread: bool,
}

impl States<'_> {
    fn cells<'b>(&'b self, body: &LatticeBody, chunk: usize) -> Cells<'b> {
        let (first, place) = (PAD + chunk * LANES, chunk * body.stencil.len() * self.law.memory() * LANES);
        let columns = body.state.columns.as_ptr().wrapping_add(first);
        let last = [0, 1, 2].map(|k| body.u[0].as_ptr().wrapping_add(k * body.stride + first));
        let memory = self.memory.as_ptr().wrapping_add(place);
        let touched = self.touched.as_ptr().wrapping_add(chunk);
        let half = body.leads.half.get(chunk).copied().unwrap_or(false);
        // SAFETY: columns and displacements have a place for each cell and PAD more around, memory one for each chunk, which is of one tile;
        // laws without them read nothing.
        unsafe {
            Cells::new((columns, body.stride), last, (memory, touched), &self.moment, [self.keep, half])
        }
    }

    /// Adds the forces of a chunk's bonds.
    pub fn pull(
        &self,
        body: &LatticeBody,
        chunk: usize,
        data: &Chunk,
        degree: usize,
        track: bool,
    ) -> (f64, f64) {
        let law = self.law.loops_at(self.compat, &self.moment);
        law.chunk(self.form, (data, &self.cells(body, chunk)), degree, !body.intact[chunk], track)
    }

    /// Energy and virial of a chunk's bonds, cell by cell; in densities but for volumes.
    pub fn sums(
        &self,
        body: &LatticeBody,
        chunk: usize,
        data: &Chunk,
        advanced: bool,
    ) -> [[f64; CELLS]; SUMS] {
        let ((states, half), first) = (self.law.shares(self.compat), PAD + chunk * LANES);
        let look = Looking {
            theta: body.state.theta.as_ptr().wrapping_add(first),
            before: body.state.before.as_ptr().wrapping_add(first),
            unrelaxed: body.state.unrelaxed.as_ptr().wrapping_add(first),
            terms: &body.state.tables,
            half,
            states,
            advanced,
        };
        self.law.loops(self.compat).chunk_sums(self.form, (data, &self.cells(body, chunk)), &look)
    }
}

/// Adds the terms of all bonds to `sums`, which has [`PAD`] entries before the first cell.
pub(crate) fn all(
    sweep: &Sweep,
    sum: Sum,
    (tiles, windows): (&Tiles, &mut [TileWindow]),
    share: Option<&mut BodyShare>,
    sums: &Shared<f64>,
) {
    let owing = OfLattice { body: sweep.body(), tiles, components: 1 };
    with_share(&owing, share, |share| {
        pass(
            Over { graph: &tiles.graph, windows, times: &[], share },
            |at, window| tile(sweep, sum, (tiles, at), window),
            |at, windows| owed::sums(sweep.body(), (tiles, at), windows, sums),
        )
    });
}

/// Adds the terms of the bonds of one tile's cells to its window; returns whether any was not at rest.
fn tile(sweep: &Sweep, sum: Sum, tile: (&Tiles, usize), window: &mut TileWindow) -> bool {
    match sum {
        Sum::Dilatation => add_up::<Dilatation>(sweep, tile, window),
        Sum::Norm => add_up::<Norm>(sweep, tile, window),
        Sum::NormLammps => add_up::<NormLammps>(sweep, tile, window),
    }
}

fn add_up<T: Term>(sweep: &Sweep, (tiles, tile): (&Tiles, usize), window: &mut TileWindow) -> bool {
    let body = sweep.body();
    let mut room = Room { body, tiles, tile, components: 1, window, open: false };
    for (slot, first) in room.rows() {
        let row = &body.rows[slot];
        let plan = sweep.plan(slot);
        for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
            let lo = row.lo + (chunk * LANES) as i32 - row.start as i32;
            let rest = lo > plan.active.1 || lo + (LANES as i32) <= plan.active.0;
            if rest && sweep.skips() {
                continue;
            }
            let degree = sweep.degree(chunk, &plan);
            let cell = chunk * LANES;
            let tables = &body.state.tables;
            let data = sweep.chunk((slot, cell), tables, room.at(cell, first));
            let cells = sweep.states().cells(body, chunk);
            run_term::<T>(sweep.states().form, (&data, &cells), degree, !body.intact[chunk]);
        }
    }
    room.open
}

/// Whether every chunk of these row slots has a cell that is not at rest.
fn all_move(body: &LatticeBody, own: impl Fn(usize) -> bool) -> bool {
    let moves = |row: &Row, motion: &RowMotion| {
        motion.lo < row.lo + LANES as i32 && motion.hi >= row.lo + row.len as i32 - LANES as i32
    };
    let rows = body.rows.iter().zip(&body.motion).enumerate().filter(|(slot, _)| own(*slot));
    rows.map(|(_, row)| row).all(|(row, motion)| row.len == 0 || moves(row, motion))
}

/// Finds for each row the coordinates beyond which no site has a dilatation, or under a law with memory has ever had; for no
/// row where none is at rest. Each of several ranks has the motion of its share of rows.
pub fn find_active(body: &mut LatticeBody, remembers: bool, share: Option<&BodyShare>) {
    let mut active = std::mem::take(&mut body.state.active);
    active.clear();
    let all = || match share {
        None => all_move(body, |_| true),
        Some(share) => agreed(all_move(body, |slot| share.own[slot])),
    };
    if !remembers && all() {
        body.state.active = active;
        return;
    }
    active.resize(body.rows.len(), (i32::MAX, i32::MIN));
    let mut join = |slot: usize, lo: i32, hi: i32| {
        active[slot] = (active[slot].0.min(lo), active[slot].1.max(hi));
    };
    for slot in (0..body.planes * body.width).filter(|&slot| body.rows[slot].len > 0) {
        let own = body.motion[slot];
        join(slot, own.lo, own.hi);
        for &(across, up) in &body.steps {
            let ahead = (slot + up * body.width).wrapping_add_signed(across as isize);
            let other = body.motion[ahead];
            join(slot, other.lo, other.hi);
            join(ahead, own.lo, own.hi);
        }
    }
    let reach = body.reach[0];
    for at in active.iter_mut().filter(|at| at.0 <= at.1) {
        *at = (at.0.saturating_sub(reach), at.1.saturating_add(reach));
    }
    if remembers {
        let awake = &mut body.state.awake;
        awake.resize(active.len(), (i32::MAX, i32::MIN));
        for (awake, at) in awake.iter_mut().zip(&mut active) {
            *awake = (awake.0.min(at.0), awake.1.max(at.1));
            *at = *awake;
        }
    }
    body.state.active = active;
}
