//! Points within reach of a tile's pairs: its own and those of surrounding cells, in consecutive order, with
//! the neighbours of each cell.

use super::{HERE, Tiles};
use std::ops::Range;

/// No cell.
const NONE: u32 = u32::MAX;

/// A row of cells along the fast axis: as long as a tile, plus one cell at each end.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Numbers of the cell before those beside the tile, of the first of these, and of the one after them; or
    /// [`NONE`].
    cells: [u32; 3],
    /// Their images.
    images: [u32; 3],
}

impl Row {
    const NOWHERE: Self = Self { cells: [NONE; 3], images: [HERE; 3] };
}

/// The cells within reach of a tile's pairs, including its own: rows with one extra cell at each end, layers
/// with one extra row at each end, and one extra layer. Their points are counted in the order of
/// [`Tiles::around`].
#[derive(Clone, Debug, Default)]
pub struct Around {
    /// Number of cells of the tile along the fast, middle and slow axis.
    size: [usize; 3],
    /// The first point of each cell, and the total number of points.
    start: Vec<u32>,
}

/// The points of a cell of a tile and of its half neighbourhood: every pair of points in neighbouring cells,
/// in each of its images, belongs to exactly one cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Neighbourhood {
    /// Points of the cell.
    pub own: Range<usize>,
    /// The same followed by those of the next cell; then those of three cells each, in the next row and in
    /// three rows of the next layer.
    pub rows: [Range<usize>; 5],
}

impl Around {
    /// The neighbourhoods of cells that contain points, row by row.
    #[inline]
    pub fn neighbourhoods(&self) -> Neighbourhoods<'_> {
        Neighbourhoods { of: self, row: 0, cells: 0..0 }
    }
}

/// An iterator over the cells of a tile that contain points.
pub struct Neighbourhoods<'a> {
    of: &'a Around,
    /// The next row of the tile.
    row: usize,
    /// Remaining cells of the row before it.
    cells: Range<usize>,
}

impl Iterator for Neighbourhoods<'_> {
    type Item = Neighbourhood;

    #[inline]
    fn next(&mut self) -> Option<Neighbourhood> {
        let [nx, ny, nz] = self.of.size;
        let (row, layer) = (nx + 2, (nx + 2) * (ny + 2));
        let start = &self.of.start[..];
        loop {
            if self.cells.is_empty() {
                if self.row == ny * nz {
                    return None;
                }
                let first = self.row / ny * layer + (self.row % ny + 1) * row + 1;
                (self.row, self.cells) = (self.row + 1, first..first + nx);
            }
            let cell = self.cells.start;
            self.cells.start += 1;
            let own = start[cell] as usize..start[cell + 1] as usize;
            if !own.is_empty() {
                let of = |from: usize, to: usize| start[from] as usize..start[to] as usize;
                let three = |cell: usize| of(cell - 1, cell + 2);
                let [next, above] = [cell + row, cell + layer];
                let rows =
                    [of(cell, cell + 2), three(next), three(above - row), three(above), three(above + row)];
                return Some(Neighbourhood { own, rows });
            }
        }
    }
}

impl Tiles {
    /// Finds the cells within reach of a tile's pairs, including its own; calls `f(layer, image, places)` for
    /// their points, layer by layer: layer numbers continue through images along the slow axis.
    pub fn around(&self, tile: usize, mut f: impl FnMut(usize, u32, Range<usize>)) -> Around {
        let [xs, ys, zs] = self.blocks.extent(tile);
        let size = [xs.len(), ys.len(), zs.len()];
        let mut start = Vec::with_capacity((size[0] + 2) * (size[1] + 2) * (size[2] + 1) + 1);
        let mut count = 0;
        let mut take = |z: usize, row: &Row, k: usize, cells: usize| {
            let first = row.cells[k] as usize;
            if row.cells[k] == NONE {
                return start.resize(start.len() + cells, count);
            }
            let (from, to) = (self.start[first], self.start[first + cells]);
            if cells == 1 {
                start.push(count);
            } else {
                start.extend(self.start[first..first + cells].iter().map(|place| place - from + count));
            }
            if from < to {
                f(z, row.images[k], from as usize..to as usize);
                count += to - from;
            }
        };
        for z in zs.start..zs.end + 1 {
            for y in ys.start as i32 - 1..ys.end as i32 + 1 {
                // Pairs never reach backwards within a layer.
                let before = z == zs.start && y < ys.start as i32;
                let row = if before { Row::NOWHERE } else { self.row(&xs, y, z as i32) };
                take(z, &row, 0, 1);
                take(z, &row, 1, xs.len());
                take(z, &row, 2, 1);
            }
        }
        start.push(count);
        Around { size, start }
    }

    /// Wraps a cell coordinate that may be one beyond the outermost cells; returns the number of periods as
    /// well.
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

    /// The cells of a row along the fast axis, at these coordinates along the other two.
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
}
