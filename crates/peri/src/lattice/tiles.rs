//! Cutting a body on a lattice into tiles.

use std::ops::Range;

use crate::families::lattice::{LatticeBody, PAGE};
use crate::families::tiles::{Reached, Tile, TileGraph, TileWindow, Tiles};

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
        tiles.all.push(Tile { planes, rows, reached });
    }
    tiles.graph = graph_of(&tiles, body);
    tiles.windows.resize_with(tiles.all.len(), TileWindow::default);
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

/// Which tiles reach into which.
fn graph_of(tiles: &Tiles, body: &LatticeBody) -> TileGraph {
    let reaches = |giver: usize, taker: &Tile| {
        let own = tiles.all[giver].planes.start;
        let mut window = (own..).zip(tiles.reached(giver));
        window.any(|(plane, at)| {
            let rows = at.rows[0].max(taker.rows.start)..at.rows[1].min(taker.rows.end);
            let slots = body.slot(plane, rows.start)..body.slot(plane, rows.end);
            taker.planes.contains(&plane) && slots.into_iter().any(|slot| body.rows[slot].len > 0)
        })
    };
    let giving = |(taker, tile): (usize, &Tile)| {
        let others = (0..tiles.all.len()).filter(|giver| *giver != taker && reaches(*giver, tile));
        others.map(|giver| giver as u32).collect()
    };
    let givers: Vec<Vec<u32>> = tiles.all.iter().enumerate().map(giving).collect();
    TileGraph::of(&givers)
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
