//! The surface of a region as triangles, for pictures.

use super::shape::{Shape, across};
use super::{Region, turned};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use std::f64::consts::{PI, TAU};

type Triangle = [Vec3; 3];
type Bounds = [[f64; 2]; 3];

/// Corners around round shapes.
const AROUND: usize = 48;
/// And from pole to pole.
const POLES: usize = 24;

impl Region {
    /// Its surface as triangles; an unbounded one is cut at these bounds. Open faces are left out.
    pub fn outline(&self, bounds: Bounds) -> Vec<Triangle> {
        let mut found = match &self.shape {
            Shape::Union(parts) => combined(parts, bounds, |p| !p.open_side(), false),
            Shape::Intersect(parts) => combined(parts, bounds, |_| true, true),
            shape => shape.outline(self.open, bounds),
        };
        if let Some(motion) = &self.motion {
            for p in found.as_flattened_mut() {
                if let Some(t) = &motion.turn {
                    *p = turned(*p, t.point, t.axis, t.angle);
                }
                *p = add(*p, motion.now);
            }
        }
        found
    }

    /// Whether it has faces that are left open.
    fn open_side(&self) -> bool {
        self.open != 0
    }
}

/// Of the surfaces of several regions what lies inside of all others, or of none. Only those that `hides` keep others from being seen.
fn combined(parts: &[Region], bounds: Bounds, hides: fn(&Region) -> bool, inside: bool) -> Vec<Triangle> {
    let mut found = vec![];
    for (k, part) in parts.iter().enumerate() {
        let others = || parts.iter().enumerate().filter(|(other, p)| *other != k && hides(p));
        found.extend(part.outline(bounds).into_iter().filter(|t| {
            let middle = scale(1.0 / 3.0, add(add(t[0], t[1]), t[2]));
            others().all(|(_, other)| other.contains(middle) == inside)
        }));
    }
    found
}

impl Shape {
    fn outline(&self, open: u8, bounds: Bounds) -> Vec<Triangle> {
        let shut = |face: usize| open & (1 << face) == 0;
        match self {
            Shape::Block { lo, hi } => cell(*lo, *hi, [0.0; 3], shut, bounds),
            Shape::Prism { lo, hi, tilt } => cell(*lo, *hi, *tilt, shut, bounds),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                revolved(*axis, *center, [*radius; 2], [*lo, *hi], shut, bounds)
            }
            Shape::Cone { axis, center, radius, lo, hi } => {
                revolved(*axis, *center, *radius, [*lo, *hi], shut, bounds)
            }
            Shape::Sphere { center, radius } => ball(*center, [*radius; 3]),
            Shape::Ellipsoid { center, half } => ball(*center, *half),
            Shape::Plane { point, normal } => slice(*point, *normal, bounds),
            Shape::Mesh(solid) => solid.triangles().to_vec(),
            Shape::Union(_) | Shape::Intersect(_) => vec![],
        }
    }
}

/// A polygon around its first corner.
fn fan(corners: &[Vec3]) -> Vec<Triangle> {
    corners.get(1..).unwrap_or_default().windows(2).map(|p| [corners[0], p[0], p[1]]).collect()
}

/// The faces of a block or, tilted, a prism; those beyond the bounds are none.
fn cell(
    lo: Vec3,
    hi: Vec3,
    [xy, xz, yz]: [f64; 3],
    shut: impl Fn(usize) -> bool,
    bounds: Bounds,
) -> Vec<Triangle> {
    let ends = [0, 1, 2].map(|d| [lo[d].max(bounds[d][0]), hi[d].min(bounds[d][1])]);
    let ends = if [xy, xz, yz] == [0.0; 3] { ends } else { [0, 1, 2].map(|d| [lo[d], hi[d]]) };
    let corner = |at: [usize; 3]| {
        let [x, y, z] = [0, 1, 2].map(|d| ends[d][at[d]]);
        let (up, back) = ((z - lo[2]) / (hi[2] - lo[2]), (y - lo[1]) / (hi[1] - lo[1]));
        let lean = |tilt: f64, part: f64| if tilt == 0.0 { 0.0 } else { tilt * part };
        [x + lean(xy, back) + lean(xz, up), y + lean(yz, up), z]
    };
    let mut found = vec![];
    for face in 0..6 {
        let (d, side) = (face / 2, face % 2);
        if !shut(face) || ends[d][side] != [lo, hi][side][d] {
            continue;
        }
        let around = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
            let mut at = [side; 3];
            (at[(d + 1) % 3], at[(d + 2) % 3]) = (a, b);
            corner(at)
        });
        found.extend(fan(&around));
    }
    found
}

/// The faces of a cylinder or cone: 0 the lower end, 1 the upper one, 2 the side.
fn revolved(
    axis: usize,
    center: [f64; 2],
    radius: [f64; 2],
    ends: [f64; 2],
    shut: impl Fn(usize) -> bool,
    bounds: Bounds,
) -> Vec<Triangle> {
    let cut = [ends[0].max(bounds[axis][0]), ends[1].min(bounds[axis][1])];
    let wide = |at: f64| match radius[0] == radius[1] {
        true => radius[0],
        false => radius[0] + (radius[1] - radius[0]) * (at - ends[0]) / (ends[1] - ends[0]),
    };
    let ring = |end: usize| -> Vec<Vec3> {
        let corner = |k: usize| {
            let angle = TAU * k as f64 / AROUND as f64;
            let mut p = [cut[end]; 3];
            let [a, b] = across(axis);
            (p[a], p[b]) =
                (center[0] + wide(cut[end]) * angle.cos(), center[1] + wide(cut[end]) * angle.sin());
            p
        };
        (0..AROUND).map(corner).collect()
    };
    let rings = [ring(0), ring(1)];
    let mut found = vec![];
    if shut(2) {
        found.extend(belt(&rings[0], &rings[1]));
    }
    for end in 0..2 {
        if shut(end) && cut[end] == ends[end] {
            found.extend(fan(&rings[end]));
        }
    }
    found.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    found
}

/// The squares between two rings.
fn belt(low: &[Vec3], high: &[Vec3]) -> Vec<Triangle> {
    let n = low.len();
    (0..n)
        .map(|k| (k, (k + 1) % n))
        .flat_map(|(k, l)| [[low[k], low[l], high[l]], [low[k], high[l], high[k]]])
        .collect()
}

fn ball(center: Vec3, half: Vec3) -> Vec<Triangle> {
    let ring = |j: usize| -> Vec<Vec3> {
        let (sin, cos) = (PI * j as f64 / POLES as f64).sin_cos();
        let sin = if j.is_multiple_of(POLES) { 0.0 } else { sin };
        let corner = |k: usize| {
            let angle = TAU * k as f64 / AROUND as f64;
            let unit = [sin * angle.cos(), sin * angle.sin(), -cos];
            [0, 1, 2].map(|d| center[d] + half[d] * unit[d])
        };
        (0..AROUND).map(corner).collect()
    };
    let mut found: Vec<Triangle> = (0..POLES).flat_map(|j| belt(&ring(j), &ring(j + 1))).collect();
    found.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    found
}

/// What of a plane lies within bounds.
fn slice(point: Vec3, normal: Vec3, bounds: Bounds) -> Vec<Triangle> {
    let size = (0..3).map(|d| bounds[d][1] - bounds[d][0]).fold(0.0, f64::max);
    let n = scale(1.0 / length(normal), normal);
    // A square around the foot of the bounds' middle that is wide enough, cut by one bound after the other.
    let middle = bounds.map(|[lo, hi]| 0.5 * (lo + hi));
    let foot = sub(middle, scale(dot(sub(middle, point), n), n));
    let thin = (0..3).min_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs())).unwrap_or(0);
    let mut helper = [0.0; 3];
    helper[thin] = 1.0;
    let u = cross(n, helper);
    let u = scale(2.0 * size / length(u), u);
    let v = cross(n, u);
    let mut corners =
        vec![sub(sub(foot, u), v), sub(add(foot, u), v), add(add(foot, u), v), add(sub(foot, u), v)];
    for d in 0..3 {
        for (side, bound) in bounds[d].into_iter().enumerate() {
            let inside = |p: &Vec3| if side == 0 { p[d] - bound } else { bound - p[d] };
            let mut kept = vec![];
            for (k, p) in corners.iter().enumerate() {
                let q = &corners[(k + 1) % corners.len()];
                let (a, b) = (inside(p), inside(q));
                if a >= 0.0 {
                    kept.push(*p);
                }
                if (a >= 0.0) != (b >= 0.0) {
                    let mut between = add(*p, scale(a / (a - b), sub(*q, *p)));
                    between[d] = bound;
                    kept.push(between);
                }
            }
            corners = kept;
        }
    }
    fan(&corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = [[-1.0, 1.0], [-1.0, 1.0], [0.0, 4.0]];

    fn area(all: &[Triangle]) -> f64 {
        all.iter().map(|t| 0.5 * length(cross(sub(t[1], t[0]), sub(t[2], t[0])))).sum()
    }

    #[test]
    fn surfaces_have_the_area_of_their_shapes() {
        let of = |shape: Shape, open: u8| area(&Region { open, ..Region::inside(shape) }.outline(BOX));
        let inf = f64::INFINITY;
        // Calculated by hand; round ones fall short with the square of their pieces, 0.3 % at most.
        let near = |got: f64, wanted: f64| assert!((got / wanted - 1.0).abs() < 4e-3, "{got} {wanted}");
        near(of(Shape::Block { lo: [0.0; 3], hi: [1.0, 1.0, 2.0] }, 0), 10.0);
        near(of(Shape::Block { lo: [0.0; 3], hi: [1.0, 1.0, inf] }, 1), 1.0 + 3.0 * 4.0);
        let tube = |lo, hi| Shape::Cylinder { axis: 2, center: [0.0; 2], radius: 0.5, lo, hi };
        near(of(tube(1.0, 3.0), 3), TAU);
        near(of(tube(1.0, 3.0), 0), TAU + 0.5 * PI);
        near(of(tube(-inf, inf), 0), 2.0 * TAU);
        let cone = Shape::Cone { axis: 2, center: [0.0; 2], radius: [0.0, 3.0], lo: 0.0, hi: 4.0 };
        near(of(cone, 3), PI * 3.0 * 5.0);
        near(of(Shape::Sphere { center: [0.0; 3], radius: 0.5 }, 0), PI);
        near(of(Shape::Plane { point: [0.0, 0.0, 2.0], normal: [0.0, 0.0, 5.0] }, 0), 4.0);
        near(of(Shape::Plane { point: [0.0; 3], normal: [1.0, -1.0, 0.0] }, 0), 4.0 * 8f64.sqrt());
        assert_eq!(of(Shape::Plane { point: [0.0, 0.0, 9.0], normal: [0.0, 0.0, 1.0] }, 0), 0.0);
        let prism = Shape::Prism { lo: [0.0; 3], hi: [1.0; 3], tilt: [0.0, 1.0, 0.0] };
        near(of(prism, 0), 4.0 + 2.0 * 2f64.sqrt());
    }

    #[test]
    fn what_is_combined_shows_its_own_surface() {
        let block = |x: f64| Region::inside(Shape::Block { lo: [x, 0.0, 0.0], hi: [x + 0.5, 0.5, 0.5] });
        let both = |shape: fn(Vec<Region>) -> Shape, x: f64| {
            area(&Region::inside(shape(vec![block(0.0), block(x)])).outline(BOX))
        };
        // Apart: two cubes; with nothing in common: none.
        assert!((both(Shape::Union, -0.6) - 3.0).abs() < 1e-9);
        assert_eq!(both(Shape::Intersect, -0.6), 0.0);
    }
}
