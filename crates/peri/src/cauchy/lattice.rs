//! Correspondence on lattices: reference bonds are constant, so that sums and forces are a few multiplications for each bond.

use crate::families::lattice::{LANES, Lead};
use crate::families::tiles::{TileWindow, Tiles};
use crate::lattice::chunk::{CELLS, Chunk, Constants, constant, extremes, give, place, various};
use crate::lattice::kernels::Cells;
use crate::lattice::owed;
use crate::lattice::sweep::{Room, Sweep};
use crate::pass::{Over, pass};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::par::Shared;

/// In the table of sums: ω w V xi, three components.
pub(crate) const TERM: usize = constant::XI;

/// Adds Σ ω w eta⊗xi V of all bonds to nine columns of sums, a body's stride apart, in three sweeps: one for each component of eta.
pub(crate) fn add_gradients(sweep: &Sweep, (tiles, windows): (&Tiles, &mut [TileWindow]), sums: &mut [f64]) {
    let stride = sweep.body().stride;
    for (component, sums) in sums.chunks_exact_mut(3 * stride).enumerate() {
        let sums = Shared::new(sums);
        pass(
            Over { graph: &tiles.graph, windows: &mut *windows, times: &[], share: None },
            |tile, window| add_tile(sweep, component, (tiles, tile), window),
            |tile, windows| owed::columns::<3>(sweep.body(), (tiles, tile), windows, (&sums, stride)),
        );
    }
}

/// The same of one tile's bonds into its window; returns whether any was not at rest.
fn add_tile(
    sweep: &Sweep,
    component: usize,
    (tiles, tile): (&Tiles, usize),
    window: &mut TileWindow,
) -> bool {
    let body = sweep.body();
    let mut room = Room { body, tiles, tile, components: 3, window, open: false };
    for (slot, first) in room.rows() {
        let (row, plan) = (&body.rows[slot], sweep.plan(slot));
        for chunk in row.chunks() {
            let lo = row.lo + (chunk * LANES) as i32 - row.start as i32;
            if sweep.skips() && (lo > plan.active.1 || lo + (LANES as i32) <= plan.active.0) {
                continue;
            }
            let cell = chunk * LANES;
            let data = sweep.chunk((slot, cell), &body.state.tables, room.at(cell, first));
            add_chunk(sweep.states().form, &data, component, body.intact[chunk]);
        }
    }
    room.open
}

/// Adds one component of eta times ω w V xi over a chunk's bonds to the sums of both ends; if `whole`, all bonds of all its cells live.
fn add_chunk(form: Form, a: &Chunk, component: usize, whole: bool) {
    // SAFETY: forms are those of the processor; for memory, the chunk answers.
    unsafe {
        match (whole, a.various.is_some()) {
            (true, false) => form.run(Add::<false, false>(a, component)),
            (false, false) => form.run(Add::<true, false>(a, component)),
            (_, true) => form.run(Add::<true, true>(a, component)),
        }
    }
}

/// See [`add_chunk`].
struct Add<'a, const MASKED: bool, const VARIOUS: bool>(&'a Chunk<'a>, usize);

impl<const MASKED: bool, const VARIOUS: bool> InLanes for Add<'_, MASKED, VARIOUS> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(a, component) = self;
        // SAFETY: the caller's promise covers every address formed below.
        unsafe {
            let zero = V::all(0.0);
            let u = a.u[component];
            // Two vectors of four cells, or one of eight (the second then stays unused).
            let own = [V::read(u), V::read(u.add(CELLS - N))];
            let mut sum = [[zero; 3]; 2];
            let mut lead = 0;
            while lead < a.to.len() {
                let Lead { to, due, table, e } = *a.to.get_unchecked(lead);
                let bits = *a.alive.get_unchecked(e as usize);
                lead += 1;
                if MASKED && bits == 0 {
                    continue;
                }
                let c = &*a.tables.as_ptr().add(table as usize).cast::<Constants>();
                let mut v = 0;
                while v < CELLS / N {
                    let here = N * v;
                    let other = here as isize + to as isize;
                    let mut eta = V::read(u.offset(other)) - own[v];
                    if MASKED {
                        eta = eta.keep(eta.mask(bits >> here));
                    }
                    let (mut near, mut far) = (eta, eta);
                    if VARIOUS && let Some(cells) = a.various {
                        near = near * V::read(cells.volume.offset(other));
                        far = far * V::read(cells.volume.add(here));
                    }
                    let mut k = 0;
                    while k < 3 {
                        let term = zero.like(c[TERM + k]);
                        sum[v][k] = near.fma(term, sum[v][k]);
                        let to = a.f[k].offset(here as isize + due as isize);
                        far.fma(term, V::read(to)).write(to);
                        k += 1;
                    }
                    v += 1;
                }
            }
            give(&a.f, &sum);
        }
    }
}

/// Adds the forces of a chunk's bonds to both ends. Returns the largest z and the largest −z if `track`. Without `masked` all bonds of all
/// its cells must live.
pub(crate) fn pull(form: Form, (a, s): (&Chunk, &Cells), masked: bool, track: bool) -> (f64, f64) {
    // SAFETY: forms are those of the processor; for memory, chunk and cells answer.
    unsafe {
        match (masked, track, a.various.is_some()) {
            (false, false, false) => form.run(Pull::<false, false, false>(a, s)),
            (true, false, false) => form.run(Pull::<true, false, false>(a, s)),
            (_, true, false) => form.run(Pull::<true, true, false>(a, s)),
            (_, _, true) => form.run(Pull::<true, true, true>(a, s)),
        }
    }
}

/// See [`pull`].
struct Pull<'a, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(&'a Chunk<'a>, &'a Cells<'a>);

/// Number `k` of the sites `here` and of those at their other ends, added.
#[inline(always)]
unsafe fn both<const N: usize, V: Lanes<N>>(s: &Cells, k: usize, here: usize, other: isize) -> V {
    // SAFETY: the caller's promise.
    unsafe {
        let column = s.columns.add(k * s.stride);
        V::read(column.add(here)) + V::read(column.offset(other))
    }
}

impl<const MASKED: bool, const TRACK: bool, const VARIOUS: bool> InLanes
    for Pull<'_, MASKED, TRACK, VARIOUS>
{
    type Out = (f64, f64);
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> (f64, f64) {
        let Self(a, s) = self;
        // SAFETY: the caller's promise covers every address formed below.
        unsafe {
            let zero = V::all(0.0);
            let (mut high, mut low) = (zero, zero);
            let half = (CELLS - N) as isize;
            let u: [[V; 3]; 2] = [place(&a.u, 0), place(&a.u, half)];
            let mut sum = [[zero; 3]; 2];
            let mut lead = 0;
            while lead < a.to.len() {
                let Lead { to, due, table, e } = *a.to.get_unchecked(lead);
                let bits = *a.alive.get_unchecked(e as usize);
                lead += 1;
                if MASKED && bits == 0 {
                    continue;
                }
                let c = &*a.tables.as_ptr().add(table as usize).cast::<Constants>();
                let mut v = 0;
                while v < CELLS / N {
                    let here = N * v;
                    let (other, bits) = (here as isize + to as isize, bits >> here);
                    let there: [V; 3] = place(&a.u, other);
                    let eta = [there[0] - u[v][0], there[1] - u[v][1], there[2] - u[v][2]];
                    if TRACK {
                        let q = eta[2] * (eta[2] + 2.0 * c[constant::XI + 2]);
                        let q = eta[1].fma(eta[1] + 2.0 * c[constant::XI + 1], q);
                        let q = eta[0].fma(eta[0] + 2.0 * c[constant::XI], q);
                        let z = (q * c[constant::INVERSE]).keep(q.mask(bits));
                        high = z.most(high);
                        low = z.least(low);
                    }
                    let mut factor = zero.like(c[constant::FACTOR]);
                    if MASKED {
                        factor = factor.keep(factor.mask(bits));
                    }
                    let (mut near, mut far) = (factor, factor);
                    if VARIOUS {
                        (near, far) = various::<N, V, false>(a, (near, far), here, other);
                    }
                    let control: V = both(s, 9, here, other);
                    let mut k = 0;
                    while k < 3 {
                        let mut pull = control * eta[k];
                        let mut d = 0;
                        while d < 3 {
                            let m: V = both(s, 3 * k + d, here, other);
                            pull = m.fma(zero.like(c[constant::XI + d]), pull);
                            d += 1;
                        }
                        sum[v][k] = near.fma(pull, sum[v][k]);
                        let to = a.f[k].offset(here as isize + due as isize);
                        far.fnma(pull, V::read(to)).write(to);
                        k += 1;
                    }
                    v += 1;
                }
            }
            give(&a.f, &sum);
            if TRACK { extremes(high, low) } else { (0.0, 0.0) }
        }
    }
}
