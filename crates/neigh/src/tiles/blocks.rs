//! Blocks of cells, which are tiles: how large they are, in which order they follow each other, and where their cells lie.

use std::ops::Range;

/// Tiles, and slabs, hold this many points on average at least: what a list costs by itself is then little beside what its points cost (discs of
/// LAMMPS' `in.pour.2d` in lists of 48 were 15 % slower than in lists of 200).
pub(super) const CROWD: usize = 128;
/// And at most, where that many tiles come of it: what a tile's contacts read and write stays in the second cache.
const FULL: usize = 1024;
/// So many tiles there are, if they hold enough points then, that sixteen threads have as much to do as each other.
const WANTED: usize = 192;
/// And so many in small scenes where there are cells enough, that threads have something to share.
pub(super) const SHARES: usize = 8;
/// Fewer points are one tile: no second thread pays for them.
pub(super) const FEW: usize = 256;
/// How much wider than thick tiles are, the slow axis being across them: grains mostly pass each other in layers across that axis, and
/// lists of thin layers last longer.
const FLAT: usize = 2;

/// A grid of cells cut into blocks. The cells of a block have neighbouring numbers, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    /// Blocks along each axis.
    along: [usize; 3],
    repeats: [bool; 3],
    /// Along each axis: what the block that a cell lies in adds to its place, counted row by row, and the cell's place in that.
    part: [Vec<[u32; 2]>; 3],
    /// The number of the block at each place, and the place of each number.
    number: Vec<u32>,
    place: Vec<[usize; 3]>,
    /// The first cell of each block, and the number of all cells.
    first: Vec<usize>,
    /// By place: the first cell of each block, and how many cells its rows and its layers have.
    rows: Vec<[u32; 3]>,
}

impl Blocks {
    /// Blocks of so many cells along each axis, the last of which is the slow one and some of which repeat, for so many points.
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

    /// How many blocks.
    pub(super) fn count(&self) -> usize {
        self.place.len()
    }

    /// The cells of a block.
    pub(super) fn cells(&self, block: usize) -> Range<usize> {
        self.first[block]..self.first[block + 1]
    }

    /// The colour of a block: no two beside each other, also around the box, are of the same one.
    pub(super) fn colour(&self, block: usize) -> u8 {
        let [x, y, z] = self.place[block].map(|at| (at % 2) as u8);
        (z * 2 + y) * 2 + x
    }

    /// The blocks beside one, across faces, edges and corners, also around the box.
    pub(super) fn beside(&self, block: usize) -> Vec<u32> {
        let mut beside = vec![];
        let step = |k: usize, by: usize| match self.place[block][k] + by {
            // One more than where it leads.
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

    /// Where the cells of a block lie, in the order of their numbers.
    pub(super) fn places(&self, block: usize) -> impl Iterator<Item = [usize; 3]> + use<> {
        let cells = self.part.each_ref().map(Vec::len);
        let [xs, ys, zs] = [0, 1, 2].map(|k| ends(cells[k], self.along[k], self.place[block][k]));
        zs.flat_map(move |z| {
            let xs = xs.clone();
            ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
        })
    }

    /// The number of the cell that lies there.
    #[inline]
    pub(super) fn cell(&self, at: [usize; 3]) -> usize {
        let [[bx, x], [by, y], [bz, z]] = [0, 1, 2].map(|k| self.part[k][at[k]]);
        let [first, row, layer] = self.rows[(bx + by + bz) as usize];
        (first + z * layer + y * row + x) as usize
    }
}

/// Into how many blocks the cells along each axis are cut, for so many points.
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
        // Around the box there is an even number of blocks, and each has two cells at least: blocks of one colour then reach no common
        // one.
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

/// The cells along an axis that a block has.
#[inline]
fn ends(cells: usize, blocks: usize, block: usize) -> Range<usize> {
    block * cells / blocks..(block + 1) * cells / blocks
}

/// The place of the `n`-th block, row by row.
fn spread([x, y, _]: [usize; 3], n: usize) -> [usize; 3] {
    [n % x, n / x % y, n / x / y]
}

/// How far along Hilbert's curve through a cube of blocks the one at `at` lies: blocks near each other along the curve are near each
/// other in space. By J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707 (2004) 381.
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
