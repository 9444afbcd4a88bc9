//! Symmetric matrices of 6 × 6 blocks, by rows: what rigid clusters resist.

use super::clusters::{Clusters, NONE, carried, handed};
use super::{Parts, Ties};
use crate::pairs::Lists;
use crate::precond::{Blocks, Factor};
use crate::six::{Matrix6, Packed, Six, full, packed};
use perigrain_base::math::vec3::{Vec3, add, scale, sub};
use perigrain_base::par;

/// A matrix.
pub struct Matrix {
    /// Where the blocks of each row begin.
    first: Vec<u32>,
    /// Columns of the blocks beside the diagonal.
    column: Vec<u32>,
    /// From the node of the row to that of the column [length].
    vector: Vec<Vec3>,
    /// Blocks beside the diagonal, by columns.
    beside: Vec<Matrix6>,
    diagonal: Vec<Packed>,
    factors: Vec<Factor>,
}

/// A row in the making; blocks by columns.
#[derive(Clone, Default)]
struct Row {
    diagonal: Matrix6,
    column: Vec<u32>,
    beside: Vec<(Vec3, Matrix6)>,
}

impl Row {
    /// The block of a column, which is seen at `vector` from here.
    fn block(&mut self, column: u32, vector: Vec3) -> &mut Matrix6 {
        let at = self.column.iter().position(|c| *c == column).unwrap_or(self.column.len());
        if at == self.column.len() {
            self.column.push(column);
            self.beside.push((vector, Default::default()));
        }
        &mut self.beside[at].1
    }
}

impl Matrix {
    fn new(rows: usize, make: impl Fn(usize, &mut Row) + Sync) -> Self {
        let mut made = vec![Row::default(); rows];
        par::each(&mut made[..], |start, rows: &mut [Row]| {
            rows.iter_mut().enumerate().for_each(|(k, row)| make(start + k, row));
        });
        let blocks = made.iter().map(|row| row.beside.len()).sum();
        let (column, vector, beside) =
            (Vec::with_capacity(blocks), Vec::with_capacity(blocks), Vec::with_capacity(blocks));
        let mut out = Self { first: vec![0], column, vector, beside, diagonal: vec![], factors: vec![] };
        for row in made {
            out.column.extend(row.column);
            for (vector, block) in row.beside {
                out.vector.push(vector);
                out.beside.push(block);
            }
            out.first.push(out.column.len() as u32);
            let diagonal = packed(&row.diagonal);
            out.factors.push(Factor::new(&diagonal, 0));
            out.diagonal.push(diagonal);
        }
        out
    }

    /// How many rows of blocks.
    pub fn rows(&self) -> usize {
        self.diagonal.len()
    }

    fn row(&self, k: usize) -> std::ops::Range<usize> {
        self.first[k] as usize..self.first[k + 1] as usize
    }

    /// All blocks by columns, with their places, those on the diagonal as well.
    pub fn blocks(&self) -> impl Iterator<Item = ([usize; 2], Matrix6)> {
        (0..self.rows()).flat_map(move |k| {
            let beside = self.row(k).map(move |e| ([k, self.column[e] as usize], self.beside[e]));
            std::iter::once(([k, k], full(&self.diagonal[k]))).chain(beside)
        })
    }

    /// A row of A x.
    #[inline(always)]
    pub fn times(&self, k: usize, x: &[Six]) -> Six {
        let mut out = [0.0; 6];
        add_times(&mut out, &full(&self.diagonal[k]), &x[k]);
        self.row(k).for_each(|e| add_times(&mut out, &self.beside[e], &x[self.column[e] as usize]));
        out
    }

    /// D⁻¹ r of a row, D the blocks on the diagonal.
    #[inline(always)]
    pub fn over(&self, k: usize, r: &Six) -> Six {
        self.factors[k].solve(r)
    }

    /// Clusters of what it resists.
    pub fn clusters(&self) -> Clusters {
        let neighbours = |k: usize, take: &mut dyn FnMut(usize, Vec3)| {
            self.row(k).for_each(|e| take(self.column[e] as usize, self.vector[e]));
        };
        Clusters::new(self.rows(), |_| false, neighbours)
    }

    /// PᵀA P for the rigid motions of clusters.
    pub fn of_clusters(&self, clusters: &Clusters) -> Self {
        Self::new(clusters.count(), |own, row| {
            for i in clusters.members(own) {
                let x = clusters.offset[i];
                put(&mut row.diagonal, &full(&self.diagonal[i]), [x, x]);
                for e in self.row(i) {
                    let j = self.column[e] as usize;
                    let (cluster, y) = (clusters.of[j], clusters.offset[j]);
                    if cluster as usize == own {
                        put(&mut row.diagonal, &self.beside[e], [x, y]);
                    } else {
                        let vector = sub(add(x, self.vector[e]), y);
                        put(row.block(cluster, vector), &self.beside[e], [x, y]);
                    }
                }
            }
        })
    }
}

/// M x for a matrix by its columns: six numbers at a time.
#[inline(always)]
fn add_times(sum: &mut Six, columns: &Matrix6, x: &Six) {
    for (column, x) in columns.iter().zip(x) {
        (0..6).for_each(|row| sum[row] += column[row] * x);
    }
}

fn unit(column: usize) -> Six {
    std::array::from_fn(|c| f64::from(u8::from(c == column)))
}

/// sum += TᵀM T' for nodes at x and y within their clusters.
fn put(sum: &mut Matrix6, m: &Matrix6, [x, y]: [Vec3; 2]) {
    for column in 0..6 {
        let mut f = [0.0; 6];
        add_times(&mut f, m, &carried(y, &unit(column)));
        sum[column].iter_mut().zip(handed(x, &f)).for_each(|(sum, f)| *sum += f);
    }
}

/// Clusters of particles and PᵀK P.
pub fn of_particles(parts: &Parts, blocks: &Blocks) -> (Clusters, Matrix) {
    let particles = blocks.len();
    let lists: Vec<Lists> = (parts.ties.iter())
        .map(|ties| {
            let bears = (0..ties.ends().len()).filter(|k| ties.bears(*k));
            Lists::new(particles, bears.flat_map(|k| ties.ends()[k].map(|end| (end, k as u32))))
        })
        .collect();
    let of = |i: usize| {
        let ties = parts.ties.iter().zip(&lists);
        ties.flat_map(move |(ties, list)| list.of(i).iter().map(move |k| Tie::new(*ties, *k as usize, i)))
    };
    let neighbours = |i: usize, take: &mut dyn FnMut(usize, Vec3)| {
        of(i).for_each(|tie| take(tie.other, tie.vector));
    };
    let clusters = Clusters::new(particles, |k| blocks.held(k) == 0b111111, neighbours);
    let grounds = Lists::new(
        particles,
        parts.grounds.iter().enumerate().map(|(k, (particle, ..))| (*particle, k as u32)),
    );
    let matrix = Matrix::new(clusters.count(), |own, row| {
        for i in clusters.members(own) {
            let x = clusters.offset[i];
            of(i).for_each(|tie| tie.add_to(row, own as u32, &clusters, blocks));
            for (_, component, k) in grounds.of(i).iter().map(|k| parts.grounds[*k as usize]) {
                let mut m = Matrix6::default();
                m[component][component] = if blocks.held(i) >> component & 1 == 0 { k } else { 0.0 };
                put(&mut row.diagonal, &m, [x, x]);
            }
        }
    });
    (clusters, matrix)
}

/// A tie, seen from one of its ends.
struct Tie<'a> {
    ties: &'a dyn Ties,
    k: usize,
    /// This end and the other one.
    own: usize,
    other: usize,
    /// Whether this one is the lower end.
    low: bool,
    /// To the other end [length].
    vector: Vec3,
}

impl<'a> Tie<'a> {
    fn new(ties: &'a dyn Ties, k: usize, own: usize) -> Self {
        let [a, b] = ties.ends()[k].map(|end| end as usize);
        let (low, d) = (a == own, ties.vector(k));
        let (other, vector) = if low { (b, d) } else { (a, scale(-1.0, d)) };
        Self { ties, k, own, other, low, vector }
    }

    /// The resisting forces of this end and of the other one.
    fn resist(&self, own: &Six, other: &Six) -> [Six; 2] {
        if self.low {
            return self.ties.resist(self.k, [own, other]);
        }
        let [other, own] = self.ties.resist(self.k, [other, own]);
        [own, other]
    }

    /// Adds what it resists when the cluster of this end moves to the row of that cluster: PᵀK P is symmetric, so that what comes out
    /// at the other end is the block beside the diagonal as well.
    fn add_to(&self, row: &mut Row, cluster: u32, clusters: &Clusters, blocks: &Blocks) {
        let ends = [self.own, self.other];
        let [x, y] = ends.map(|end| clusters.offset[end]);
        let (elsewhere, within) = (clusters.of[self.other], clusters.of[self.other] == cluster);
        let vector = sub(add(x, self.vector), y);
        if within && (!self.low || self.idle(vector, blocks)) {
            return;
        }
        let free = ends.map(|end| blocks.held(end) == 0);
        let masked = |end: usize, f: Six| if free[end] { f } else { blocks.free(ends[end], &f) };
        let mut beside = Matrix6::default();
        for column in 0..6 {
            let unit = unit(column);
            let moves = masked(0, carried(x, &unit));
            let other = if within { masked(1, carried(y, &unit)) } else { [0.0; 6] };
            let [f, g] = self.resist(&moves, &other);
            let (f, g) = (handed(x, &masked(0, f)), handed(y, &masked(1, g)));
            for c in 0..6 {
                row.diagonal[column][c] += if within { f[c] + g[c] } else { f[c] };
                beside[c][column] = g[c];
            }
        }
        if !within && elsewhere != NONE {
            let block = row.block(elsewhere, vector).iter_mut().flatten();
            block.zip(beside.iter().flatten()).for_each(|(sum, a)| *sum += a);
        }
    }

    /// Whether rigid motions of a cluster that holds both ends do nothing to it: nothing is held, and it leads to the other end where it
    /// is in this cluster, and not to an image of it.
    fn idle(&self, gap: Vec3, blocks: &Blocks) -> bool {
        let largest = |a: Vec3| a.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        let free = [self.own, self.other].iter().all(|end| blocks.held(*end) == 0);
        free && largest(gap) <= 1e-9 * largest(self.vector)
    }
}
