//! Adjacency of triangles: by common corners, or along edges that lie on each other.

use super::check::edges;
use super::tree::Tree;
use super::{Triangle, bounds};
use perigrain_base::math::forest::{find, join};
use perigrain_base::math::vec3::{Vec3, add, dot, length, scale, sub};

/// Neighbours whose normals differ by less than this (30°) belong to one smooth patch.
const SMOOTH: f64 = 0.866_025_403_784_438_6;
/// Relative to the extent of the surface, gaps below this between corners and edges are closed: 32-bit
/// numbers and texts with six digits have rounding errors of this size.
const MISS: f64 = 1e-6;

/// Adjacency data of a surface.
pub struct Seams {
    /// The smooth patch of each triangle.
    pub patch: Vec<u32>,
    /// Number of edges that are open, wholly or in part.
    pub open_edges: usize,
    /// Positions closer than this are treated as equal [length].
    pub miss: f64,
}

/// A side without a partner of equal corners.
struct Side {
    triangle: usize,
    ends: [Vec3; 2],
    /// Intervals along it that other sides cover [length].
    covered: Vec<[f64; 2]>,
}

impl Seams {
    /// For triangles with these corners and normals.
    pub fn new(triangles: &[Triangle], corners: &[[u32; 3]], normals: &[Vec3]) -> Self {
        let mut patch: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut smooth = |a: usize, b: usize| {
            // The order of corners, and so the sign of normals, need not be consistent.
            if dot(normals[a], normals[b]).abs() > SMOOTH {
                join(&mut patch, a as u32, b as u32);
            }
        };
        let mut lone = vec![];
        for edge in edges(corners).chunk_by(|a, b| a.0 == b.0) {
            for pair in edge.windows(2) {
                smooth(pair[0].1 / 3, pair[1].1 / 3);
            }
            if let [(_, side)] = edge {
                lone.push(Side::new(triangles, *side));
            }
        }
        let (lo, hi) = bounds(triangles.as_flattened());
        let miss = MISS * (0..3).map(|d| hi[d] - lo[d]).fold(0.0, f64::max);
        meet(&mut lone, miss, smooth);
        let open_edges = lone.iter_mut().map(|side| usize::from(side.is_open(miss))).sum();
        let patch = (0..patch.len() as u32).map(|k| find(&mut patch, k)).collect();
        Self { patch, open_edges, miss }
    }
}

/// Finds unpaired sides that lie on each other, and calls `smooth` for their triangles.
fn meet(lone: &mut [Side], miss: f64, mut smooth: impl FnMut(usize, usize)) {
    let segments: Vec<Triangle> = lone.iter().map(|Side { ends: [a, b], .. }| [*a, *b, *b]).collect();
    let tree = Tree::new(&segments);
    for k in 0..lone.len() {
        let (lo, hi) = bounds(&lone[k].ends);
        let mut found = vec![];
        tree.meet(lo.map(|x| x - miss), hi.map(|x| x + miss), |other| {
            if other as usize != k {
                found.extend(lone[k].overlap(&lone[other as usize], miss).map(|part| (other as usize, part)));
            }
            true
        });
        for (other, part) in found {
            lone[k].covered.push(part);
            if other > k {
                smooth(lone[k].triangle, lone[other].triangle);
            }
        }
    }
}

impl Side {
    /// Side `3 k + c` begins at corner c of triangle k.
    fn new(triangles: &[Triangle], side: usize) -> Self {
        let (triangle, c) = (side / 3, side % 3);
        let ends = [triangles[triangle][c], triangles[triangle][(c + 1) % 3]];
        Self { triangle, ends, covered: vec![] }
    }

    /// Its length and direction.
    fn along(&self) -> (f64, Vec3) {
        let whole = sub(self.ends[1], self.ends[0]);
        (length(whole), scale(1.0 / length(whole), whole))
    }

    /// The interval along which another side lies on it; `None` if they meet in a point only.
    fn overlap(&self, other: &Self, miss: f64) -> Option<[f64; 2]> {
        let (long, way) = self.along();
        let [from, to] = other.ends.map(|end| dot(sub(end, self.ends[0]), way));
        let (lo, hi) = (from.min(to).max(0.0), from.max(to).min(long));
        // A point of one side is within `miss` of the other: the ends of the common interval.
        let near = |at: f64| {
            let own = add(self.ends[0], scale(at, way));
            let part = (at - from) / (to - from);
            let theirs = add(other.ends[0], scale(part, sub(other.ends[1], other.ends[0])));
            length(sub(own, theirs)) <= miss
        };
        (hi - lo > 4.0 * miss && near(lo) && near(hi)).then_some([lo, hi])
    }

    /// Whether a part of it is open.
    fn is_open(&mut self, miss: f64) -> bool {
        self.covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let reached =
            self.covered.iter().fold(0.0f64, |reached, [lo, hi]| match *lo <= reached + 4.0 * miss {
                true => reached.max(*hi),
                false => reached,
            });
        reached < self.along().0 - 4.0 * miss
    }
}
