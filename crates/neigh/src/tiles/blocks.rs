//! Blocks of cells, used as tiles: their size, their order, and the positions of their cells.

use std::ops::Range;

/// Tiles and slabs hold at least this many points on average: the cost per list is then small compared with
/// that per point (discs of LAMMPS' `in.pour.2d` were 15 % slower in lists of 48 than in lists of 200).
/// LAMMPS' `in.pour.2d` in lists of 48 were 15 % slower than in lists of 200).
pub(super) const CROWD: usize = 128;
/// And at most this many, if that gives enough tiles: the data of a tile's contacts then fits the
/// second-level cache.
const FULL: usize = 1024;
/// Number of tiles, given enough points, at which sixteen threads are well balanced.
const WANTED: usize = 192;
/// Number of tiles in small systems with enough cells, so that threads have work to share.
pub(super) const SHARES: usize = 8;
/// Below this number of points there is one tile: a second thread does not pay off.
pub(super) const FEW: usize = 256;
/// Width of tiles relative to their thickness along the slow axis: grains mostly pass each other in layers
/// normal to that axis, and lists of thin layers stay valid longer.
const FLAT: usize = 2;

/// A grid of cells cut into blocks. The cells of a block have consecutive numbers, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    /// Number of blocks along each axis.
    along: [usize; 3],
    repeats: [bool; 3],
    /// Per axis and cell: the contribution of its block to the block index (counted row by row), and the
    /// position within the block.
    part: [Vec<[u32; 2]>; 3],
    /// The number of the block at each index, and the index of each number.
    number: Vec<u32>,
    place: Vec<[usize; 3]>,
    /// The first cell of each block, and the total number of cells.
    first: Vec<usize>,
    /// Per block index: the first cell, and the number of cells in its rows and layers.
    rows: Vec<[u32; 3]>,
}

impl Blocks {
    /// Blocks for this many cells along each axis, of which the last is the slow one and some are periodic,
    /// and this many points.
    pub(super) fn new(cells: [usize; 3], repeats: [bool; 3], points: usize) -> Self {
        let along = cut(cells, repeats, points);
        let step = [1, along[0], along[0] * along[1]];
        let part = [0, 1, 2].map(|k| {
            let of = |block: usize| ends(cells[k], along[k], block);
            (0..along[k])
                .flat_map(|b| (0..of(b).len()).map(move |c| [(b * step[k]) as u32, c as u32]))
                .collect()
        });
        let mut place: Vec<[usize; 3]> = (0..along.iter().product()).map(|n| spread(along, n)).collect();
        place.sort_by_cached_key(|at| along_curve(*at, along));
        let mut number = vec![0; place.len()];
        place.iter().zip(0..).for_each(|([x, y, z], n)| number[(z * along[1] + y) * along[0] + x] = n);
        let rows = vec![[0; 3]; place.len()];
        let mut blocks = Self { along, repeats, part, number, place, first: vec![0], rows };
        for n in 0..blocks.place.len() {
            let [nx, ny, nz] = blocks.extent(n).map(|cells| cells.len());
            let [x, y, z] = blocks.place[n];
            let first = blocks.first[n];
            blocks.rows[(z * along[1] + y) * along[0] + x] = [first, nx, nx * ny].map(|n| n as u32);
            blocks.first.push(first + nx * ny * nz);
        }
        blocks
    }

    /// The number of blocks.
    pub(super) fn count(&self) -> usize {
        self.place.len()
    }

    /// The cells of a block.
    pub(super) fn cells(&self, block: usize) -> Range<usize> {
        self.first[block]..self.first[block + 1]
    }

    /// The colour of a block: neighbouring blocks, including periodic ones, never have the same colour.
    pub(super) fn colour(&self, block: usize) -> u8 {
        let [x, y, z] = self.place[block].map(|at| (at % 2) as u8);
        (z * 2 + y) * 2 + x
    }

    /// The neighbours of a block across faces, edges and corners, including periodic ones.
    pub(super) fn beside(&self, block: usize) -> Vec<u32> {
        let mut beside = vec![];
        let step = |k: usize, by: usize| match self.place[block][k] + by {
            // One more than the index it leads to.
            0 if self.repeats[k] => Some(self.along[k] - 1),
            0 => None,
            at if at <= self.along[k] => Some(at - 1),
            _ => self.repeats[k].then_some(0),
        };
        for (dx, dy, dz) in (0..27).map(|n| (n % 3, n / 3 % 3, n / 9)) {
            let (Some(x), Some(y), Some(z)) = (step(0, dx), step(1, dy), step(2, dz)) else { continue };
            beside.push(self.number[(z * self.along[1] + y) * self.along[0] + x]);
        }
        beside.sort_unstable();
        beside.dedup();
        beside.retain(|other| *other as usize != block);
        beside
    }

    /// The cells of a block along each axis.
    pub(super) fn extent(&self, block: usize) -> [Range<usize>; 3] {
        [0, 1, 2].map(|k| ends(self.part[k].len(), self.along[k], self.place[block][k]))
    }

    /// The positions of a block's cells, in the order of their numbers.
    pub(super) fn places(&self, block: usize) -> impl Iterator<Item = [usize; 3]> + use<> {
        let cells = self.part.each_ref().map(Vec::len);
        let [xs, ys, zs] = [0, 1, 2].map(|k| ends(cells[k], self.along[k], self.place[block][k]));
        zs.flat_map(move |z| {
            let xs = xs.clone();
            ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
        })
    }

    /// The number of the cell at a position.
    #[inline]
    pub(super) fn cell(&self, at: [usize; 3]) -> usize {
        let [[bx, x], [by, y], [bz, z]] = [0, 1, 2].map(|k| self.part[k][at[k]]);
        let [first, row, layer] = self.rows[(bx + by + bz) as usize];
        (first + z * layer + y * row + x) as usize
    }
}

/// The number of blocks along each axis, for this many points.
fn cut(cells: [usize; 3], repeats: [bool; 3], points: usize) -> [usize; 3] {
    let mut cut = [1; 3];
    if points < FEW {
        return cut;
    }
    loop {
        // The longest edge is cut once more.
        let weight = [1, 1, FLAT];
        let longer = |a: &usize, b: &usize| {
            (weight[*a] * cells[*a] * cut[*b]).cmp(&(weight[*b] * cells[*b] * cut[*a])).then(a.cmp(b))
        };
        // Along periodic directions there is an even number of blocks with at least two cells each: blocks of
        // one colour then have no common neighbour within reach.
        let next = |k: usize| cut[k] + if repeats[k] && cut[k] > 1 { 2 } else { 1 };
        let Some(k) = (0..3).filter(|&k| 2 * next(k) <= cells[k]).max_by(longer) else { break };
        let next: [usize; 3] = std::array::from_fn(|d| if d == k { next(k) } else { cut[d] });
        let count: usize = next.iter().product();
        if count > SHARES.max(points / CROWD) {
            break;
        }
        cut = next;
        if count >= WANTED && points / count <= FULL {
            break;
        }
    }
    cut
}

/// The cells of a block along an axis.
#[inline]
fn ends(cells: usize, blocks: usize, block: usize) -> Range<usize> {
    block * cells / blocks..(block + 1) * cells / blocks
}

/// The position of the `n`-th block, row by row.
fn spread([x, y, _]: [usize; 3], n: usize) -> [usize; 3] {
    [n % x, n / x % y, n / x / y]
}

/// The distance of the block at `at` along Hilbert's curve through a cube of blocks: blocks close to each
/// other along the curve are close in space. After J. Skilling, Programming the Hilbert curve, AIP Conf.
/// Proc. 707 (2004) 381.
fn along_curve(at: [usize; 3], along: [usize; 3]) -> u64 {
    let bits = along.iter().max().map_or(1, |n| n.next_power_of_two().ilog2().max(1));
    // The slow axis leads.
    let mut x = [at[2], at[1], at[0]].map(|c| c as u64);
    for bit in (1..bits).rev() {
        let (q, p) = (1 << bit, (1 << bit) - 1);
        for k in 0..3 {
            if x[k] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[k]) & p;
                x[0] ^= t;
                x[k] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let turned = (1..bits).rev().filter(|bit| x[2] >> bit & 1 == 1).fold(0, |t, bit| t ^ ((1 << bit) - 1));
    x.iter_mut().for_each(|x| *x ^= turned);
    (0..bits).rev().fold(0, |key, bit| x.iter().fold(key, |key, x| key << 1 | (x >> bit & 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_neighbour_to_neighbour() {
        for n in [2, 4, 8] {
            let mut all: Vec<[usize; 3]> = (0..n * n * n).map(|k| spread([n; 3], k)).collect();
            all.sort_by_key(|at| along_curve(*at, [n; 3]));
            let apart = |a: &[usize; 3], b: &[usize; 3]| (0..3).map(|k| a[k].abs_diff(b[k])).sum::<usize>();
            assert!(all.windows(2).all(|w| apart(&w[0], &w[1]) == 1), "{n}");
        }
    }

    #[test]
    fn each_cell_is_in_one_block() {
        for (cells, points) in
            [([27, 27, 28], 32_000), ([1, 40, 90], 5000), ([5, 1, 3], 900), ([9, 4, 1], 20)]
        {
            let blocks = Blocks::new(cells, [true, false, true], points);
            let mut met = vec![false; cells.iter().product()];
            for block in 0..blocks.count() {
                for (at, cell) in blocks.places(block).zip(blocks.cells(block)) {
                    assert_eq!(blocks.cell(at), cell);
                    assert!(!std::mem::replace(&mut met[cell], true));
                }
            }
            assert!(met.iter().all(|met| *met));
        }
    }

    #[test]
    fn blocks_beside_each_other_differ_in_colour() {
        for (repeats, cells) in
            [([true; 3], [23, 9, 30]), ([false; 3], [20, 21, 22]), ([true, false, true], [4, 1, 40])]
        {
            let blocks = Blocks::new(cells, repeats, 20_000);
            assert!(blocks.count() > 8);
            for block in 0..blocks.count() {
                let beside = blocks.beside(block);
                assert!(beside.iter().all(|other| blocks.colour(*other as usize) != blocks.colour(block)));
                assert!(beside.iter().all(|other| blocks.beside(*other as usize).contains(&(block as u32))));
            }
        }
    }

    #[test]
    fn many_points_have_tiles_for_many_threads_and_few_have_few() {
        let count = |cells, points| cut(cells, [true, true, false], points).iter().product::<usize>();
        assert!((WANTED..3 * WANTED).contains(&count([27, 27, 27], 32_000)));
        assert_eq!(count([5, 5, 5], 200), 1);
        assert!((SHARES / 2..=SHARES).contains(&count([9, 9, 9], 1000)));
        let large = count([97, 97, 97], 1_450_000);
        assert!(1_450_000 / large <= FULL && 1_450_000 / large >= CROWD);
        assert!(count([1, 173, 173], 48_000) >= WANTED);
    }
}
