//! The sides of a triangle: whether a point is clearly inside or beyond them.

use super::Triangle;
use super::facets::SLACK;
use perigrain_base::math::vec3::{Vec3, cross, dot, length, scale, sub};

/// The sides of a triangle as planes that stand on it.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    /// Unit vectors in its plane, out of it.
    out: [Vec3; 3],
    /// How far each side is from the first corner along its vector [length].
    at: [f64; 3],
    /// What is farther from a side than this is on one side of it, whatever the rounding [length].
    pub sure: f64,
}

impl Sides {
    /// Those of a triangle with this normal.
    pub fn new(t: &Triangle, normal: Vec3) -> Self {
        let along = [0, 1, 2].map(|k| sub(t[(k + 1) % 3], t[k]));
        let out = along.map(|a| cross(a, normal)).map(|o| scale(1.0 / length(o), o));
        let at = [0, 1, 2].map(|k| dot(out[k], sub(t[k], t[0])));
        Self { out, at, sure: SLACK * along.map(length).into_iter().fold(0.0, f64::max) }
    }

    /// How far a point, seen from the first corner, is beyond the side that it is farthest beyond [length].
    #[inline]
    pub fn beyond(&self, x: Vec3) -> f64 {
        let [a, b, c] = [0, 1, 2].map(|k| dot(self.out[k], x) - self.at[k]);
        a.max(b).max(c)
    }
}
