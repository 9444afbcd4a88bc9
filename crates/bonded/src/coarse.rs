//! Coarse levels for conjugate gradients: clusters of particles move as rigid bodies, and clusters of clusters.
//!
//! Block Jacobi alone lets what is long-ranged creep from neighbour to neighbour: struts that bend, walls between pores, pieces that
//! hang by little take hundreds of steps. Here z = M⁻¹ r + P B Pᵀ r, where P has the rigid motions of clusters as columns and B is one
//! cycle over the matrix PᵀK P, made in the same way once more until a few dozen clusters are left. Nothing but bonds is asked for:
//! where particles are within a cluster follows from them, so that a box may repeat.
//!
//! V. E. Bulgakov, G. Kuhn, Int. J. Numer. Meth. Eng. 38, 3529 (1995), rigid motions of aggregates; D. Braess, Computing 55, 379
//! (1995), corrections taken larger than they come out.

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

/// All that makes up a stiffness matrix.
pub struct Parts<'a> {
    /// What ties particles together.
    pub ties: &'a [&'a dyn Ties],
    /// What ties particles to what stands still, by their components: particle, component, stiffness.
    pub grounds: &'a [(u32, usize, f64)],
}

impl Parts<'_> {
    /// How long a tie is, the first of all [length].
    fn arm(&self) -> f64 {
        let first = self.ties.iter().find(|ties| !ties.ends().is_empty());
        first.map_or(1.0, |ties| length(ties.vector(0)))
    }
}

/// A level: who forms which cluster, and the matrix of their rigid motions.
struct Level {
    clusters: Clusters,
    matrix: Matrix,
}

/// All levels.
pub struct Coarse {
    levels: Vec<Level>,
    bottom: Option<Bottom>,
}

/// So many clusters are few enough for a matrix without zeros: 384 unknowns, a thousandth of a second.
const FEW: usize = 64;
/// A level that has more than this part of the clusters of the last one is none.
const GAIN: f64 = 0.8;
/// A step of block Jacobi goes this far. A matrix of springs between pairs is at most twice its blocks, so that 1 − 0.8 λ is between −0.6
/// and 1.
const DAMPED: f64 = 0.8;
/// Steps before a level is left downwards and as many after.
const STEPS: usize = 2;
/// Rigid clusters are too stiff for what bends smoothly, at worst by the number of particles across: what comes out is taken larger.
/// Between levels no more than this, since what a cluster does represent is then overshot: two cycles take 1 − (1 − 1.5)² = 0.75 of it.
const LARGER: f64 = 1.5;
/// From the first level to the particles nothing can be overshot.
const LARGER_AT_LAST: f64 = 2.0;

impl Coarse {
    /// Of a matrix, whose `blocks` tell what is held.
    pub fn new(parts: &Parts, blocks: &Blocks) -> Self {
        let (clusters, matrix) = matrix::of_particles(parts, blocks);
        let mut particles = clusters.sums(|_| 1.0);
        let mut levels = vec![Level { clusters, matrix }];
        loop {
            let above = &levels[levels.len() - 1].matrix;
            if above.rows() <= FEW {
                break;
            }
            let clusters = above.clusters();
            if clusters.count() as f64 > GAIN * above.rows() as f64 {
                break;
            }
            let matrix = above.of_clusters(&clusters);
            particles = clusters.sums(|k| particles[k]);
            levels.push(Level { clusters, matrix });
        }
        let last = &levels[levels.len() - 1].matrix;
        let bottom = (last.rows() <= 2 * FEW).then(|| Bottom::new(last, &particles, parts.arm()));
        Self { levels, bottom }
    }

    /// Of the bonds of a network alone.
    pub fn of_network(network: &Network, blocks: &Blocks) -> Self {
        Self::new(&Parts { ties: &[network], grounds: &[] }, blocks)
    }

    /// z += P B Pᵀ r: of forces [force] and torques [force length] displacements [length] and rotations [rad].
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

    /// B r at a level: steps of block Jacobi, what the next level does to the rest, and the same steps once more. Symmetric and
    /// positive, as [`DAMPED`] and [`LARGER`] make it.
    fn cycle(&self, level: usize, r: &[Six]) -> Vec<Six> {
        let a = &self.levels[level].matrix;
        let Some(next) = self.levels.get(level + 1) else {
            return self.bottom.as_ref().map_or_else(|| smoothed(a, r), |bottom| bottom.solve(r));
        };
        let mut x = smoothed(a, r);
        let clusters = &next.clusters;
        let rest = clusters.gather(|k| minus(&r[k], &a.times(k, &x)));
        let mut moved = self.cycle(level + 1, &rest);
        // Where the next level is not solved but has a cycle itself, once more.
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

/// Steps of block Jacobi from nothing.
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
