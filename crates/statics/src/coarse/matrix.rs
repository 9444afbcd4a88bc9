//! Symmetric matrices of 6 × 6 blocks, by rows: resistance between rigid clusters.

use super::clusters::{Clusters, NONE, carried, handed};
use super::{Parts, Sizes};
use crate::ends::WHOLE;
use crate::pairs::{Lists, Ties};
use crate::precond::{Blocks, Factor};
use crate::six::{Matrix6, Six, full, packed, unit};
use perigrain_base::math::vec3::{Vec3, add, length, scale, sub};
use perigrain_base::par;

/// A matrix.
pub struct Matrix(Vec<Row>);

/// A row of blocks, each by columns.
#[derive(Clone, Default)]
struct Row {
    diagonal: Matrix6,
    factor: Factor,
    beside: Vec<Block>,
}

/// An off-diagonal block.
#[derive(Clone)]
struct Block {
    column: u32,
    /// Vector from the node of the row to that of the column [length].
    vector: Vec3,
    numbers: Matrix6,
}

impl Row {
    /// The block of a column, at `vector` from this node.
    fn block(&mut self, column: u32, vector: Vec3) -> &mut Matrix6 {
        let at = self.beside.iter().position(|b| b.column == column).unwrap_or(self.beside.len());
        if at == self.beside.len() {
            self.beside.push(Block { column, vector, numbers: Default::default() });
        }
        &mut self.beside[at].numbers
    }
}

impl Matrix {
    fn new(rows: usize, make: impl Fn(usize, &mut Row) + Sync) -> Self {
        let mut out = vec![Row::default(); rows];
        par::each(&mut out[..], |start, rows: &mut [Row]| {
            for (k, row) in (start..).zip(rows) {
                make(k, row);
                // Symmetric to the bit, like its factors.
                let diagonal = packed(&row.diagonal);
                (row.diagonal, row.factor) = (full(&diagonal), Factor::new(&diagonal, 0));
            }
        });
        Self(out)
    }

    /// The number of block rows.
    pub fn rows(&self) -> usize {
        self.0.len()
    }

    /// All blocks by columns, with their row and column numbers, including the diagonal.
    pub fn blocks(&self) -> impl Iterator<Item = ([usize; 2], &Matrix6)> {
        self.0.iter().enumerate().flat_map(|(k, row)| {
            let beside = row.beside.iter().map(move |b| ([k, b.column as usize], &b.numbers));
            std::iter::once(([k, k], &row.diagonal)).chain(beside)
        })
    }

    /// A row of A x.
    #[inline(always)]
    pub fn times(&self, k: usize, x: &[Six]) -> Six {
        let (mut out, row) = ([0.0; 6], &self.0[k]);
        add_times(&mut out, &row.diagonal, &x[k]);
        row.beside.iter().for_each(|b| add_times(&mut out, &b.numbers, &x[b.column as usize]));
        out
    }

    /// D⁻¹ r for a row; D is the block diagonal.
    #[inline(always)]
    pub fn over(&self, k: usize, r: &Six) -> Six {
        self.0[k].factor.solve(r)
    }

    /// Clusters of its nodes.
    pub fn clusters(&self, rings: usize) -> Clusters {
        let neighbours = |k: usize, take: &mut dyn FnMut(usize, Vec3)| {
            self.0[k].beside.iter().for_each(|b| take(b.column as usize, b.vector));
        };
        Clusters::new(self.rows(), rings, |_| false, neighbours)
    }

    /// PᵀA P for the rigid motions of clusters.
    pub fn of_clusters(&self, clusters: &Clusters) -> Self {
        Self::new(clusters.count(), |own, row| {
            for i in clusters.members(own) {
                let (above, x) = (&self.0[i], clusters.offset(i));
                put(&mut row.diagonal, &above.diagonal, [x, x]);
                for Block { column, vector, numbers } in &above.beside {
                    let j = *column as usize;
                    let (cluster, y) = (clusters.of[j], clusters.offset(j));
                    if cluster as usize == own {
                        put(&mut row.diagonal, numbers, [x, y]);
                    } else {
                        put(row.block(cluster, sub(add(x, *vector), y)), numbers, [x, y]);
                    }
                }
            }
        })
    }
}

/// M x for a matrix stored by columns: six numbers at a time.
#[inline(always)]
fn add_times(sum: &mut Six, columns: &Matrix6, x: &Six) {
    for (column, x) in columns.iter().zip(x) {
        (0..6).for_each(|row| sum[row] += column[row] * x);
    }
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
pub fn of_particles(parts: &Parts, blocks: &Blocks, sizes: Sizes) -> (Clusters, Matrix) {
    let particles = blocks.len();
    let of_ends: Vec<Ends> = parts.ties.iter().map(|ties| Ends::new(*ties, particles)).collect();
    let shortest = |ties: &dyn Ties| {
        (0..ties.ends().len()).map(|k| length(ties.vector(k))).fold(f64::INFINITY, f64::min)
    };
    let reach = match sizes.reach.is_finite() {
        true => sizes.reach * parts.ties.iter().map(|ties| shortest(*ties)).fold(f64::INFINITY, f64::min),
        false => f64::INFINITY,
    };
    let of = |i: usize| of_ends.iter().flat_map(move |ends| ends.of(i));
    let neighbours = |i: usize, take: &mut dyn FnMut(usize, Vec3)| {
        of(i).filter(|tie| length(tie.vector) <= reach).for_each(|tie| take(tie.other, tie.vector));
    };
    let clusters = Clusters::new(particles, sizes.rings, |k| blocks.held(k) == WHOLE, neighbours);
    let grounds = Lists::new(
        particles,
        parts.grounds.iter().enumerate().map(|(k, (particle, ..))| (*particle, k as u32)),
    );
    let matrix = Matrix::new(clusters.count(), |own, row| {
        for i in clusters.members(own) {
            let x = clusters.offset(i);
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

/// The connections of each particle.
struct Ends<'a> {
    ties: &'a dyn Ties,
    /// Index of the first one with this particle as lower end; they are in this order.
    first: Vec<u32>,
    /// Those with this particle as upper end.
    upper: Lists,
}

impl<'a> Ends<'a> {
    fn new(ties: &'a dyn Ties, particles: usize) -> Self {
        let ends = ties.ends();
        let mut first = vec![0; particles + 1];
        ends.iter().for_each(|ends| first[ends[0] as usize + 1] += 1);
        (0..particles).for_each(|k| first[k + 1] += first[k]);
        let upper = Lists::new(particles, ends.iter().enumerate().map(|(k, ends)| (ends[1], k as u32)));
        Self { ties, first, upper }
    }

    /// The connections of a particle that have any resistance.
    fn of(&self, i: usize) -> impl Iterator<Item = Tie<'a>> {
        let ties = self.ties;
        let lower = self.first[i]..self.first[i + 1];
        let all = lower.chain(self.upper.of(i).iter().copied()).map(|k| k as usize);
        all.filter(move |k| ties.bears(*k)).map(move |k| Tie::new(ties, k, i))
    }
}

/// A connection, seen from one of its ends.
struct Tie<'a> {
    ties: &'a dyn Ties,
    k: usize,
    /// This end and the other one.
    own: usize,
    other: usize,
    /// Whether this end is the lower one.
    low: bool,
    /// Vector to the other end [length].
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

    /// Adds its resistance to a motion of this end's cluster to the row of that cluster: PᵀK P is symmetric,
    /// so the result at the other end is also the off-diagonal block.
    fn add_to(&self, row: &mut Row, cluster: u32, clusters: &Clusters, blocks: &Blocks) {
        let ends = [self.own, self.other];
        let [x, y] = ends.map(|end| clusters.offset(end));
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

    /// Whether it is unaffected by rigid motions of a cluster that contains both ends: no component is held,
    /// and it leads to the other end itself, not to an image of it.
    fn idle(&self, gap: Vec3, blocks: &Blocks) -> bool {
        let largest = |a: Vec3| a.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        let free = [self.own, self.other].iter().all(|end| blocks.held(*end) == 0);
        // Offsets have single precision.
        free && largest(gap) <= 1e-5 * largest(self.vector)
    }
}
