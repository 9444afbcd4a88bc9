//! Area and moments of a union of discs, from the arcs of its boundary.

use perigrain_base::math::vec3::Vec3;
use std::f64::consts::TAU;

/// A disc in the plane.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    x: f64,
    y: f64,
    radius: f64,
}

/// Area, first and second moments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    pub area: f64,
    pub x: f64,
    pub y: f64,
    pub xx: f64,
    pub yy: f64,
    pub xy: f64,
}

impl Disc {
    /// The disc in which a plane across z cuts a sphere.
    pub fn cut(x: Vec3, radius: f64, z: f64) -> Option<Self> {
        let square = radius * radius - (z - x[2]) * (z - x[2]);
        (square > 0.0).then(|| Self { x: x[0], y: x[1], radius: square.sqrt() })
    }

    /// The angles of its rim that another disc covers, from and to; all of them where it hides this one. Of two like ones the second is
    /// hidden.
    fn covered(&self, other: &Self, later: bool) -> Option<[f64; 2]> {
        let (x, y) = (other.x - self.x, other.y - self.y);
        let d = x.hypot(y);
        if d + self.radius < other.radius || (d + self.radius == other.radius && (d > 0.0 || later)) {
            return Some([0.0, TAU]);
        }
        if d >= self.radius + other.radius || d + other.radius <= self.radius {
            return None;
        }
        let cosine =
            (d * d + self.radius * self.radius - other.radius * other.radius) / (2.0 * d * self.radius);
        let (middle, half) = (y.atan2(x), cosine.clamp(-1.0, 1.0).acos());
        Some([middle - half, middle + half])
    }
}

impl Moments {
    /// Those of all discs together.
    pub fn of(discs: &[Disc]) -> Self {
        let mut sum = Self::default();
        let mut hidden: Vec<[f64; 2]> = vec![];
        for (i, disc) in discs.iter().enumerate() {
            hidden.clear();
            for (j, other) in discs.iter().enumerate().filter(|(j, _)| *j != i) {
                let Some([from, to]) = disc.covered(other, j < i) else { continue };
                let start = from.rem_euclid(TAU);
                let end = start + (to - from);
                if end > TAU {
                    hidden.push([0.0, end - TAU]);
                }
                hidden.push([start, end.min(TAU)]);
            }
            hidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let mut at = 0.0;
            for [from, to] in &hidden {
                if *from > at {
                    sum.arc(disc, at, *from);
                }
                at = at.max(*to);
            }
            if at < TAU {
                sum.arc(disc, at, TAU);
            }
        }
        sum
    }

    /// Adds the part of an arc of the boundary, from angle to angle: the integrals of (x dy - y dx)/2, x² dy/2, -y² dx/2, x³ dy/3, -y³ dx/3
    /// and x² y dy/2 (Green's theorem).
    fn arc(&mut self, disc: &Disc, from: f64, to: f64) {
        let Disc { x, y, radius: r } = *disc;
        let ((s0, c0), (s1, c1)) = (from.sin_cos(), to.sin_cos());
        let by = |f: fn(f64, f64) -> f64| f(c1, s1) - f(c0, s0);
        let angle = to - from;
        // Integrals of powers of cosine and sine.
        let (c, s) = (by(|_, s| s), by(|c, _| -c));
        let double = by(|c, s| 2.0 * c * s);
        let (cc, ss) = (0.5 * angle + 0.25 * double, 0.5 * angle - 0.25 * double);
        let cs = by(|_, s| 0.5 * s * s);
        let (ccc, sss) = (by(|_, s| s - s * s * s / 3.0), by(|c, _| c * c * c / 3.0 - c));
        let ccs = by(|c, _| -c * c * c / 3.0);
        // The sine of four times the angle.
        let fourfold = by(|c, s| 4.0 * c * s * (c * c - s * s)) / 32.0;
        let (cccc, ssss) =
            (0.375 * angle + 0.25 * double + fourfold, 0.375 * angle - 0.25 * double + fourfold);
        let cccs = by(|c, _| -0.25 * c * c * c * c);
        self.area += 0.5 * r * (x * c + y * s + r * angle);
        self.x += 0.5 * r * (x * x * c + 2.0 * x * r * cc + r * r * ccc);
        self.y += 0.5 * r * (y * y * s + 2.0 * y * r * ss + r * r * sss);
        let cube = |x: f64, a: f64, b: f64, c: f64, d: f64| {
            r / 3.0 * (x * x * x * a + 3.0 * x * x * r * b + 3.0 * x * r * r * c + r * r * r * d)
        };
        self.xx += cube(x, c, cc, ccc, cccc);
        self.yy += cube(y, s, ss, sss, ssss);
        let even = x * x * (y * c + r * cs) + 2.0 * x * r * (y * cc + r * ccs);
        self.xy += 0.5 * r * (even + r * r * (y * ccc + r * cccs));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    // Of one disc: pi r², the parallel axes, pi r⁴/4.
    #[test]
    fn one_disc() {
        let m = Moments::of(&[Disc { x: 2.0, y: -3.0, radius: 1.5 }]);
        let area = PI * 2.25;
        for (found, true_) in [
            (m.area, area),
            (m.x, 2.0 * area),
            (m.y, -3.0 * area),
            (m.xx, area * (4.0 + 2.25 / 4.0)),
            (m.yy, area * (9.0 + 2.25 / 4.0)),
            (m.xy, -6.0 * area),
        ] {
            assert!((found - true_).abs() < 1e-13 * area * 10.0, "{found} {true_}");
        }
    }

    // Four discs in a ring leave a hole between them: counted on a lattice of a million points, which is good to 1e-3.
    #[test]
    fn a_ring_with_a_hole() {
        let discs =
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.1)].map(|(x, y)| Disc { x, y, radius: 0.8 });
        let m = Moments::of(&discs);
        let (mut count, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let h = 4.0 / 1000.0;
        for i in 0..1000 {
            for j in 0..1000 {
                let (x, y) = (-2.0 + (f64::from(i) + 0.5) * h, -2.0 + (f64::from(j) + 0.5) * h);
                if discs.iter().any(|d| (x - d.x).hypot(y - d.y) < d.radius) {
                    (count, xy, yy) = (count + h * h, xy + x * y * h * h, yy + y * y * h * h);
                }
            }
        }
        assert!(
            (m.area - count).abs() < 2e-3 && (m.xy - xy).abs() < 2e-3 && (m.yy - yy).abs() < 4e-3,
            "{m:?}"
        );
    }
}
