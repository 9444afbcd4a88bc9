//! Walls of triangles: which places a sphere touches, edges and corners counted once.

use super::check::{edges, flat};
use super::{Triangle, bounds, weld};
use perigrain_base::math::forest::{find, join};
use perigrain_base::math::triangle::{Feature, nearest};
use perigrain_base::math::vec3::{Vec3, cross, dot, length, scale, sub};

/// A place of a surface near a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// The number of the triangle.
    pub part: u32,
    /// Unit vector from the nearest point to the sphere's centre.
    pub normal: Vec3,
    /// How far the centre is from that point [length].
    pub distance: f64,
}

/// Neighbours whose normals differ by less than this (30°) belong to one smooth patch.
const SMOOTH: f64 = 0.866_025_403_784_438_6;
/// Of contacts with one patch whose normals differ by less than this (45°) the nearest one stands for all.
const ALIKE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Distances that differ by less, relative to themselves, belong to one shared edge or corner.
const SAME: f64 = 1e-10;
/// Cells along an axis at most.
const CELLS: f64 = 64.0;

/// A surface of triangles at rest.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    triangles: Vec<Triangle>,
    /// Corners by number: those at the same place are one.
    corners: Vec<[u32; 3]>,
    /// The smooth patch of each triangle.
    patch: Vec<u32>,
    grid: Grid,
    /// Edges that border one triangle only.
    pub open_edges: usize,
}

/// Which triangles pass through which cell.
#[derive(Clone, Debug, Default)]
struct Grid {
    lo: Vec3,
    size: f64,
    count: [usize; 3],
    start: Vec<u32>,
    members: Vec<u32>,
}

impl Facets {
    /// The surface of these triangles.
    ///
    /// # Errors
    /// The number (from 0) of a triangle without area.
    pub fn new(triangles: Vec<Triangle>) -> Result<Self, usize> {
        if let Some(bad) = flat(&triangles) {
            return Err(bad);
        }
        let corners = weld(&triangles);
        let edges = edges(&corners);
        let mut patch: Vec<u32> = (0..triangles.len() as u32).collect();
        let normals: Vec<Vec3> = triangles.iter().map(normal).collect();
        let mut open_edges = 0;
        for edge in edges.chunk_by(|a, b| a.0 == b.0) {
            open_edges += usize::from(edge.len() == 1);
            for pair in edge.windows(2) {
                let [a, b] = [pair[0].1 / 3, pair[1].1 / 3];
                // The order of corners, and so the sign of normals, need not be the same everywhere.
                if dot(normals[a], normals[b]).abs() > SMOOTH {
                    join(&mut patch, a as u32, b as u32);
                }
            }
        }
        let patch = (0..patch.len() as u32).map(|k| find(&mut patch, k)).collect();
        let grid = Grid::new(&triangles);
        Ok(Self { triangles, corners, patch, grid, open_edges })
    }

    /// The triangles.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// The farthest corner from an axis of unit length through a point.
    pub fn farthest(&self, point: Vec3, axis: Vec3) -> f64 {
        let far = |p: &Vec3| length(cross(axis, sub(*p, point)));
        self.triangles.iter().flatten().map(far).fold(0.0, f64::max)
    }

    /// Whether one contact may follow another: their triangles lie in one smooth patch.
    pub fn passes(&self, from: u32, to: u32) -> bool {
        self.patch.get(from as usize) == self.patch.get(to as usize)
    }

    /// Whether some triangle is nearer than `reach`.
    pub fn close(&self, x: Vec3, reach: f64) -> bool {
        let near = |k: &u32| {
            let d = sub(x, nearest(x, &self.triangles[*k as usize]).0);
            dot(d, d) < reach * reach
        };
        self.grid.cells(x, reach).any(|members| members.iter().any(&near))
    }

    /// The places nearer than `reach`: one for each face, edge or corner that is nearest in its surroundings, and of
    /// those in one smooth patch that look alike the nearest.
    pub fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let mut members: Vec<u32> = self.grid.cells(x, reach).flatten().copied().collect();
        members.sort_unstable();
        members.dedup();
        let mut found: Vec<(u32, Feature, Vec3, f64)> = vec![];
        for k in members {
            let triangle = &self.triangles[k as usize];
            let (point, feature) = nearest(x, triangle);
            // Of a face the height above it: exactly along its normal wherever the foot lies.
            let apart = match feature {
                Feature::Face => {
                    let n = normal(triangle);
                    scale(dot(sub(x, triangle[0]), n), n)
                }
                _ => sub(x, point),
            };
            let distance = length(apart);
            if distance < reach {
                found.push((k, feature, apart, distance));
            }
        }
        let from = out.len();
        for (k, feature, apart, distance) in &found {
            let shared: &[usize] = match feature {
                Feature::Face => &[],
                Feature::Edge(e) => &[[0, 1], [1, 2], [2, 0]][usize::from(*e)],
                Feature::Corner(c) => &[[0], [1], [2]][usize::from(*c)],
            };
            let has_all = |other: u32| {
                shared.iter().all(|s| self.corners[other as usize].contains(&self.corners[*k as usize][*s]))
            };
            let hidden = !shared.is_empty()
                && found.iter().any(|(other, _, _, d)| {
                    let tie = (d - distance).abs() <= SAME * distance;
                    other != k && has_all(*other) && if tie { other < k } else { d < distance }
                });
            if hidden {
                continue;
            }
            let normal = match *distance > 0.0 {
                true => scale(1.0 / distance, *apart),
                false => normal(&self.triangles[*k as usize]),
            };
            let near = Near { part: *k, normal, distance: *distance };
            self.merge(near, from, out);
        }
    }

    /// Adds a contact, or lets it stand for one that looks alike.
    fn merge(&self, near: Near, from: usize, out: &mut Vec<Near>) {
        let alike = |n: &Near| self.passes(n.part, near.part) && dot(n.normal, near.normal) > ALIKE;
        match out[from..].iter_mut().find(|n| alike(n)) {
            Some(n) if near.distance < n.distance => *n = near,
            Some(_) => {}
            None => out.push(near),
        }
    }
}

impl Grid {
    fn new(triangles: &[Triangle]) -> Self {
        let (lo, hi) = bounds(triangles.as_flattened());
        if triangles.is_empty() {
            return Self::default();
        }
        let extent = (0..3).map(|d| hi[d] - lo[d]).fold(0.0, f64::max);
        let mean = triangles.iter().map(longest).sum::<f64>() / triangles.len() as f64;
        let size = mean.max(extent / CELLS);
        let count = [0, 1, 2].map(|d| ((hi[d] - lo[d]) / size) as usize + 1);
        let mut grid = Self { lo, size, count, start: vec![], members: vec![] };
        let mut lists: Vec<Vec<u32>> = vec![vec![]; count.iter().product()];
        for (k, t) in triangles.iter().enumerate() {
            let (low, high) = bounds(t);
            if let Some((a, b)) = grid.range(low, high) {
                grid.each(a, b).for_each(|c| lists[c].push(k as u32));
            }
        }
        grid.start.push(0);
        for list in lists {
            grid.members.extend(list);
            grid.start.push(grid.members.len() as u32);
        }
        grid
    }

    /// The cells that hold some of a box, which is widened by rounding's share; none if it lies outside.
    fn range(&self, low: Vec3, high: Vec3) -> Option<([usize; 3], [usize; 3])> {
        let (mut a, mut b) = ([0; 3], [0; 3]);
        for d in 0..3 {
            let slack = 1e-9;
            let from = ((low[d] - self.lo[d]) / self.size - slack).floor();
            let to = ((high[d] - self.lo[d]) / self.size + slack).floor();
            let last = self.count[d] as f64 - 1.0;
            if !(to >= 0.0 && from <= last) {
                return None;
            }
            (a[d], b[d]) = (from.max(0.0) as usize, to.min(last) as usize);
        }
        Some((a, b))
    }

    fn each(&self, a: [usize; 3], b: [usize; 3]) -> impl Iterator<Item = usize> + use<> {
        let count = self.count;
        (a[0]..=b[0]).flat_map(move |i| {
            (a[1]..=b[1]).flat_map(move |j| (a[2]..=b[2]).map(move |k| (i * count[1] + j) * count[2] + k))
        })
    }

    /// The triangles of the cells around a place.
    fn cells(&self, x: Vec3, reach: f64) -> impl Iterator<Item = &[u32]> {
        let range =
            if self.start.is_empty() { None } else { self.range(x.map(|a| a - reach), x.map(|a| a + reach)) };
        let cells = range.into_iter().flat_map(|(a, b)| self.each(a, b));
        cells.map(|c| &self.members[self.start[c] as usize..self.start[c + 1] as usize])
    }
}

/// The unit vector across a triangle.
fn normal([a, b, c]: &Triangle) -> Vec3 {
    let n = cross(sub(*b, *a), sub(*c, *a));
    scale(1.0 / length(n), n)
}

/// The area of a triangle.
pub fn area([a, b, c]: &Triangle) -> f64 {
    0.5 * length(cross(sub(*b, *a), sub(*c, *a)))
}

fn longest(t: &Triangle) -> f64 {
    (0..3).map(|k| length(sub(t[k], t[(k + 1) % 3]))).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The floor from (0, 0) to (4, 4), cut along a diagonal, and a wall at x = 4 of height 4.
    fn corner() -> Facets {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]];
        let [e, f] = [[4.0, 0.0, 4.0], [4.0, 4.0, 4.0]];
        Facets::new(vec![[a, b, c], [a, c, d], [b, f, c], [b, e, f]]).unwrap()
    }

    fn seen(m: &Facets, x: Vec3) -> Vec<(Vec3, f64)> {
        let mut out = vec![];
        m.near(x, 1.0, &mut out);
        out.iter().map(|n| (n.normal, n.distance)).collect()
    }

    #[test]
    fn faces_edges_and_corners_count_once() {
        let m = corner();
        let up = [0.0, 0.0, 1.0];
        // On either side of the diagonal and on it: one contact, straight up.
        for x in [[2.1, 2.0, 0.9], [2.0, 2.1, 0.9], [2.0, 2.0, 0.9]] {
            assert_eq!(seen(&m, x), [(up, 0.9)], "{x:?}");
        }
        // In the corner of floor and wall: both.
        assert_eq!(seen(&m, [3.5, 2.2, 0.9]), [(up, 0.9), ([-1.0, 0.0, 0.0], 0.5)]);
        // Beyond the rim: its edge; beyond its corner: the corner. Distances 0.5 by 3 : 4 : 5, and by 2 : 3 : 6 : 7.
        let rim = seen(&m, [-0.3, 2.0, 0.4]);
        assert!(rim.len() == 1 && (rim[0].1 - 0.5).abs() < 1e-15 && (rim[0].0[0] + 0.6).abs() < 1e-15);
        let tip = seen(&m, [-0.2, -0.3, 0.6]);
        assert!(tip.len() == 1 && (tip[0].1 - 0.7).abs() < 1e-15, "{tip:?}");
        // From below, and far away.
        assert_eq!(seen(&m, [1.0, 2.0, -0.5]), [([0.0, 0.0, -1.0], 0.5)]);
        assert!(seen(&m, [1.0, 2.0, 1.5]).is_empty() && !m.close([1.0, 2.0, 1.5], 1.0));
        assert!(m.close([1.0, 2.0, 1.5], 1.6));
        // Springs pass between the two halves of the floor, not between floor and wall.
        assert!(m.passes(0, 1) && !m.passes(0, 2) && m.open_edges == 6);
    }

    #[test]
    fn a_ridge_is_one_edge() {
        // A roof with slopes of 45°: along its ridge at z = 0 both sides are equally near.
        let [a, b] = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let m = Facets::new(vec![[a, b, [4.0, 2.0, -4.0]], [a, b, [-4.0, 2.0, -4.0]]]).unwrap();
        let ridge = seen(&m, [0.1, 2.0, 0.4]);
        assert!(ridge.len() == 1 && (ridge[0].1 - 0.17f64.sqrt()).abs() < 1e-15, "{ridge:?}");
    }

    #[test]
    fn a_valley_of_small_angle_is_felt_once() {
        // Two slopes of 0.1: a sphere in the middle touches both, and both look alike.
        let [a, b] = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let m = Facets::new(vec![[a, b, [4.0, 2.0, 0.4]], [a, b, [-4.0, 2.0, 0.4]]]).unwrap();
        assert_eq!(seen(&m, [0.01, 2.0, 0.9]).len(), 1);
    }

    #[test]
    fn triangles_without_area_are_named() {
        let flat = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        assert_eq!(Facets::new(vec![corner().triangles()[0], flat]).err(), Some(1));
        let nan = [[f64::NAN; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0]];
        assert_eq!(Facets::new(vec![nan]).err(), Some(0));
        assert!(Facets::new(vec![]).unwrap().triangles().is_empty());
    }
}
