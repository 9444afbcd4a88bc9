//! Cutting a body on a lattice into tiles, and passes over them.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Instant;

use crate::families::lattice::{LatticeBody, PAGE};
use crate::families::tiles::{Reached, Tile, TileWindow, Tiles};
use perigrain_base::par::{self, Shared};

/// Rows of a tile at most. Fewer cost more than the windows they make smaller: what a row's bonds reach has to be fetched once more on
/// either side of a cut (measured: three tiles of 12 rows and all planes take 1.06 of the time, 32 of all 34 rows and 2 planes 1.01).
const MOST_ROWS: usize = 64;

/// Planes of a tile at most, the larger numbers first: fewer forces are handed over.
const PLANES: [usize; 4] = [6, 4, 3, 2];

/// So many tiles keep threads equally busy.
const ENOUGH: usize = 32;

/// A body with fewer cells has tiles with as many planes as may be: their sweeps take less time than to hand over work.
const FEW_CELLS: usize = 4096;

/// Lays out a body's tiles, if that has not been done yet.
pub(crate) fn lay_tiles(body: &mut LatticeBody) {
    if body.tiles.all.is_empty() {
        body.tiles = lay_out(body);
    }
}

/// Into how many blocks rows and planes are cut: a rule that knows the body alone.
fn blocks(body: &LatticeBody) -> [usize; 2] {
    let across = body.width - 2 * body.reach[1] as usize;
    let cut = PLANES.map(|planes| [across.div_ceil(MOST_ROWS), body.planes.div_ceil(planes)]);
    if body.particle.len() < FEW_CELLS {
        return cut[0];
    }
    cut.into_iter().find(|[rows, planes]| rows * planes >= ENOUGH).unwrap_or(cut[PLANES.len() - 1])
}

fn lay_out(body: &LatticeBody) -> Tiles {
    let [across, up] = blocks(body);
    let margin = body.reach[1] as usize;
    let rows = body.width - 2 * margin;
    // Blocks alike in size.
    let share = |n: usize, k: usize, of: usize| n * k / of..n * (k + 1) / of;
    let mut places: Vec<[usize; 2]> = (0..up).flat_map(|z| (0..across).map(move |y| [y, z])).collect();
    places.sort_by_key(|&place| along_curve(place, across.max(up)));
    let mut tiles = Tiles::default();
    for [y, z] in places {
        let rows = share(rows, y, across);
        let (planes, rows) = (share(body.planes, z, up), rows.start + margin..rows.end + margin);
        let own = |plane: usize| {
            (body.slot(plane, rows.start)..body.slot(plane, rows.end)).map(|s| body.rows[s].len)
        };
        if planes.clone().flat_map(own).all(|len| len == 0) {
            continue;
        }
        let first = tiles.reached.len();
        tiles.reached.extend(window_of(body, &planes, &rows));
        let reached = first..tiles.reached.len();
        tiles.all.push(Tile { planes, rows, reached, givers: 0..0, takers: 0..0 });
    }
    introduce(&mut tiles, body);
    tiles.windows.resize_with(tiles.all.len(), TileWindow::default);
    tiles.unswept.resize_with(tiles.all.len(), Default::default);
    tiles.unsettled.resize_with(tiles.all.len(), Default::default);
    tiles
}

/// The planes that bonds of a block reach. Each begins at the same place of a page as its cells do in the body's columns: kernels
/// then write at other places of pages than they read at.
fn window_of(body: &LatticeBody, planes: &Range<usize>, rows: &Range<usize>) -> Vec<Reached> {
    let end = (planes.end + body.reach[2] as usize).min(body.planes);
    let mut window: Vec<Reached> = Vec::with_capacity(end - planes.start);
    for plane in planes.start..end {
        let (mut low, mut high) =
            if planes.contains(&plane) { (rows.start, rows.end) } else { (usize::MAX, 0) };
        let reaching = |step: &&(i32, usize)| plane >= step.1 && planes.contains(&(plane - step.1));
        for &(across, _) in body.steps.iter().filter(reaching) {
            low = low.min(rows.start.saturating_add_signed(across as isize));
            high = high.max(rows.end.saturating_add_signed(across as isize));
        }
        if low >= high {
            (low, high) = (rows.start, rows.start);
        }
        let cells = [low, high].map(|row| body.rows[body.slot(plane, row)].start as usize);
        let first = match window.last() {
            None => cells[0],
            Some(below) => below.first + (cells[0] - below.cells[1]) / PAGE * PAGE,
        };
        window.push(Reached { rows: [low, high], cells, first });
    }
    window
}

/// Finds which tiles reach into which.
fn introduce(tiles: &mut Tiles, body: &LatticeBody) {
    let reaches = |giver: usize, taker: &Tile| {
        let own = tiles.all[giver].planes.start;
        let mut window = (own..).zip(tiles.reached(giver));
        window.any(|(plane, at)| {
            let rows = at.rows[0].max(taker.rows.start)..at.rows[1].min(taker.rows.end);
            let slots = body.slot(plane, rows.start)..body.slot(plane, rows.end);
            taker.planes.contains(&plane) && slots.into_iter().any(|slot| body.rows[slot].len > 0)
        })
    };
    let n = tiles.all.len();
    let mut givers = vec![vec![]; n];
    let mut takers: Vec<Vec<u32>> = (0..n as u32).map(|k| vec![k]).collect();
    for taker in 0..n {
        for giver in (0..n).filter(|&giver| giver != taker && reaches(giver, &tiles.all[taker])) {
            givers[taker].push(giver as u32);
            takers[giver].push(taker as u32);
        }
    }
    for (tile, (givers, takers)) in tiles.all.iter_mut().zip(givers.iter().zip(&takers)) {
        tile.givers = tiles.givers.len()..tiles.givers.len() + givers.len();
        tile.takers = tiles.takers.len()..tiles.takers.len() + takers.len();
        tiles.givers.extend(givers);
        tiles.takers.extend(takers);
    }
}

/// How far along a Hilbert curve through `n` by `n` places (or the next power of two) one of them lies: what lies near each other on the
/// curve lies near each other in the body.
fn along_curve([mut x, mut y]: [usize; 2], n: usize) -> usize {
    let (mut at, mut side) = (0, n.next_power_of_two() / 2);
    while side > 0 {
        let (right, above) = (usize::from(x & side > 0), usize::from(y & side > 0));
        at += side * side * ((3 * right) ^ above);
        (x, y) = (x & (side - 1), y & (side - 1));
        if above == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
        side /= 2;
    }
    at
}

/// What a pass goes over.
pub(crate) struct Over<'a, 's> {
    /// The tiles.
    pub(crate) tiles: &'a Tiles,
    /// Their windows.
    pub(crate) windows: &'a mut [TileWindow],
    /// Their times, where these are kept.
    pub(crate) times: &'a [[AtomicU64; 2]],
    /// This rank's share of them, where others have the rest; how to hand windows over.
    pub(crate) share: Option<HandOver<'s>>,
}

/// A rank's share of tiles, and the exchange of windows with other ranks.
pub(crate) struct HandOver<'a> {
    /// This rank's tiles.
    pub(crate) own: Range<usize>,
    /// Those of them that others' bonds reach.
    pub(crate) waits: &'a [usize],
    /// Hands windows over to other ranks and takes theirs.
    pub(crate) exchange: &'a mut dyn FnMut(&mut [TileWindow]),
}

/// Sweeps each tile into its window (`sweep(tile, window)` says whether any bond was not at rest), and settles a tile as soon as all whose
/// bonds reach into it have been swept: `settle(tile, windows)`. In which order tiles settle makes no difference: each adds up the
/// windows of its givers in their order, to cells that no other tile has. Tiles that wait for other ranks settle after these have sent
/// their windows.
pub(crate) fn pass(
    over: Over,
    sweep: impl Fn(usize, &mut TileWindow) -> bool + Sync,
    settle: impl Fn(usize, Windows) + Sync,
) {
    let Over { tiles, windows, times, share } = over;
    let own = share.as_ref().map_or(0..tiles.all.len(), |share| share.own.clone());
    let here = |tile: u32| own.contains(&(tile as usize));
    // With one more for other ranks, where these give or take something.
    let count = |list: &[u32]| {
        let some = list.iter().filter(|tile| here(**tile)).count();
        (some + usize::from(some < list.len())) as u32
    };
    for k in own.clone() {
        tiles.unswept[k].store(1 + count(tiles.givers(k)), Ordering::Relaxed);
        tiles.unsettled[k].store(count(tiles.takers(k)), Ordering::Relaxed);
    }
    let last = |count: &[AtomicU32], tile: usize| count[tile].fetch_sub(1, Ordering::AcqRel) == 1;
    let release = |tile: usize, shared: &Shared<TileWindow>| {
        if last(&tiles.unsettled, tile) {
            // SAFETY: all tiles that read the window have settled.
            let window = unsafe { &mut shared.get(tile..tile + 1)[0] };
            if window.touched {
                tiles.give_room(std::mem::take(&mut window.sums));
            }
        }
    };
    let done = |taker: usize, shared: &Shared<TileWindow>| {
        timed(times, (taker, 1), || settle(taker, Windows(shared)));
        release(taker, shared);
        tiles.givers(taker).iter().filter(|giver| here(**giver)).for_each(|g| release(*g as usize, shared));
    };
    let shared = Shared::new(&mut *windows);
    par::for_rows(own.len(), |k| {
        let k = own.start + k;
        // SAFETY: each tile is swept once, and its window is read after that alone.
        let window = unsafe { &mut shared.get(k..k + 1)[0] };
        window.touched = timed(times, (k, 0), || sweep(k, window));
        for &taker in tiles.takers(k).iter().filter(|taker| here(**taker)) {
            // What was written before is seen by the thread that settles.
            let taker = taker as usize;
            if last(&tiles.unswept, taker) {
                done(taker, &shared);
            }
        }
    });
    let Some(HandOver { waits, exchange, .. }) = share else { return };
    exchange(windows);
    let shared = Shared::new(windows);
    let given = |tile: usize| tiles.takers(tile).iter().any(|taker| !here(*taker));
    own.clone().filter(|tile| given(*tile)).for_each(|tile| release(tile, &shared));
    par::for_rows(waits.len(), |k| {
        if last(&tiles.unswept, waits[k]) {
            done(waits[k], &shared);
        }
    });
}

/// Does a tile's work, and notes how long that took if it is the least time so far and times are kept.
fn timed<R>(times: &[[AtomicU64; 2]], (tile, which): (usize, usize), work: impl FnOnce() -> R) -> R {
    let Some(times) = times.get(tile) else { return work() };
    let start = Instant::now();
    let done = work();
    times[which].fetch_min(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    done
}

/// Windows of tiles, of which those that reach into a tile that settles have been swept.
#[derive(Clone, Copy)]
pub(crate) struct Windows<'a>(&'a Shared<'a, TileWindow>);

impl Windows<'_> {
    /// The window of a tile.
    ///
    /// # Safety
    /// The tile must have been swept in this pass.
    pub(crate) unsafe fn get(&self, tile: usize) -> &TileWindow {
        assert!(tile < self.0.len());
        // SAFETY: in bounds; nothing is written to the window of a tile that has been swept.
        unsafe { &*self.0.as_ptr().add(tile) }
    }
}
