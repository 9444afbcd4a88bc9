//! Exact volumes of a body within boxes.

use super::tree::Tree;
use super::{Solid, Triangle};
use perigrain_base::math::vec3::Vec3;

/// A body in transformed coordinates in which the boxes are axis-aligned.
pub struct Columns {
    triangles: Vec<Triangle>,
    tree: Tree,
}

/// A convex polygon with few corners: a triangle cut by up to six planes.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [Vec3; 9],
    count: usize,
}

impl Solid {
    /// The body transformed by the linear `map`.
    pub fn columns(&self, map: impl Fn(Vec3) -> Vec3) -> Columns {
        let triangles: Vec<Triangle> = self.triangles().iter().map(|t| t.map(&map)).collect();
        let tree = Tree::new(&triangles);
        Columns { triangles, tree }
    }
}

impl Columns {
    /// The volume of the body within a box, in these coordinates: a vertical line leaves the body through
    /// upward faces and enters it through downward ones, so the heights of these crossings, clamped to the
    /// box, are summed with these signs.
    pub fn volume(&self, lo: Vec3, hi: Vec3) -> f64 {
        let mut volume = 0.0;
        self.tree.meet(lo, [hi[0], hi[1], f64::INFINITY], |k| {
            volume += below(&self.triangles[k as usize], lo, hi);
            true
        });
        // Coordinates may be left-handed.
        volume.abs()
    }
}

/// The volume between the lower face of a box and a triangle, or the upper face where that is lower; negative
/// for a triangle that faces down.
fn below(t: &Triangle, lo: Vec3, hi: Vec3) -> f64 {
    let mut p = Polygon { corners: [[0.0; 3]; 9], count: 3 };
    p.corners[..3].copy_from_slice(t);
    for d in 0..2 {
        p = p.cut(d, lo[d], false).cut(d, hi[d], true);
    }
    p = p.cut(2, lo[2], false);
    let within = p.cut(2, hi[2], true).integral(lo[2]).0;
    // What lies in the upper face belongs to the box, and must count once.
    if p.corners[..p.count].iter().all(|c| c[2] <= hi[2]) {
        return within;
    }
    within + (hi[2] - lo[2]) * p.cut(2, hi[2], false).integral(lo[2]).1
}

impl Polygon {
    /// The part on one side of a plane normal to axis `d`.
    fn cut(&self, d: usize, at: f64, lower: bool) -> Self {
        let mut out = Self { corners: [[0.0; 3]; 9], count: 0 };
        let height = |p: &Vec3| if lower { at - p[d] } else { p[d] - at };
        for k in 0..self.count {
            let (a, b) = (&self.corners[k], &self.corners[(k + 1) % self.count]);
            let (ha, hb) = (height(a), height(b));
            if ha >= 0.0 {
                out.push(*a);
            }
            if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
                let along = ha / (ha - hb);
                let mut p = [0, 1, 2].map(|e| a[e] + along * (b[e] - a[e]));
                p[d] = at;
                out.push(p);
            }
        }
        out
    }

    fn push(&mut self, p: Vec3) {
        if let Some(corner) = self.corners.get_mut(self.count) {
            *corner = p;
            self.count += 1;
        }
    }

    /// The integral of the height above `base` over the area projected from above, and that area; both
    /// signed.
    fn integral(&self, base: f64) -> (f64, f64) {
        let (mut volume, mut area) = (0.0, 0.0);
        for k in 2..self.count {
            let [a, b, c] = [self.corners[0], self.corners[k - 1], self.corners[k]];
            let part = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            area += part;
            volume += part * ((a[2] + b[2] + c[2]) / 3.0 - base);
        }
        (volume, area)
    }
}
