//! A grid of cells for finding all pairs closer than a distance, each once, in a fixed order.

use crate::families::Bounds;
use perigrain_base::par::{self, Shared};
use std::ops::Range;

/// Points sorted into cells; in periodic directions cells tile the box exactly.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    lo: [f64; 3],
    edge: [f64; 3],
    count: [usize; 3],
    wraps: [bool; 3],
    start: Vec<u32>,
    member: Vec<u32>,
    /// Places of the members.
    place: Vec<[f64; 3]>,
    cell: Vec<u32>,
}

impl Cells {
    /// Sorts the points `which` of `x` into cells no smaller than `reach`, of the upright box if it leans; memory of an earlier use is kept.
    pub fn fill(
        &mut self,
        x: &[[f64; 3]],
        which: impl Iterator<Item = u32> + Clone,
        bounds: &Bounds,
        reach: f64,
    ) {
        let (mut lo, mut hi, mut n) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0usize);
        let (at, wider) = (|i: u32| bounds.upright(x[i as usize]), bounds.wider());
        for i in which.clone() {
            n += 1;
            let at = at(i);
            for k in 0..3 {
                lo[k] = lo[k].min(at[k]);
                hi[k] = hi[k].max(at[k]);
            }
        }
        // Few large cells are as right as many small ones: no more than two cells per point and direction.
        let most = ((2 * n) as f64).max(1.0);
        for k in 0..3 {
            if bounds.periodic[k] {
                (lo[k], hi[k]) = (bounds.lo[k], bounds.hi[k]);
            }
            let length = if n > 0 { hi[k] - lo[k] } else { 0.0 };
            self.count[k] = (length / (reach * wider[k])).floor().clamp(1.0, most.min(1024.0)) as usize;
            self.wraps[k] = bounds.periodic[k];
            self.lo[k] = lo[k];
            self.edge[k] = if length > 0.0 { length / self.count[k] as f64 } else { 1.0 };
        }
        while self.count.iter().product::<usize>() > 4 * n + 64 {
            let k = (0..3).max_by_key(|&k| self.count[k]).unwrap_or(0);
            let length = self.edge[k] * self.count[k] as f64;
            self.count[k] = self.count[k].div_ceil(2);
            self.edge[k] = length / self.count[k] as f64;
        }
        let cells = self.count.iter().product::<usize>();
        self.start.clear();
        self.start.resize(cells + 1, 0);
        self.cell.clear();
        for i in which.clone() {
            let c = self.at(&at(i));
            self.cell.push(self.index(c) as u32);
        }
        for &c in &self.cell {
            self.start[c as usize + 1] += 1;
        }
        for c in 0..cells {
            self.start[c + 1] += self.start[c];
        }
        self.member.clear();
        self.member.resize(n, 0);
        self.place.clear();
        self.place.resize(n, [0.0; 3]);
        let mut next = self.start.clone();
        for (i, &c) in which.zip(&self.cell) {
            let at = next[c as usize] as usize;
            (self.member[at], self.place[at]) = (i, x[i as usize]);
            next[c as usize] += 1;
        }
    }

    fn at(&self, x: &[f64; 3]) -> [usize; 3] {
        [0, 1, 2].map(|k| {
            let c = (x[k] - self.lo[k]) / self.edge[k];
            if self.wraps[k] {
                return (c.floor() as i64).rem_euclid(self.count[k] as i64) as usize;
            }
            (c.max(0.0) as usize).min(self.count[k] - 1)
        })
    }

    fn index(&self, c: [usize; 3]) -> usize {
        c[0] + self.count[0] * (c[1] + self.count[1] * c[2])
    }

    /// What `keep` makes of the pairs of points no farther apart than `range`, which is no longer than the reach; each pair once, by
    /// rows of cells that threads share. Of pairs of points in different rows the earlier row has them.
    pub fn gather<T: Send>(
        &self,
        bounds: &Bounds,
        (range, rows): (f64, Range<usize>),
        keep: impl Fn(u32, u32, f64) -> Option<T> + Sync,
    ) -> Vec<T> {
        let mut found: Vec<Vec<T>> = std::iter::repeat_with(Vec::new).take(rows.len()).collect();
        let of_row = Shared::new(&mut found);
        par::for_rows_if(self.member.len() > par::CHUNK, rows.len(), |k| {
            // SAFETY: each row is worked on once.
            let found = unsafe { &mut of_row.get(k..k + 1)[0] };
            self.touching(rows.start + k, |own, run| {
                self.pairs(bounds, range, (own, run), |i, j, square, _| found.extend(keep(i, j, square)));
            });
        });
        found.into_iter().flatten().collect()
    }

    /// How many rows of cells there are.
    pub fn rows(&self) -> usize {
        self.count[1] * self.count[2]
    }

    /// The rows of cells of one of so many parts, which follow each other and have about as many members each.
    pub fn part(&self, part: usize, parts: usize) -> Range<usize> {
        let before: Vec<usize> =
            (0..self.rows()).map(|row| self.start[row * self.count[0]] as usize).collect();
        let first = |part: usize| match part < parts {
            true => before.partition_point(|before| before * parts < part * self.member.len()),
            false => before.len(),
        };
        first(part)..first(part + 1)
    }

    /// How many cells there are along each axis; they are numbered along the first one first.
    pub fn counts(&self) -> [usize; 3] {
        self.count
    }

    /// The members of a cell.
    pub fn members(&self, cell: usize) -> &[u32] {
        &self.member[self.start[cell] as usize..self.start[cell + 1] as usize]
    }

    /// Calls `f(cell, others)` for the cells of a row that have members and the runs of cells that touch them and come no earlier:
    /// all pairs of the same or touching cells, each once; a run that starts with the cell has itself in it.
    pub fn touching(&self, row: usize, mut f: impl FnMut(usize, Range<usize>)) {
        let (y, z) = (row % self.count[1], row / self.count[1]);
        for x in 0..self.count[0] {
            let own = self.index([x, y, z]);
            if self.start[own] == self.start[own + 1] {
                continue;
            }
            if self.wraps != [false; 3] {
                let (around, n) = self.around([x, y, z]);
                around[..n].iter().for_each(|&other| f(own, other..other + 1));
                continue;
            }
            touching(self.count, [x, y, z], |run| f(own, run));
        }
    }

    /// Calls `f(i, j, |x_i − x_j|², whether the shortest image crosses a periodic face)` for every pair of points no farther apart
    /// than `range`, which is no longer than the reach, each pair once.
    pub fn within(&self, bounds: &Bounds, range: f64, mut f: impl FnMut(u32, u32, f64, bool)) {
        for row in 0..self.rows() {
            // Cell by cell: the order is part of what is promised.
            self.touching(row, |own, run| {
                run.for_each(|other| self.pairs(bounds, range, (own, other..other + 1), &mut f));
            });
        }
    }

    /// The same for the pairs of a cell's members with those of a run of cells, which starts with the cell or does not have it.
    fn pairs(
        &self,
        bounds: &Bounds,
        range: f64,
        (own, run): (usize, Range<usize>),
        mut f: impl FnMut(u32, u32, f64, bool),
    ) {
        let (most, images) = (range * range, bounds.periodic != [false; 3]);
        let others = self.start[run.start] as usize..self.start[run.end] as usize;
        for a in self.start[own] as usize..self.start[own + 1] as usize {
            let x = self.place[a];
            let rest = if run.start == own { a + 1..others.end } else { others.clone() };
            for (y, &j) in self.place[rest.clone()].iter().zip(&self.member[rest]) {
                let plain = [x[0] - y[0], x[1] - y[1], x[2] - y[2]];
                // Kept apart: the way through an array costs more than all the rest.
                let (square, wraps) = match images {
                    false => (plain[0] * plain[0] + plain[1] * plain[1] + plain[2] * plain[2], false),
                    true => shortest(bounds, plain),
                };
                if square <= most {
                    f(self.member[a], j, square, wraps);
                }
            }
        }
    }

    /// The cells touching `c` that come no earlier than it, itself included, without repetition.
    fn around(&self, c: [usize; 3]) -> ([usize; 27], usize) {
        let own = self.index(c);
        let (mut cells, mut n) = ([0; 27], 0);
        for d in 0..27 {
            let offset = [d % 3, (d / 3) % 3, d / 9];
            let mut at = [0; 3];
            let mut inside = true;
            for k in 0..3 {
                let p = (c[k] + offset[k]) as i64 - 1;
                let m = self.count[k] as i64;
                inside &= self.wraps[k] || (0..m).contains(&p);
                at[k] = p.rem_euclid(m) as usize;
            }
            let other = self.index(at);
            if inside && other >= own && !cells[..n].contains(&other) {
                cells[n] = other;
                n += 1;
            }
        }
        (cells, n)
    }
}

/// Calls `f` for the runs of cells that touch a cell and come no earlier, of so many along each axis, the first of them with itself.
pub fn touching([nx, ny, nz]: [usize; 3], [x, y, z]: [usize; 3], mut f: impl FnMut(Range<usize>)) {
    let row = |y: usize, z: usize| nx * (y + ny * z);
    let (before, after) = (x.saturating_sub(1), (x + 2).min(nx));
    f(row(y, z) + x..row(y, z) + after);
    let above = (y.saturating_sub(1)..(y + 2).min(ny)).map(|y| (y, z + 1));
    for (y, z) in [(y + 1, z)].into_iter().chain(above).filter(|(y, z)| *y < ny && *z < nz) {
        f(row(y, z) + before..row(y, z) + after);
    }
}

/// The squared length of the shortest image of a vector, and whether it is not the plain one.
#[inline(never)]
fn shortest(bounds: &Bounds, plain: [f64; 3]) -> (f64, bool) {
    let d = bounds.nearest(plain);
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2], d != plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_every_close_pair_once() {
        // Points by a multiplicative generator: any scatter will do.
        let mut seed = 12345u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let x: Vec<[f64; 3]> = (0..400).map(|_| [4.0 * next(), 3.0 * next(), 5.0 * next()]).collect();
        for periodic in [[false; 3], [true; 3], [true, false, true]] {
            let bounds = Bounds { lo: [0.0; 3], hi: [4.0, 3.0, 5.0], periodic, tilt: [0.0; 3] };
            let mut cells = Cells::default();
            cells.fill(&x, 0..400, &bounds, 0.9);
            let mut found = Vec::new();
            cells.within(&bounds, 0.9, |i, j, square, wraps| found.push((i.min(j), i.max(j), square, wraps)));
            found.sort_unstable_by_key(|(i, j, ..)| (*i, *j));
            let gather =
                |rows| cells.gather(&bounds, (0.9, rows), |i, j, square| Some((i.min(j), i.max(j), square)));
            let mut gathered = gather(0..cells.rows());
            for parts in [1, 2, 3, 7, 50] {
                let of_parts: Vec<_> = (0..parts).flat_map(|part| gather(cells.part(part, parts))).collect();
                assert_eq!(of_parts, gathered, "{parts} parts");
            }
            gathered.sort_unstable_by_key(|(i, j, _)| (*i, *j));
            assert_eq!(gathered, found.iter().map(|&(i, j, square, _)| (i, j, square)).collect::<Vec<_>>());
            let mut expected = vec![];
            for i in 0..400u32 {
                for j in i + 1..400 {
                    let (a, b) = (x[i as usize], x[j as usize]);
                    let plain = [0, 1, 2].map(|k| a[k] - b[k]);
                    let d = bounds.nearest(plain);
                    let square = d.iter().map(|d| d * d).sum::<f64>();
                    if square <= 0.9 * 0.9 {
                        expected.push((i, j, square, d != plain));
                    }
                }
            }
            assert_eq!(found, expected);
        }
    }
}
