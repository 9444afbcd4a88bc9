//! Walls of triangles: the contact points of a sphere, with shared edges and corners counted once.

use super::check::flat;
use super::seams::Seams;
use super::sides::Sides;
use super::tree::Tree;
use super::{Triangle, weld};
use perigrain_base::math::triangle::{Feature, nearest};
use perigrain_base::math::vec3::{Vec3, cross, dot, length, scale, sub};

/// A point of a surface near a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// The number of the triangle.
    pub part: u32,
    /// Unit vector from the nearest point to the sphere's centre.
    pub normal: Vec3,
    /// Distance of the centre from that point [length].
    pub distance: f64,
    /// The feature of the triangle on which it lies.
    feature: Feature,
    /// Whether a neighbour is nearer or represents both.
    hidden: bool,
}

/// Contacts with one patch whose normals differ by less than this (45°) are represented by the nearest one.
const ALIKE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Distances with a smaller relative difference belong to one shared edge or corner.
const SAME: f64 = 1e-10;
/// Relative allowance for rounding, so that tests of boxes and sides miss nothing.
pub const SLACK: f64 = 1e-9;

/// A surface of triangles at rest.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    triangles: Vec<Triangle>,
    /// Unit normals of the triangles.
    normals: Vec<Vec3>,
    /// Their sides.
    sides: Vec<Sides>,
    /// Corner numbers: equal positions have equal numbers.
    corners: Vec<[u32; 3]>,
    /// The smooth patch of each triangle.
    patch: Vec<u32>,
    tree: Tree,
    /// Positions closer than this are treated as equal [length].
    miss: f64,
    /// Number of edges, or parts of edges, with a single triangle.
    pub open_edges: usize,
}

impl Facets {
    /// The surface of these triangles.
    ///
    /// # Errors
    /// The number (from 0) of a degenerate triangle.
    pub fn new(triangles: Vec<Triangle>) -> Result<Self, usize> {
        if let Some(bad) = flat(&triangles) {
            return Err(bad);
        }
        let corners = weld(&triangles);
        let normals: Vec<Vec3> = triangles.iter().map(normal).collect();
        let Seams { patch, open_edges, miss } = Seams::new(&triangles, &corners, &normals);
        let tree = Tree::new(&triangles);
        let sides = triangles.iter().zip(&normals).map(|(t, n)| Sides::new(t, *n)).collect();
        Ok(Self { triangles, normals, sides, corners, patch, tree, miss, open_edges })
    }

    /// The triangles.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// The largest distance of a corner from an axis of unit length through a point.
    pub fn farthest(&self, point: Vec3, axis: Vec3) -> f64 {
        let far = |p: &Vec3| length(cross(axis, sub(*p, point)));
        self.triangles.iter().flatten().map(far).fold(0.0, f64::max)
    }

    /// Whether one contact may continue as another: their triangles belong to one smooth patch.
    pub fn passes(&self, from: u32, to: u32) -> bool {
        self.patch.get(from as usize) == self.patch.get(to as usize)
    }

    /// Whether some triangle is within `reach`.
    pub fn close(&self, x: Vec3, reach: f64) -> bool {
        let mut found = false;
        self.visit(x, reach, |k| {
            found = self.reaches(k, x, reach);
            !found
        });
        found
    }

    /// The numbers of the triangles within `reach`, in order.
    pub fn around(&self, x: Vec3, reach: f64, out: &mut Vec<u32>) {
        let from = out.len();
        self.visit(x, reach, |k| {
            if self.reaches(k, x, reach) {
                out.push(k);
            }
            true
        });
        out[from..].sort_unstable();
    }

    /// The contact points within `reach`: one for each locally nearest face, edge or corner, and the nearest
    /// one of those in a smooth patch with similar normals.
    pub fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let mut members = vec![];
        self.around(x, reach, &mut members);
        self.near_among((&members, 0), x, reach, &mut vec![], |near| out.push(near));
    }

    /// Calls `take` for the contact points within `reach`, as in [`Facets::near`]; `members` must contain all
    /// triangles within reach, in order, counted from `first`. `several` is a buffer.
    #[inline]
    pub fn near_among(
        &self,
        (members, first): (&[u32], u32),
        x: Vec3,
        reach: f64,
        several: &mut Vec<Near>,
        mut take: impl FnMut(Near),
    ) {
        // Most spheres touch one triangle.
        let mut sole = None;
        several.clear();
        for &k in members {
            let Some(near) = self.place(k - first, x, reach) else { continue };
            if several.is_empty() {
                match sole.take() {
                    None => sole = Some(near),
                    Some(one) => several.extend([one, near]),
                }
            } else {
                several.push(near);
            }
        }
        if let Some(near) = sole {
            take(Near { normal: self.unit(&near), ..near });
        } else if !several.is_empty() {
            self.settle(x, several);
            several.drain(..).for_each(take);
        }
    }

    /// Leaves of several places those that count.
    fn settle(&self, x: Vec3, found: &mut Vec<Near>) {
        self.hide(x, found);
        let mut kept = 0;
        for k in 0..found.len() {
            let mut near = found[k];
            if near.hidden {
                continue;
            }
            near.normal = self.unit(&near);
            let alike = |n: &&mut Near| self.passes(n.part, near.part) && dot(n.normal, near.normal) > ALIKE;
            match found[..kept].iter_mut().find(alike) {
                Some(n) if near.distance < n.distance => *n = near,
                Some(_) => {}
                None => {
                    found[kept] = near;
                    kept += 1;
                }
            }
        }
        found.truncate(kept);
    }

    /// The direction from a point of the surface to the sphere.
    fn unit(&self, near: &Near) -> Vec3 {
        match near.distance > 0.0 {
            true => scale(1.0 / near.distance, near.normal),
            false => self.normals[near.part as usize],
        }
    }

    /// Calls `visit` for triangles whose boxes are within reach, until it returns stop.
    fn visit(&self, x: Vec3, reach: f64, visit: impl FnMut(u32) -> bool) {
        let wide = |d: usize| reach + SLACK * (reach + x[d].abs());
        self.tree.meet([0, 1, 2].map(|d| x[d] - wide(d)), [0, 1, 2].map(|d| x[d] + wide(d)), visit);
    }

    /// The height of a point above the plane of triangle `k`, along its normal.
    #[inline]
    fn height(&self, k: usize, x: Vec3) -> f64 {
        dot(sub(x, self.triangles[k][0]), self.normals[k])
    }

    /// Whether triangle `k` is within `reach`.
    fn reaches(&self, k: u32, x: Vec3, reach: f64) -> bool {
        let k = k as usize;
        if self.height(k, x).abs() >= reach {
            return false;
        }
        let d = sub(x, nearest(x, &self.triangles[k]).0);
        dot(d, d) < reach * reach
    }

    /// The nearest point of triangle `k`, with the vector from there to `x` in the field of the normal;
    /// `None` beyond `reach`.
    #[inline]
    fn place(&self, k: u32, x: Vec3, reach: f64) -> Option<Near> {
        let at = k as usize;
        // Most triangles that were near some steps ago are rejected here.
        let height = self.height(at, x);
        if height.abs() >= reach {
            return None;
        }
        // Whether it is beyond a side, or clearly inside: the answers of `nearest`, for a quarter of the work.
        let sides = &self.sides[at];
        let beyond = sides.beyond(sub(x, self.triangles[at][0]));
        if beyond > reach + sides.sure {
            return None;
        }
        let inside = beyond < -sides.sure;
        let (point, feature) = if inside { (x, Feature::Face) } else { nearest(x, &self.triangles[at]) };
        // For a face, the height above it: exactly along its normal.
        let apart = match feature {
            Feature::Face => scale(height, self.normals[at]),
            _ => sub(x, point),
        };
        let distance = length(apart);
        (distance < reach).then_some(Near { part: k, normal: apart, distance, feature, hidden: false })
    }

    /// Marks points represented by others: on a common edge or corner, and where triangles overlap.
    fn hide(&self, x: Vec3, found: &mut [Near]) {
        let mut seen = 0;
        for k in 0..found.len() {
            found[k].hidden = found.iter().any(|other| self.shares(&found[k], other));
            seen += usize::from(!found[k].hidden);
        }
        // Corners on an edge, corners with a small gap, and faces on faces have no common corner numbers.
        if seen > 1 {
            for k in 0..found.len() {
                found[k].hidden |= found.iter().any(|other| self.lies_on(x, &found[k], other));
            }
        }
    }

    /// Whether `near` is on an edge or corner that also belongs to `other`'s triangle, which is nearer or
    /// represents both.
    fn shares(&self, near: &Near, other: &Near) -> bool {
        let shared: &[usize] = match near.feature {
            Feature::Face => return false,
            Feature::Edge(e) => &[[0, 1], [1, 2], [2, 0]][usize::from(e)],
            Feature::Corner(c) => &[[0], [1], [2]][usize::from(c)],
        };
        let tie = (other.distance - near.distance).abs() <= SAME * near.distance;
        if other.part == near.part
            || !(if tie { other.part < near.part } else { other.distance < near.distance })
        {
            return false;
        }
        let [own, theirs] = [near, other].map(|n| &self.corners[n.part as usize]);
        shared.iter().all(|s| theirs.contains(&own[*s]))
    }

    /// Whether the point of `near` lies on `other`'s triangle, which is nearer or has the smaller number.
    fn lies_on(&self, x: Vec3, near: &Near, other: &Near) -> bool {
        if near.hidden || (other.distance, other.part) >= (near.distance, near.part) {
            return false;
        }
        let point = sub(x, near.normal);
        let apart = sub(point, nearest(point, &self.triangles[other.part as usize]).0);
        dot(apart, apart) <= self.miss * self.miss
    }
}

/// The unit normal of a triangle.
fn normal([a, b, c]: &Triangle) -> Vec3 {
    let n = cross(sub(*b, *a), sub(*c, *a));
    scale(1.0 / length(n), n)
}

/// The area of a triangle.
pub fn area([a, b, c]: &Triangle) -> f64 {
    0.5 * length(cross(sub(*b, *a), sub(*c, *a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::vec3::add;

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
        // Beyond the rim: its edge; beyond its corner: the corner. Distances 0.5 by 3 : 4 : 5 and 2 : 3 : 6 :
        // 7.
        let rim = seen(&m, [-0.3, 2.0, 0.4]);
        assert!(rim.len() == 1 && (rim[0].1 - 0.5).abs() < 1e-15 && (rim[0].0[0] + 0.6).abs() < 1e-15);
        let tip = seen(&m, [-0.2, -0.3, 0.6]);
        assert!(tip.len() == 1 && (tip[0].1 - 0.7).abs() < 1e-15, "{tip:?}");
        // From below, and far away.
        assert_eq!(seen(&m, [1.0, 2.0, -0.5]), [([0.0, 0.0, -1.0], 0.5)]);
        assert!(seen(&m, [1.0, 2.0, 1.5]).is_empty() && !m.close([1.0, 2.0, 1.5], 1.0));
        assert!(m.close([1.0, 2.0, 1.5], 1.6));
        // Springs are passed between the two halves of the floor, not between floor and wall.
        assert!(m.passes(0, 1) && !m.passes(0, 2) && m.open_edges == 6);
    }

    #[test]
    fn sides_change_no_answer() {
        let mut rng = perigrain_base::math::rng::ParkMiller::new(7);
        let mut vector = |size: f64| [0.0; 3].map(|_: f64| size * (2.0 * rng.uniform() - 1.0));
        let triangles: Vec<Triangle> = (0..40).map(|k| [0; 3].map(|_| vector(1.0 + f64::from(k)))).collect();
        let m = Facets::new(triangles.clone()).unwrap();
        let (mut faces, mut far) = (0, 0);
        for (k, t) in triangles.iter().enumerate() {
            for n in 0..500 {
                // Anywhere, and exactly above sides and corners.
                let x = match n % 3 {
                    0 => vector(50.0),
                    1 => t[n % 2],
                    _ => add(t[0], scale(0.5, add(sub(t[1], t[0]), cross(sub(t[1], t[0]), sub(t[2], t[0]))))),
                };
                let (point, feature) = nearest(x, t);
                let height = dot(sub(x, t[0]), m.normals[k]);
                let apart =
                    if feature == Feature::Face { scale(height, m.normals[k]) } else { sub(x, point) };
                let is = (length(apart) < 9.0 && height.abs() < 9.0).then_some((apart, feature));
                let found = m.place(k as u32, x, 9.0).map(|near| (near.normal, near.feature));
                assert_eq!(found, is);
                faces += usize::from(matches!(is, Some((_, Feature::Face))));
                far += usize::from(is.is_none());
            }
        }
        assert!(faces > 100 && far > 1000, "{faces} {far}");
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
        // Two slopes of 0.1: a sphere in the middle touches both, with similar normals.
        let [a, b] = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let m = Facets::new(vec![[a, b, [4.0, 2.0, 0.4]], [a, b, [-4.0, 2.0, 0.4]]]).unwrap();
        assert_eq!(seen(&m, [0.01, 2.0, 0.9]).len(), 1);
    }

    /// The floor from -2 to 2, its left half of two triangles and its right half of fourteen with other
    /// corners, `gap` apart.
    fn patched(gap: f64) -> Facets {
        let [a, b, c, d] = [[-2.0, -2.0, 0.0], [0.0, -2.0, 0.0], [0.0, 2.0, 0.0], [-2.0, 2.0, 0.0]];
        let mut floor = vec![[a, b, c], [a, c, d]];
        for k in 0..7 {
            let [lo, hi] = [k, k + 1].map(|k| -2.0 + 4.0 * f64::from(k) / 7.0);
            let [a, b, c, d] = [[gap, lo, 0.0], [2.0, lo, 0.0], [2.0, hi, 0.0], [gap, hi, 0.0]];
            floor.extend([[a, b, c], [a, c, d]]);
        }
        Facets::new(floor).unwrap()
    }

    #[test]
    fn corners_on_edges_and_small_gaps_are_no_seams() {
        for gap in [0.0, 1e-9, -1e-9] {
            let m = patched(gap);
            // On the seam, beside it, on a corner of one side; and on all sides.
            for y in [0.0, 0.1, 2.0 / 7.0, 6.0 / 7.0] {
                for x in [0.0, 0.5 * gap, gap, 1e-12, -1e-5, 1e-5, -0.3, 0.3] {
                    let seen = seen(&m, [x, y, 0.9]);
                    assert!(seen.len() == 1 && (seen[0].1 - 0.9).abs() < 1e-15, "{gap} {x} {y}: {seen:?}");
                    assert!((seen[0].0[2] - 1.0).abs() < 1e-15, "{seen:?}");
                }
            }
            // Springs are passed across it, and only its rim is open: 2 + 1 sides on the left, 2 + 7 on the
            // right.
            assert!(m.passes(0, 4) && m.open_edges == 12, "{}", m.open_edges);
        }
        // A gap wide enough for something to fall through stays a gap.
        let m = patched(1e-3);
        assert!(!m.passes(0, 4) && m.open_edges == 20, "{}", m.open_edges);
    }

    #[test]
    fn faces_that_lie_on_each_other_count_once() {
        // Two overlapping squares of one plane without common corners.
        let square = |x: f64| {
            let [a, b, c, d] = [[x, 0.0, 0.0], [x + 2.0, 0.0, 0.0], [x + 2.0, 2.0, 0.0], [x, 2.0, 0.0]];
            [[a, b, c], [a, c, d]]
        };
        let m = Facets::new([square(0.0), square(0.7)].concat()).unwrap();
        for x in [0.5, 0.69, 0.71, 1.3, 1.99, 2.01, 2.5] {
            assert_eq!(seen(&m, [x, 0.9, 0.9]), [([0.0, 0.0, 1.0], 0.9)], "{x}");
        }
    }

    #[test]
    fn a_fin_on_a_plate_makes_a_corner() {
        // It stands on the inside of the plate's faces without common corners.
        let [a, b, c, d] = [[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]];
        let [e, f, g, h] = [[0.5, -1.0, 0.0], [0.5, 1.0, 0.0], [0.5, 1.0, 1.0], [0.5, -1.0, 1.0]];
        let m = Facets::new(vec![[a, b, c], [a, c, d], [e, f, g], [e, g, h]]).unwrap();
        assert_eq!(seen(&m, [0.2, 0.1, 0.4]).len(), 2);
        assert_eq!(seen(&m, [1.2, 0.1, 0.4]).len(), 2);
        // Beyond its end the plate only.
        assert_eq!(seen(&m, [0.5, 1.2, 0.1]).len(), 2);
        assert_eq!(seen(&m, [0.5, 1.2, -0.1]).len(), 1);
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
