//! The nearest point of a triangle.

use super::vec3::{Vec3, add, dot, scale, sub};

/// The feature of a triangle that a point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Its inside.
    Face,
    /// The edge from corner `k` to the next one.
    Edge(u8),
    /// Corner `k`.
    Corner(u8),
}

/// The nearest point of a triangle, and the feature it lies on (Ericson, Real-Time Collision Detection,
/// 5.1.5).
#[inline]
pub fn nearest(p: Vec3, [a, b, c]: &[Vec3; 3]) -> (Vec3, Feature) {
    let (ab, ac, ap) = (sub(*b, *a), sub(*c, *a), sub(p, *a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, Feature::Corner(0));
    }
    let bp = sub(p, *b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (add(*a, scale(d1 / (d1 - d3), ab)), Feature::Edge(0));
    }
    let cp = sub(p, *c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (add(*a, scale(d2 / (d2 - d6), ac)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (add(*b, scale(along, sub(*c, *b))), Feature::Edge(1));
    }
    let inverse = 1.0 / (va + vb + vc);
    (add(*a, add(scale(vb * inverse, ab), scale(vc * inverse, ac))), Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_found() {
        let t = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        // Positions and nearest points by hand.
        for (p, point, feature) in [
            ([1.0, 1.0, 2.0], [1.0, 1.0, 0.0], Feature::Face),
            ([-1.0, -1.0, 1.0], [0.0; 3], Feature::Corner(0)),
            ([6.0, -1.0, 0.0], [4.0, 0.0, 0.0], Feature::Corner(1)),
            ([-1.0, 7.0, 0.0], [0.0, 4.0, 0.0], Feature::Corner(2)),
            ([2.0, -3.0, 1.0], [2.0, 0.0, 0.0], Feature::Edge(0)),
            ([3.0, 3.0, 0.0], [2.0, 2.0, 0.0], Feature::Edge(1)),
            ([-2.0, 1.0, 0.0], [0.0, 1.0, 0.0], Feature::Edge(2)),
        ] {
            assert_eq!(nearest(p, &t), (point, feature), "{p:?}");
        }
    }
}
