//! Walks over the cells of a tile and over those around it.

use super::{HERE, Run, Tiles};
use std::ops::Range;

/// The half neighbourhood of a cell beyond itself, as offsets along the fast axis in rows at offsets along the other two: every pair of
/// neighbouring cells, each in each of its images, occurs from one side only.
const HALF: [(Range<i32>, i32, i32); 5] =
    [(1..2, 0, 0), (-1..2, 1, 0), (-1..2, -1, 1), (-1..2, 0, 1), (-1..2, 1, 1)];

/// No cell.
const NONE: u32 = u32::MAX;

/// A row of cells along the fast axis, as long as a tile and one cell more at both ends.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Numbers of the cell before those beside the tile, of the first one of these, and of the one behind them; or [`NONE`].
    cells: [u32; 3],
    /// The images they are seen in.
    images: [u32; 3],
}

impl Row {
    const NOWHERE: Self = Self { cells: [NONE; 3], images: [HERE; 3] };
}

/// A walk over the cells of a tile with points in them.
pub struct Walk<'a> {
    tiles: &'a Tiles,
    /// Cells of the tile along each axis.
    extent: [Range<usize>; 3],
    /// The next cell, and its number.
    at: [usize; 3],
    cell: usize,
    /// The rows of the half neighbourhood, if they have been found for its row.
    rows: [Row; 5],
    found: bool,
    runs: Vec<Run>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(tiles: &'a Tiles, tile: usize) -> Self {
        let extent = tiles.blocks.extent(tile);
        let at = extent.each_ref().map(|cells| cells.start);
        let cell = tiles.blocks.cells(tile).start;
        Self { tiles, extent, at, cell, rows: [Row::NOWHERE; 5], found: false, runs: vec![] }
    }

    /// The places of the next cell's points, and the runs of its half neighbourhood.
    #[inline]
    pub fn next_cell(&mut self) -> Option<(Range<usize>, &[Run])> {
        let [xs, ys, zs] = self.extent.clone();
        loop {
            if self.at[0] == xs.end {
                self.found = false;
                self.at[0] = xs.start;
                self.at[1] += 1;
                if self.at[1] == ys.end {
                    self.at[1] = ys.start;
                    self.at[2] += 1;
                }
            }
            if self.at[2] == zs.end {
                return None;
            }
            let [x, y, z] = self.at.map(|c| c as i32);
            let own = self.tiles.places(self.cell);
            self.at[0] += 1;
            self.cell += 1;
            if own.is_empty() {
                continue;
            }
            if !std::mem::replace(&mut self.found, true) {
                self.rows = HALF.map(|(_, dy, dz)| self.tiles.row(&xs, y + dy, z + dz));
            }
            self.runs.clear();
            for ((dx, ..), row) in HALF.iter().zip(&self.rows) {
                self.tiles.runs(row, &xs, x + dx.start..x + dx.end, &mut self.runs);
            }
            return Some((own, &self.runs));
        }
    }
}

impl Tiles {
    /// A walk over the cells of a tile.
    pub fn walk(&self, tile: usize) -> Walk<'_> {
        Walk::new(self, tile)
    }

    /// Calls `f(layer, image, places)` for cells that pairs of a tile reach, and its own, layer by layer: layers are counted on through
    /// images along the slow axis.
    pub fn reached(&self, tile: usize, mut f: impl FnMut(usize, u32, Range<usize>)) {
        let [xs, ys, zs] = self.blocks.extent(tile);
        if self.count() == 1 && self.repeats == [false; 3] {
            // Nothing is around it, and layers follow each other.
            let cells = xs.len() * ys.len();
            let layer = |z: usize| self.places(z * cells).start..self.places((z + 1) * cells - 1).end;
            return zs
                .map(|z| (z, layer(z)))
                .filter(|(_, all)| !all.is_empty())
                .for_each(|(z, all)| f(z, HERE, all));
        }
        let mut runs = vec![];
        for z in zs.start as i32..zs.end as i32 + 1 {
            for y in ys.start as i32 - i32::from(z > zs.start as i32)..ys.end as i32 + 1 {
                runs.clear();
                let row = self.row(&xs, y, z);
                self.runs(&row, &xs, xs.start as i32 - 1..xs.end as i32 + 1, &mut runs);
                runs.iter().for_each(|run| f(z as usize, run.image, run.from as usize..run.to as usize));
            }
        }
    }

    /// A coordinate of a cell that may be one beyond the outermost ones, and how many periods away it is seen.
    #[inline]
    fn wrapped(&self, k: usize, at: i32) -> Option<(usize, i32)> {
        let n = self.cells[k] as i32;
        match at {
            _ if at >= 0 && at < n => Some((at as usize, 0)),
            _ if !self.repeats[k] => None,
            _ if at < 0 => Some(((at + n) as usize, -1)),
            _ => Some(((at - n) as usize, 1)),
        }
    }

    /// The cells beside those along the fast axis, in a row of the other two.
    fn row(&self, xs: &Range<usize>, y: i32, z: i32) -> Row {
        let (Some((y, sy)), Some((z, sz))) = (self.wrapped(1, y), self.wrapped(2, z)) else {
            return Row::NOWHERE;
        };
        let mut row = Row::NOWHERE;
        for (k, x) in [xs.start as i32 - 1, xs.start as i32, xs.end as i32].into_iter().enumerate() {
            let Some((x, sx)) = self.wrapped(0, x) else { continue };
            row.cells[k] = self.blocks.cell([x, y, z]) as u32;
            if [sx, sy, sz] != [0; 3] {
                let mut shift = [0; 3];
                (shift[self.axes[0]], shift[self.axes[1]], shift[self.axes[2]]) = (sx, sy, sz);
                row.images[k] = (HERE as i32 + shift[0] + 3 * shift[1] + 9 * shift[2]) as u32;
            }
        }
        row
    }

    /// Adds the points of the cells of a row from one place along the fast axis to another, run by run.
    #[inline]
    fn runs(&self, row: &Row, xs: &Range<usize>, along: Range<i32>, out: &mut Vec<Run>) {
        let (start, end) = (xs.start as i32, xs.end as i32);
        let mut push = |k: usize, from: i32, to: i32| {
            let first = row.cells[k];
            if first != NONE {
                let [from, to] = [from, to].map(|cell| self.start[first as usize + cell as usize]);
                if from < to {
                    out.push(Run { from, to, image: row.images[k] });
                }
            }
        };
        if along.start < start {
            push(0, 0, 1);
        }
        if along.start.max(start) < along.end.min(end) {
            push(1, along.start.max(start) - start, along.end.min(end) - start);
        }
        if along.end > end {
            push(2, 0, 1);
        }
    }
}
