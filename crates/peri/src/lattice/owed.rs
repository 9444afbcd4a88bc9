//! What tiles owe to cells: windows added up and handed back.

use crate::families::lattice::{LANES, LatticeBody, PAD};
use crate::families::tiles::Tiles;
use crate::pass::Windows;
use crate::shares::dues::overlap;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::par::Shared;

/// Cells that are added up together: they stay in the fastest memory.
const PIECE: usize = 16 * LANES;

/// Windows that are added up without asking for memory; more come only where tiles are much smaller than bonds are long.
const FEW: usize = 32;

/// What one window holds for cells of a plane.
#[derive(Clone, Copy)]
struct Part<'a, const N: usize> {
    /// First and past the last cell.
    cells: [usize; 2],
    /// The numbers of these, by components.
    sums: [&'a [f64]; N],
}

impl<const N: usize> Part<'_, N> {
    /// Of no cells.
    const NONE: Self = Self { cells: [0; 2], sums: [&[]; N] };
}

/// What is owed to a tile's cells in one plane, at the beginning of `room`, which has a place for each window: by the tile itself, then by those that reach into it, in their order. Tiles at rest owe
/// nothing: they would add zeros.
fn parts<'a, 'r, const N: usize>(
    body: &LatticeBody,
    (tiles, tile): (&Tiles, usize),
    plane: usize,
    windows: &'a Windows,
    room: &'r mut [Part<'a, N>],
) -> &'r [Part<'a, N>] {
    let mut owed = 0;
    for giver in std::iter::once(tile).chain(tiles.graph.givers(tile).iter().map(|&giver| giver as usize)) {
        // SAFETY: a tile settles when it and those that reach into it have been swept.
        let window = unsafe { windows.get(giver) };
        if !window.touched {
            continue;
        }
        let Some((cells, at)) = overlap(body, (tiles, giver, tile), plane) else { continue };
        let from = |k: usize| window.base + k * window.stride + cells[0] - at.first;
        let sums = std::array::from_fn(|k| &window.sums[from(k)..][..cells[1] - cells[0]]);
        room[owed] = Part { cells, sums };
        owed += 1;
    }
    &room[..owed]
}

/// Calls `act` for each plane of a tile that is owed something, with what that is.
fn by_planes<const N: usize>(
    body: &LatticeBody,
    (tiles, tile): (&Tiles, usize),
    windows: &Windows,
    mut act: impl FnMut(usize, &[Part<N>]),
) {
    let (mut few, mut many) = ([Part::NONE; FEW], vec![]);
    let windows_at_most = 1 + tiles.graph.givers(tile).len();
    let room = match few.get_mut(..windows_at_most) {
        Some(few) => few,
        None => {
            many.resize(windows_at_most, Part::NONE);
            &mut many[..]
        }
    };
    for plane in tiles.all[tile].planes.clone() {
        let owed = parts(body, (tiles, tile), plane, windows, room);
        if !owed.is_empty() {
            act(plane, owed);
        }
    }
}

/// Adds to the forces on a tile's particles what is owed to them.
pub(crate) fn forces(
    form: Form,
    body: &LatticeBody,
    (tiles, tile): (&Tiles, usize),
    windows: Windows,
    f: &Shared<[f64; 3]>,
) {
    by_planes(body, (tiles, tile), &windows, |plane, parts| {
        let rows = &tiles.all[tile].rows;
        let cells = [rows.start, rows.end].map(|row| body.rows[body.slot(plane, row)].start as usize);
        // SAFETY: the processor has the form, which `Families::force` has chosen; each particle is in one cell of one tile.
        unsafe { form.run(HandBack { cells, parts, particle: &body.particle, f }) };
    });
}

/// Adds to sums by cells, which have [`PAD`] entries before the first one, what is owed to a tile's.
pub(crate) fn sums(body: &LatticeBody, (tiles, tile): (&Tiles, usize), windows: Windows, sums: &Shared<f64>) {
    by_planes::<1>(body, (tiles, tile), &windows, |_, owed| {
        for part in owed {
            // SAFETY: a tile's cells are its own.
            let sums = unsafe { sums.get(PAD + part.cells[0]..PAD + part.cells[1]) };
            sums.iter_mut().zip(part.sums[0]).for_each(|(sum, more)| *sum += more);
        }
    });
}

/// The same for several columns of sums, each so many entries behind the one before.
pub(crate) fn columns<const N: usize>(
    body: &LatticeBody,
    (tiles, tile): (&Tiles, usize),
    windows: Windows,
    (sums, stride): (&Shared<f64>, usize),
) {
    by_planes::<N>(body, (tiles, tile), &windows, |_, owed| {
        for (part, k) in owed.iter().flat_map(|part| (0..N).map(move |k| (part, k))) {
            let first = k * stride + PAD;
            // SAFETY: a tile's cells are its own.
            let sums = unsafe { sums.get(first + part.cells[0]..first + part.cells[1]) };
            sums.iter_mut().zip(part.sums[k]).for_each(|(sum, more)| *sum += more);
        }
    });
}

/// Forces for the particles of some cells.
struct HandBack<'a, 'b> {
    /// First and past the last cell.
    cells: [usize; 2],
    parts: &'a [Part<'b, 3>],
    /// Of all cells.
    particle: &'a [u32],
    f: &'a Shared<'a, [f64; 3]>,
}

impl InLanes for HandBack<'_, '_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let mut sum = [[0.0; PIECE]; 3];
        for first in (self.cells[0]..self.cells[1]).step_by(PIECE) {
            let end = (first + PIECE).min(self.cells[1]);
            add_up(&mut sum, self.parts, [first, end]);
            let groups = self.particle[first..end].chunks_exact(LANES);
            for (group, particles) in groups.enumerate() {
                let Some(particles) = particles.first_chunk() else { break };
                // SAFETY: the caller's promise.
                unsafe { hand_back(particles, &sum, group * LANES, self.f) };
            }
        }
    }
}

/// Adds up what is owed to the cells from one to another.
#[inline(always)]
fn add_up(sum: &mut [[f64; PIECE]; 3], parts: &[Part<3>], [first, end]: [usize; 2]) {
    let mut parts = parts.iter();
    let all = parts.clone().next().filter(|part| part.cells[0] <= first && part.cells[1] >= end);
    match all {
        Some(part) => {
            parts.next();
            for (sum, from) in sum.iter_mut().zip(part.sums) {
                sum[..end - first].copy_from_slice(&from[first - part.cells[0]..end - part.cells[0]]);
            }
        }
        None => sum.iter_mut().for_each(|sum| sum[..end - first].fill(0.0)),
    }
    for part in parts {
        let (low, high) = (part.cells[0].max(first), part.cells[1].min(end));
        if low >= high {
            continue;
        }
        for (sum, more) in sum.iter_mut().zip(part.sums) {
            let more = &more[low - part.cells[0]..high - part.cells[0]];
            for (sum, more) in sum[low - first..high - first].iter_mut().zip(more) {
                *sum += more;
            }
        }
    }
}

/// Adds the sums from `at` on to the forces on some particles; vacant cells have none.
///
/// # Safety
/// Nothing else may touch the forces on these particles.
#[inline(always)]
unsafe fn hand_back(particles: &[u32; LANES], sum: &[[f64; PIECE]; 3], at: usize, f: &Shared<[f64; 3]>) {
    for (lane, &p) in particles.iter().enumerate() {
        let p = p as usize;
        if p < f.len() {
            // SAFETY: in bounds; the caller's promise.
            let f = unsafe { &mut *f.as_ptr().add(p) };
            for (f, sum) in f.iter_mut().zip(sum) {
                *f += sum[at + lane];
            }
        }
    }
}
