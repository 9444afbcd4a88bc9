//! Walks over the cells of a tile and over those around it.

use super::{HERE, Run, Tiles};
use std::ops::Range;

/// The half neighbourhood of a cell beyond itself, as offsets along the fast axis in rows at offsets along the other two: every pair of
/// neighbouring cells, each in each of its images, occurs from one side only.
const HALF: [(Range<i32>, i32, i32); 5] =
    [(1..2, 0, 0), (-1..2, 1, 0), (-1..2, -1, 1), (-1..2, 0, 1), (-1..2, 1, 1)];

/// A row of cells along the fast axis, as long as a tile and one cell more at both ends.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    /// Numbers of the cell before those beside the tile, of the first one of these, and of the one behind them; where they are, the
    /// image they are seen in.
    cells: [Option<(usize, u32)>; 3],
}

/// A walk over the cells of a tile with points in them.
pub struct Walk<'a> {
    tiles: &'a Tiles,
    /// Cells of the tile along each axis.
    extent: [Range<usize>; 3],
    /// The next cell.
    at: [usize; 3],
    /// The number of the first cell of its row, and the rows of its half neighbourhood.
    first: usize,
    rows: [Row; 5],
    runs: Vec<Run>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(tiles: &'a Tiles, tile: usize) -> Self {
        let extent = tiles.blocks.extent(tile);
        let at = extent.each_ref().map(|cells| cells.start);
        let mut walk = Self { tiles, extent, at, first: 0, rows: Default::default(), runs: vec![] };
        walk.enter_row();
        walk
    }

    /// Finds the rows around the one that begins.
    fn enter_row(&mut self) {
        let [_, y, z] = self.at.map(|c| c as i32);
        self.first = self.tiles.blocks.cell(self.at);
        let xs = &self.extent[0];
        self.rows = HALF.map(|(_, dy, dz)| self.tiles.row(xs, y + dy, z + dz));
    }

    /// The places of the next cell's points, and the runs of its half neighbourhood.
    #[inline]
    pub fn next_cell(&mut self) -> Option<(Range<usize>, &[Run])> {
        let [xs, ys, zs] = &self.extent;
        let (xs, ys, zs) = (xs.clone(), ys.clone(), zs.clone());
        loop {
            if self.at[0] == xs.end {
                self.at[0] = xs.start;
                self.at[1] += 1;
                if self.at[1] == ys.end {
                    self.at[1] = ys.start;
                    self.at[2] += 1;
                }
                if self.at[2] == zs.end {
                    // Nothing is left.
                    self.at = [xs.end, ys.end - 1, zs.end - 1];
                    return None;
                }
                self.enter_row();
            }
            let x = self.at[0];
            self.at[0] += 1;
            let own = self.tiles.places(self.first + x - xs.start);
            if own.is_empty() {
                continue;
            }
            self.runs.clear();
            for ((dx, ..), row) in HALF.iter().zip(&self.rows) {
                let (from, to) = (x as i32 + dx.start, x as i32 + dx.end);
                self.tiles.runs(row, &xs, from..to, &mut self.runs);
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
            return Row::default();
        };
        let cells = [xs.start as i32 - 1, xs.start as i32, xs.end as i32].map(|x| {
            let (x, sx) = self.wrapped(0, x)?;
            let mut shift = [0; 3];
            (shift[self.axes[0]], shift[self.axes[1]], shift[self.axes[2]]) = (sx, sy, sz);
            let image = (HERE as i32 + shift[0] + 3 * shift[1] + 9 * shift[2]) as u32;
            Some((self.blocks.cell([x, y, z]), image))
        });
        Row { cells }
    }

    /// Adds the points of the cells of a row from one place along the fast axis to another, run by run.
    #[inline]
    fn runs(&self, row: &Row, xs: &Range<usize>, along: Range<i32>, out: &mut Vec<Run>) {
        let [before, beside, behind] = row.cells;
        let (start, end) = (xs.start as i32, xs.end as i32);
        let mut push = |(cell, image): (usize, u32), count: usize| {
            let (from, to) = (self.start[cell], self.start[cell + count]);
            if from < to {
                out.push(Run { from, to, image });
            }
        };
        if let Some(before) = before.filter(|_| along.start < start) {
            push(before, 1);
        }
        let (from, to) = (along.start.max(start), along.end.min(end));
        if let Some((first, image)) = beside.filter(|_| from < to) {
            push((first + (from - start) as usize, image), (to - from) as usize);
        }
        if let Some(behind) = behind.filter(|_| along.end > end) {
            push(behind, 1);
        }
    }
}
