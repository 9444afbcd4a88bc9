//! Surfaces, open or closed, that cut bonds.

use super::check::{self, Fault};
use super::exact::side3;
use super::tree::Tree;
use super::{Triangle, bounds};
use perigrain_base::math::vec3::{Vec3, cross, sub};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A surface as a cut; clones share it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Vec<Triangle>", into = "Vec<Triangle>")]
pub struct Sheet(Arc<(Vec<Triangle>, Tree)>);

impl From<Vec<Triangle>> for Sheet {
    fn from(triangles: Vec<Triangle>) -> Self {
        let tree = Tree::new(&triangles);
        Self(Arc::new((triangles, tree)))
    }
}

impl From<Sheet> for Vec<Triangle> {
    fn from(sheet: Sheet) -> Self {
        sheet.0.0.clone()
    }
}

impl Sheet {
    /// The cut along these triangles.
    ///
    /// # Errors
    /// No triangles, or degenerate ones.
    pub fn new(triangles: Vec<Triangle>) -> Result<Self, Fault> {
        check::areas(&triangles)?;
        Ok(Self::from(triangles))
    }

    /// Whether all its coordinates are finite.
    pub fn is_sound(&self) -> bool {
        self.0.0.as_flattened().as_flattened().iter().all(|x| x.is_finite())
    }

    /// Whether the segment between two points crosses a triangle, including edges and corners; a point on a
    /// triangle lies on the side of its normal, which points up along the first axis with a nonzero
    /// component.
    pub fn cuts(&self, a: Vec3, b: Vec3) -> bool {
        let (triangles, tree) = &*self.0;
        let (lo, hi) = bounds([&a, &b]);
        let mut cut = false;
        tree.meet(lo, hi, |k| {
            cut = crosses(&triangles[k as usize], &a, &b);
            !cut
        });
        cut
    }
}

fn crosses(t: &Triangle, a: &Vec3, b: &Vec3) -> bool {
    let [p, q, r] = t;
    // The direction of the normal must not depend on the order of corners.
    let up = cross(sub(*q, *p), sub(*r, *p)).into_iter().find(|n| *n != 0.0).is_none_or(|n| n > 0.0);
    let above = |x: &Vec3| match side3(p, q, r, x) {
        0 => true,
        side => (side < 0) == up,
    };
    if above(a) == above(b) {
        return false;
    }
    let sides = [side3(a, b, p, q), side3(a, b, q, r), side3(a, b, r, p)];
    !(sides.contains(&1) && sides.contains(&-1))
}
