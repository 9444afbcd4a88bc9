//! A grid of cells for finding all pairs closer than a distance, each once, in a fixed order.

use super::Bounds;

/// Points sorted into cells; in periodic directions cells tile the box exactly.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    lo: [f64; 3],
    edge: [f64; 3],
    count: [usize; 3],
    wraps: [bool; 3],
    start: Vec<u32>,
    member: Vec<u32>,
    cell: Vec<u32>,
}

impl Cells {
    /// Sorts the points `which` of `x` into cells no smaller than `reach`; memory of an earlier use is kept.
    pub fn fill(
        &mut self,
        x: &[[f64; 3]],
        which: impl Iterator<Item = u32> + Clone,
        bounds: &Bounds,
        reach: f64,
    ) {
        let (mut lo, mut hi, mut n) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0usize);
        for i in which.clone() {
            n += 1;
            for k in 0..3 {
                lo[k] = lo[k].min(x[i as usize][k]);
                hi[k] = hi[k].max(x[i as usize][k]);
            }
        }
        // Few large cells are as right as many small ones: no more than two cells per point and direction.
        let most = ((2 * n) as f64).max(1.0);
        for k in 0..3 {
            if bounds.periodic[k] {
                (lo[k], hi[k]) = (bounds.lo[k], bounds.hi[k]);
            }
            let length = if n > 0 { hi[k] - lo[k] } else { 0.0 };
            self.count[k] = (length / reach).floor().clamp(1.0, most.min(1024.0)) as usize;
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
            let c = self.at(&x[i as usize]);
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
        // Filling from the back leaves members of a cell in order and `start` at the cells' first members.
        let ends = &mut self.start;
        let mut place = ends.clone();
        for (i, &c) in which.zip(&self.cell) {
            self.member[place[c as usize] as usize] = i;
            place[c as usize] += 1;
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

    fn of(&self, cell: usize) -> &[u32] {
        &self.member[self.start[cell] as usize..self.start[cell + 1] as usize]
    }

    /// Calls `f` for every pair of points in the same or touching cells, each pair once: a superset of all
    /// pairs closer than the reach.
    pub fn pairs(&self, mut f: impl FnMut(u32, u32)) {
        for z in 0..self.count[2] {
            for y in 0..self.count[1] {
                for x in 0..self.count[0] {
                    let own = self.index([x, y, z]);
                    if self.of(own).is_empty() {
                        continue;
                    }
                    let (around, n) = self.around([x, y, z]);
                    for &other in &around[..n] {
                        self.between(own, other, &mut f);
                    }
                }
            }
        }
    }

    fn between(&self, own: usize, other: usize, f: &mut impl FnMut(u32, u32)) {
        for (a, &i) in self.of(own).iter().enumerate() {
            let rest = if own == other { &self.of(own)[a + 1..] } else { self.of(other) };
            rest.iter().for_each(|&j| f(i, j));
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
            let bounds = Bounds { lo: [0.0; 3], hi: [4.0, 3.0, 5.0], periodic };
            let mut cells = Cells::default();
            cells.fill(&x, 0..400, &bounds, 0.9);
            let mut found = Vec::new();
            cells.pairs(|i, j| found.push((i.min(j), i.max(j))));
            found.sort_unstable();
            let once = found.len();
            found.dedup();
            assert_eq!(once, found.len());
            for i in 0..400u32 {
                for j in i + 1..400 {
                    let (a, b) = (x[i as usize], x[j as usize]);
                    let d = bounds.nearest([0, 1, 2].map(|k| a[k] - b[k]));
                    if d.iter().map(|d| d * d).sum::<f64>() < 0.81 {
                        assert!(found.binary_search(&(i, j)).is_ok());
                    }
                }
            }
        }
    }
}
