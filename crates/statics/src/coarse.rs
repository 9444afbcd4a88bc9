//! Coarse levels for conjugate gradients: clusters of particles that move as rigid bodies, and clusters of
//! clusters.
//!
//! With block Jacobi alone, long-range deformation spreads from neighbour to neighbour: bending struts, walls
//! between pores and weakly connected pieces take hundreds of steps. Here z = M⁻¹ r + P B Pᵀ r, where the
//! columns of P are the rigid motions of clusters, and B is one cycle with the matrix PᵀK P, built
//! recursively in the same way until a few dozen clusters are left. Only bonds are needed: positions of
//! particles within a cluster follow from them, so that the box may be periodic.
//!
//! V. E. Bulgakov, G. Kuhn, Int. J. Numer. Meth. Eng. 38, 3529 (1995): rigid motions of aggregates; D.
//! Braess, Computing 55, 379 (1995): scaled-up corrections.

mod bottom;
mod clusters;
mod matrix;

use super::network::Network;
use super::pairs::Ties;
use super::precond::Blocks;
use super::six::Six;
use bottom::Bottom;
use clusters::{Clusters, NONE, carried};
use matrix::Matrix;
use perigrain_base::math::vec3::length;
use perigrain_base::par;

/// How clusters are formed.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Rings of neighbours around the first node of a cluster.
    pub rings: usize,
    /// Connections between particles count as neighbours up to so many times the length of the shortest one.
    pub reach: f64,
    /// Number of clusters from which on a dense matrix is used.
    pub few: usize,
}

impl Sizes {
    /// For bonds and contacts that join next neighbours. With one ring there are three times as many clusters and a fifth fewer steps, and
    /// about the same total time including the setup; two rings need less memory, which matters for 8·10⁶ bonds. 64 clusters are
    /// 384 unknowns, a millisecond.
    pub const NEXT: Self = Self { rings: 2, reach: f64::INFINITY, few: 64 };
    /// For families, whose bonds reach over several neighbours: clusters of 27 points on a cubic lattice. Steps to 1e-6 for pmb, horizon 3.015,
    /// against those of [`Self::NEXT`]: a beam of 60 × 6 × 6 points 24 for 64, a block of 24 × 12 × 12 points 21 for 47, a plate with a crack
    /// of 100 × 60 points 21 for 43, of 45 × 24 × 2 with 2.015 34 for 58.
    pub const FAMILIES: Self = Self { rings: 1, reach: 1.75, few: 130 };
}

/// The parts of a stiffness matrix.
pub struct Parts<'a> {
    /// Connections between particles.
    pub ties: &'a [&'a dyn Ties],
    /// Springs to the ground, by component: particle, component, stiffness.
    pub grounds: &'a [(u32, usize, f64)],
}

impl Parts<'_> {
    /// The length of a connection, the first of all [length].
    fn arm(&self) -> f64 {
        let first = self.ties.iter().find(|ties| !ties.ends().is_empty());
        first.map_or(1.0, |ties| length(ties.vector(0)))
    }
}

/// A level: its clusters, and the matrix of their rigid motions.
struct Level {
    clusters: Clusters,
    matrix: Matrix,
}

/// All levels.
pub struct Coarse {
    levels: Vec<Level>,
    bottom: Option<Bottom>,
}

/// A level with more than this fraction of the previous level's clusters is not used.
const GAIN: f64 = 0.8;
/// Damping of block Jacobi. The matrix of pairwise springs is at most twice its diagonal blocks, so that 1 −
/// 0.8 λ is between −0.6 and 1.
const DAMPED: f64 = 0.8;
/// Smoothing steps before and after each coarser level.
const STEPS: usize = 2;
/// Rigid clusters are too stiff for smooth bending, at worst by the number of particles across, so
/// corrections are scaled up. Between levels by no more than this, because motions that clusters do represent
/// are then overshot: two cycles correct 1 − (1 − 1.5)² = 0.75 of them.
const LARGER: f64 = 1.5;
/// Between the first level and the particles, overshooting is harmless.
const LARGER_AT_LAST: f64 = 2.0;

impl Coarse {
    /// For a matrix; `blocks` define the held components.
    pub fn new(parts: &Parts, blocks: &Blocks, sizes: Sizes) -> Self {
        let (clusters, matrix) = matrix::of_particles(parts, blocks, sizes);
        let mut particles = clusters.sums(|_| 1.0);
        let mut levels = vec![Level { clusters, matrix }];
        loop {
            let above = &levels[levels.len() - 1].matrix;
            if above.rows() <= sizes.few {
                break;
            }
            let clusters = above.clusters(sizes.rings);
            if clusters.count() as f64 > GAIN * above.rows() as f64 {
                break;
            }
            let matrix = above.of_clusters(&clusters);
            particles = clusters.sums(|k| particles[k]);
            levels.push(Level { clusters, matrix });
        }
        let last = &levels[levels.len() - 1].matrix;
        let bottom = (last.rows() <= 2 * sizes.few).then(|| Bottom::new(last, &particles, parts.arm()));
        Self { levels, bottom }
    }

    /// For the bonds of a network alone.
    pub fn of_network(network: &Network, blocks: &Blocks) -> Self {
        Self::new(&Parts { ties: &[network], grounds: &[] }, blocks, Sizes::NEXT)
    }

    /// The same for the bonds of families.
    pub fn of_families(network: &Network, blocks: &Blocks) -> Self {
        Self::new(&Parts { ties: &[network], grounds: &[] }, blocks, Sizes::FAMILIES)
    }

    /// z += P B Pᵀ r: displacements [length] and rotations [rad] from forces [force] and torques [force
    /// length].
    pub fn add_to(&self, z: &mut [Six], r: &[Six], blocks: &Blocks) {
        let clusters = &self.levels[0].clusters;
        let pushed = clusters.gather(|k| blocks.free(k, &r[k]));
        let moved = self.cycle(0, &pushed);
        par::each(&mut *z, |start, rows: &mut [Six]| {
            for (k, row) in (start..).zip(rows) {
                let cluster = clusters.of[k];
                if cluster != NONE {
                    let u = blocks.free(k, &carried(clusters.offset(k), &moved[cluster as usize]));
                    add_to(row, LARGER_AT_LAST, &u);
                }
            }
        });
    }

    /// B r at a level: block Jacobi steps, the correction by the next level, and the same steps again.
    /// Symmetric and positive, by the choice of [`DAMPED`] and [`LARGER`].
    fn cycle(&self, level: usize, r: &[Six]) -> Vec<Six> {
        let a = &self.levels[level].matrix;
        let Some(next) = self.levels.get(level + 1) else {
            return self.bottom.as_ref().map_or_else(|| smoothed(a, r), |bottom| bottom.solve(r));
        };
        let mut x = smoothed(a, r);
        let clusters = &next.clusters;
        let rest = clusters.gather(|k| minus(&r[k], &a.times(k, &x)));
        let mut moved = self.cycle(level + 1, &rest);
        // If the next level is not the last one, it is cycled twice.
        if level + 2 < self.levels.len() {
            let rest: Vec<Six> = rows(rest.len(), |k| minus(&rest[k], &next.matrix.times(k, &moved)));
            let more = self.cycle(level + 1, &rest);
            moved.iter_mut().zip(&more).for_each(|(a, b)| add_to(a, 1.0, b));
        }
        for (k, row) in x.iter_mut().enumerate() {
            add_to(row, LARGER, &carried(clusters.offset(k), &moved[clusters.of[k] as usize]));
        }
        (0..STEPS).for_each(|_| x = step(a, r, &x));
        x
    }
}

/// Block Jacobi steps from zero.
fn smoothed(a: &Matrix, r: &[Six]) -> Vec<Six> {
    let first = rows(r.len(), |k| a.over(k, &r[k]).map(|z| DAMPED * z));
    (1..STEPS).fold(first, |x, _| step(a, r, &x))
}

/// x + ω D⁻¹ (r − A x).
fn step(a: &Matrix, r: &[Six], x: &[Six]) -> Vec<Six> {
    rows(r.len(), |k| {
        let mut row = x[k];
        add_to(&mut row, DAMPED, &a.over(k, &minus(&r[k], &a.times(k, x))));
        row
    })
}

fn rows(n: usize, of: impl Fn(usize) -> Six + Sync) -> Vec<Six> {
    let mut out = vec![[0.0; 6]; n];
    par::each(&mut out[..], |start, rows: &mut [Six]| {
        rows.iter_mut().enumerate().for_each(|(k, row)| *row = of(start + k));
    });
    out
}

#[inline(always)]
fn minus(a: &Six, b: &Six) -> Six {
    std::array::from_fn(|c| a[c] - b[c])
}

#[inline(always)]
fn add_to(a: &mut Six, times: f64, b: &Six) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += times * b);
}
