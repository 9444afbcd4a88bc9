//! Bodies enclosed by a surface.

use super::check::{self, Fault};
use super::exact::{side2, side3};
use super::facets::{Facets, Near};
use super::tree::Tree;
use super::{Triangle, area, seen_along, widest};
use perigrain_base::math::vec3::{Vec3, cross, dot, sub};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A body within a closed triangle surface; clones share it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(try_from = "Vec<Triangle>", into = "Vec<Triangle>")]
pub struct Solid(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    facets: Facets,
    tree: Tree,
    turned: usize,
}

impl PartialEq for Solid {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.triangles() == other.triangles()
    }
}

impl From<Solid> for Vec<Triangle> {
    fn from(solid: Solid) -> Self {
        solid.triangles().to_vec()
    }
}

/// The contents of a file were checked when it was written; here they must only be safe.
impl TryFrom<Vec<Triangle>> for Solid {
    type Error = &'static str;

    fn try_from(triangles: Vec<Triangle>) -> Result<Self, Self::Error> {
        let facets = Facets::new(triangles).map_err(|_| "a triangle of a region has no area")?;
        let tree = Tree::new(facets.triangles());
        Ok(Self(Arc::new(Inner { facets, tree, turned: 0 })))
    }
}

impl Solid {
    /// The body within these triangles, which are flipped so that all are counterclockwise seen from outside.
    ///
    /// # Errors
    /// The fault of a surface that is not closed.
    pub fn new(mut triangles: Vec<Triangle>) -> Result<Self, Fault> {
        check::areas(&triangles)?;
        let tree = Tree::new(&triangles);
        let sides = check::closed(&triangles)?;
        check::crossings(&triangles, &tree)?;
        let turned = sides.orient(&mut triangles, &tree)?;
        let facets = Facets::new(triangles).map_err(Fault::Flat)?;
        Ok(Self(Arc::new(Inner { facets, tree, turned })))
    }

    /// The triangles.
    pub fn triangles(&self) -> &[Triangle] {
        self.0.facets.triangles()
    }

    /// The number of triangles that were flipped.
    pub fn turned(&self) -> usize {
        self.0.turned
    }

    /// The bounding box of the body.
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.0.tree.bounds()
    }

    /// Its volume [length³].
    pub fn volume(&self) -> f64 {
        let Some((lo, _)) = self.bounds() else { return 0.0 };
        let wedge = |t: &Triangle| dot(sub(t[0], lo), cross(sub(t[1], lo), sub(t[2], lo))) / 6.0;
        self.triangles().iter().map(wedge).sum()
    }

    /// The area of its surface [length²].
    pub fn area(&self) -> f64 {
        self.triangles().iter().map(area).sum()
    }

    /// Whether the point is inside or on the surface; exact for every position.
    pub fn contains(&self, x: Vec3) -> bool {
        let Some((lo, hi)) = self.bounds() else { return false };
        if !(0..3).all(|d| x[d] >= lo[d] && x[d] <= hi[d]) {
            return false;
        }
        inside(self.triangles(), &self.0.tree, x, |_| true)
    }

    /// Whether the surface is within `reach`.
    pub fn close(&self, x: Vec3, reach: f64) -> bool {
        self.0.facets.close(x, reach)
    }

    /// The contact points of the surface within `reach`, one of those with similar normals.
    pub fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        self.0.facets.near(x, reach, out);
    }

    /// Whether a contact may continue as another: their triangles belong to one smooth patch.
    pub fn passes(&self, from: u32, to: u32) -> bool {
        self.0.facets.passes(from, to)
    }
}

/// Whether a point lies on one of the triangles that count, or a ray from there crosses an odd number of
/// them.
///
/// The ray follows the axis with the shortest way out, and passes beside edges and corners as if the point
/// were displaced perpendicularly by an infinitesimal step, the same for all triangles.
pub fn inside(triangles: &[Triangle], tree: &Tree, x: Vec3, counts: impl Fn(u32) -> bool) -> bool {
    let Some((low, high)) = tree.bounds() else { return false };
    let ways = (0..3).flat_map(|d| [(x[d] - low[d], d, false), (high[d] - x[d], d, true)]);
    let Some((_, axis, up)) = ways.min_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
    let (mut lo, mut hi) = (x, x);
    if up {
        hi[axis] = f64::INFINITY;
    } else {
        lo[axis] = f64::NEG_INFINITY;
    }
    let (mut odd, mut on) = (false, false);
    tree.meet(lo, hi, |k| {
        if counts(k) {
            match meets(&triangles[k as usize], &x, axis, up) {
                Meets::Not => {}
                Meets::On => on = true,
                Meets::Crosses => odd = !odd,
            }
        }
        !on
    });
    on || odd
}

enum Meets {
    Not,
    On,
    Crosses,
}

/// The sides of a point relative to the three edges, projected along an axis; `None` if they differ, so that
/// it is outside the triangle.
fn sides(t: &Triangle, x: &Vec3, axis: usize) -> Option<[i8; 3]> {
    let (p, [a, b, c]) = (seen_along(x, axis), [0, 1, 2].map(|k| seen_along(&t[k], axis)));
    let sides = [side2(a, b, p), side2(b, c, p), side2(c, a, p)];
    (!(sides.contains(&1) && sides.contains(&-1))).then_some(sides)
}

fn meets(t: &Triangle, x: &Vec3, axis: usize, up: bool) -> Meets {
    let within = |d: usize| {
        let p = [t[0][d], t[1][d], t[2][d]];
        x[d] >= p[0].min(p[1]).min(p[2]) && x[d] <= p[0].max(p[1]).max(p[2])
    };
    if !within((axis + 1) % 3) || !within((axis + 2) % 3) {
        return Meets::Not;
    }
    let Some(sides2) = sides(t, x, axis) else { return Meets::Not };
    let below = side3(&t[0], &t[1], &t[2], x);
    if below == 0 {
        // In its plane, with all edges collinear in this projection: project along the axis where the
        // triangle is widest.
        let widest = widest(t);
        let on = within(axis) && (widest == axis || sides(t, x, widest).is_some());
        return if on { Meets::On } else { Meets::Not };
    }
    // A point on an edge belongs to the side to which it is displaced: along the first coordinate, then the
    // second.
    let shifted = |k: usize| match sides2[k] {
        0 => {
            let (a, b) = (seen_along(&t[k], axis), seen_along(&t[(k + 1) % 3], axis));
            if a[1] != b[1] {
                if b[1] > a[1] { -1 } else { 1 }
            } else if b[0] > a[0] {
                1
            } else {
                -1
            }
        }
        side => side,
    };
    let turn = shifted(0);
    if shifted(1) != turn || shifted(2) != turn {
        return Meets::Not;
    }
    // Counterclockwise seen from above, and the point below: an upward ray crosses it.
    if (turn * below > 0) == up { Meets::Crosses } else { Meets::Not }
}
