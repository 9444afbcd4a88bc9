//! Points in cells: a counting sort, and a search for points near a position.

/// Points sorted into the cells of their own bounding box; the caller handles periodic images.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    lo: [f64; 3],
    hi: [f64; 3],
    per_length: [f64; 3],
    cells: [usize; 3],
    start: Vec<u32>,
    points: Vec<u32>,
}

impl Grid {
    /// Sorts `members` of `x` into cells of edge `cell`, or longer ones if there would be many more cells
    /// than points. Points of one cell keep the order of `members`.
    pub fn fill(&mut self, x: &[[f64; 3]], members: &[u32], cell: f64) {
        (self.lo, self.hi) = extent(x, members.iter().copied());
        let room = 64 + 2 * members.len();
        let mut edge = cell.max(f64::MIN_POSITIVE);
        loop {
            let along = |d: usize| ((self.hi[d] - self.lo[d]) / edge).floor() + 1.0;
            let all = along(0) * along(1) * along(2);
            if members.is_empty() || all <= room as f64 {
                self.cells = std::array::from_fn(|d| along(d).max(1.0) as usize);
                break;
            }
            edge *= (all / room as f64).cbrt().clamp(1.26, 1e100);
        }
        self.per_length = [1.0 / edge; 3];

        let count = self.cells.iter().product::<usize>();
        self.start.clear();
        self.start.resize(count + 1, 0);
        for &m in members {
            let c = self.cell_of(&x[m as usize]);
            self.start[c + 1] += 1;
        }
        for c in 0..count {
            self.start[c + 1] += self.start[c];
        }
        self.points.clear();
        self.points.resize(members.len(), 0);
        let mut next = self.start.clone();
        for &m in members {
            let c = self.cell_of(&x[m as usize]);
            self.points[next[c] as usize] = m;
            next[c] += 1;
        }
    }

    /// Whether the box from `lo` to `hi` overlaps the points' bounding box.
    pub fn meets(&self, lo: &[f64; 3], hi: &[f64; 3]) -> bool {
        !self.points.is_empty() && (0..3).all(|d| lo[d] <= self.hi[d] && hi[d] >= self.lo[d])
    }

    /// Calls `f` with runs of points: those in all cells that overlap the box from `lo` to `hi`, in a fixed
    /// order.
    pub fn near(&self, lo: &[f64; 3], hi: &[f64; 3], mut f: impl FnMut(&[u32])) {
        if !self.meets(lo, hi) {
            return;
        }
        let (a, b) = (self.place(lo), self.place(hi));
        for z in a[2]..=b[2] {
            for y in a[1]..=b[1] {
                let row = (z * self.cells[1] + y) * self.cells[0];
                let (from, to) = (self.start[row + a[0]], self.start[row + b[0] + 1]);
                if from < to {
                    f(&self.points[from as usize..to as usize]);
                }
            }
        }
    }

    fn place(&self, x: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|d| {
            // A negative float becomes 0 in the cast.
            (((x[d] - self.lo[d]) * self.per_length[d]) as usize).min(self.cells[d] - 1)
        })
    }

    fn cell_of(&self, x: &[f64; 3]) -> usize {
        let [a, b, c] = self.place(x);
        (c * self.cells[1] + b) * self.cells[0] + a
    }
}

/// Corners of the bounding box of some points.
pub fn extent(x: &[[f64; 3]], members: impl Iterator<Item = u32>) -> ([f64; 3], [f64; 3]) {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for m in members {
        let p = &x[m as usize];
        for d in 0..3 {
            // Same results as `min` and `max`, which check for NaN twice.
            lo[d] = if p[d] < lo[d] { p[d] } else { lo[d] };
            hi[d] = if p[d] > hi[d] { p[d] } else { hi[d] };
        }
    }
    (lo, hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_found_and_far_ones_do_not_cost_memory() {
        let x = [[0.0; 3], [1.0, 2.0, 3.0], [1e9, 0.0, 0.0], [1.0, 2.0, 3.5]];
        let mut g = Grid::default();
        g.fill(&x, &[0, 1, 2, 3], 1.0);
        assert!(g.start.len() < 100);
        let mut found = vec![];
        g.near(&[0.5, 1.5, 2.5], &[1.5, 2.5, 3.6], |run| found.extend_from_slice(run));
        assert!(found.contains(&1) && found.contains(&3));
        g.near(&[-9.0, 0.0, 0.0], &[-1.0, 9.0, 9.0], |_| panic!("nothing is there"));
        g.fill(&x, &[], 1.0);
        g.near(&[-9.0; 3], &[9.0; 3], |_| panic!("nothing is there"));
        g.fill(&x, &[2], 1.0);
        g.near(&[9e8, -1.0, -1.0], &[2e9, 1.0, 1.0], |run| assert_eq!(run, [2]));
    }
}
