//! What positions are counted in: 65 536 cells in each direction over all that is there, with room for more.

/// Cells of equal width in each direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where the count is 0.
    pub origin: [f64; 3],
    /// The width of a cell.
    pub cell: [f64; 3],
}

/// The largest count.
const MOST: f64 = 65_535.0;
/// Room beyond what is there, as a part of it, on either side.
const ROOM: f64 = 0.25;
/// A grid so many times as wide as what is there is too coarse.
const WIDE: f64 = 4.0;

impl Grid {
    /// A grid over what the particles take: the one before if it serves.
    pub fn over([lo, hi]: [[f64; 3]; 2], before: Option<Grid>) -> Self {
        let widest = (0..3).map(|d| hi[d] - lo[d]).fold(0.0, f64::max);
        let widest = if widest > 0.0 { widest } else { 1.0 };
        let side = |d: usize| (hi[d] - lo[d]).max(1e-3 * widest);
        let serves = |g: &Grid| {
            (0..3).all(|d| {
                let end = g.origin[d] + g.cell[d] * MOST;
                lo[d] >= g.origin[d] && hi[d] <= end && end - g.origin[d] <= WIDE * side(d)
            })
        };
        if let Some(grid) = before.filter(serves) {
            return grid;
        }
        let mut grid = Grid { origin: lo, cell: [0.0; 3] };
        for d in 0..3 {
            grid.origin[d] = 0.5 * (lo[d] + hi[d]) - (0.5 + ROOM) * side(d);
            grid.cell[d] = (1.0 + 2.0 * ROOM) * side(d) / MOST;
        }
        grid
    }

    /// A position as a count.
    pub fn count(&self, d: usize, x: f64) -> u16 {
        // A conversion of floats saturates, and makes 0 of what is no number.
        ((x - self.origin[d]) / self.cell[d] + 0.5) as u16
    }

    /// A count as a position.
    pub fn place(&self, d: usize, count: u16) -> f64 {
        self.origin[d] + self.cell[d] * f64::from(count)
    }
}
