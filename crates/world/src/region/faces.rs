//! The nearest points of each shape's surface.

use super::shape::{Shape, across};
use super::surface::{Near, Side};
use perigrain_base::math::triangle;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};

/// Collects places nearer than a reach.
struct Finder<'o> {
    reach: f64,
    out: &'o mut Vec<Near>,
}

impl Finder<'_> {
    fn add(&mut self, part: u32, normal: Vec3, distance: f64, radius: f64) {
        if distance < self.reach {
            self.out.push(Near { part, normal, distance, radius, velocity: [0.0; 3] });
        }
    }

    /// As `add` for the distance vector from the surface; `normal` serves where that is zero.
    fn add_apart(&mut self, part: u32, apart: Vec3, normal: Vec3, radius: f64) {
        let distance = length(apart);
        // Most are far away.
        if distance >= self.reach {
            return;
        }
        let normal = if distance > 0.0 { scale(1.0 / distance, apart) } else { normal };
        self.add(part, normal, distance, radius);
    }
}

impl Shape {
    /// The places of the surface nearer than `reach` to `x`, as seen from `side`: from inside each face counts, from
    /// outside the nearest point of all; faces whose bit is in `open` are not there.
    pub(super) fn faces(&self, x: Vec3, reach: f64, side: Side, open: u8, lammps: bool, out: &mut Vec<Near>) {
        let mut f = Finder { reach, out };
        match self {
            Shape::Block { lo, hi } => block(x, lo, hi, side, open, &mut f),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                let r = Revolved { axis: *axis, center: *center, radius: [*radius; 2], lo: *lo, hi: *hi };
                r.faces(x, side, open, lammps, &mut f);
            }
            Shape::Cone { axis, center, radius, lo, hi } => {
                let r = Revolved { axis: *axis, center: *center, radius: *radius, lo: *lo, hi: *hi };
                r.faces(x, side, open, lammps, &mut f);
            }
            Shape::Sphere { center, radius } => {
                let d = sub(x, *center);
                let r = length(d);
                let away = if r > 0.0 { scale(1.0 / r, d) } else { [1.0, 0.0, 0.0] };
                if r < *radius && side != Side::Outer {
                    f.add(0, scale(-1.0, away), radius - r, -radius);
                } else if r >= *radius && side != Side::Inner {
                    f.add(0, away, r - radius, *radius);
                }
            }
            Shape::Ellipsoid { center, half } => {
                let d = sub(x, *center);
                let within = |by: f64| (0..3).map(|k| (d[k] / (half[k] + by)).powi(2)).sum::<f64>() < 1.0;
                let inside = within(0.0);
                // LAMMPS looks first whether an ellipsoid with half axes longer or shorter by the reach holds the
                // sphere's centre, and misses contacts beside the ends of the axes.
                let missed = lammps && if inside { within(-reach) } else { !within(reach) };
                let seen = !missed && (side == Side::Both || (side == Side::Inner) == inside);
                if seen && half.iter().all(|h| *h > 0.0) {
                    let point = on_ellipsoid(d, *half);
                    let out: Vec3 = std::array::from_fn(|k| point[k] / (half[k] * half[k]));
                    let sign = if inside { -1.0 } else { 1.0 };
                    f.add_apart(0, sub(d, point), scale(sign / length(out), out), 0.0);
                }
            }
            Shape::Plane { point, normal } => {
                let n = scale(1.0 / length(*normal), *normal);
                let height = dot(sub(x, *point), n);
                if height >= 0.0 && side != Side::Outer {
                    f.add(0, n, height, 0.0);
                } else if height <= 0.0 && side != Side::Inner {
                    f.add(0, scale(-1.0, n), -height, 0.0);
                }
            }
            Shape::Prism { lo, hi, tilt } => prism(x, lo, hi, tilt, side, open, &mut f),
            Shape::Mesh(solid) => {
                if side == Side::Both || (side == Side::Inner) == solid.contains(x) {
                    let mut near = vec![];
                    solid.near(x, reach, &mut near);
                    near.iter().for_each(|n| f.add(n.part, n.normal, n.distance, 0.0));
                }
            }
            // Their parts are queried one by one.
            Shape::Union(_) | Shape::Intersect(_) => {}
        }
    }
}

/// The unit vector along `d`, forwards or backwards.
fn unit(d: usize, sign: f64) -> Vec3 {
    let mut e = [0.0; 3];
    e[d] = sign;
    e
}

fn is_open(open: u8, face: usize) -> bool {
    open & (1 << face) != 0
}

/// Faces 0 to 5 from inside: xlo xhi ylo yhi zlo zhi; 6 from outside.
fn block(x: Vec3, lo: &Vec3, hi: &Vec3, side: Side, open: u8, f: &mut Finder) {
    let inside = (0..3).all(|d| x[d] > lo[d] && x[d] < hi[d]);
    if inside {
        if side != Side::Outer {
            for d in 0..3 {
                if !is_open(open, 2 * d) {
                    f.add(2 * d as u32, unit(d, 1.0), x[d] - lo[d], 0.0);
                }
                if !is_open(open, 2 * d + 1) {
                    f.add(2 * d as u32 + 1, unit(d, -1.0), hi[d] - x[d], 0.0);
                }
            }
        }
        return;
    }
    if side == Side::Inner {
        return;
    }
    let clamped: Vec3 = std::array::from_fn(|d| x[d].clamp(lo[d], hi[d]));
    let mut best: Option<(f64, Vec3, Vec3)> = None;
    for face in (0..6).filter(|k| !is_open(open, *k)) {
        let (d, high) = (face / 2, face % 2 == 1);
        let mut apart = sub(x, clamped);
        apart[d] = x[d] - if high { hi[d] } else { lo[d] };
        let square = dot(apart, apart);
        if best.is_none_or(|(b, ..)| square < b) {
            best = Some((square, apart, unit(d, if high { 1.0 } else { -1.0 })));
        }
    }
    if let Some((_, apart, normal)) = best {
        f.add_apart(6, apart, normal, 0.0);
    }
}

/// A cylinder or cone: a line that runs round an axis, closed by two discs.
struct Revolved {
    axis: usize,
    center: [f64; 2],
    radius: [f64; 2],
    lo: f64,
    hi: f64,
}

/// Bits of `open`: the lower and upper end, the mantle.
const MANTLE: usize = 2;

impl Revolved {
    /// Parts: 0 mantle, 1 and 2 lower and upper end from inside, 3 from outside.
    fn faces(&self, x: Vec3, side: Side, open: u8, lammps: bool, f: &mut Finder) {
        let [a, b] = across(self.axis);
        let (da, db, z) = (x[a] - self.center[0], x[b] - self.center[1], x[self.axis]);
        let r = (da * da + db * db).sqrt();
        let away = if r > 0.0 { [da / r, db / r] } else { [1.0, 0.0] };
        // A vector of the half-plane through the sphere's centre, in space.
        let lift = |[dr, dz]: [f64; 2]| {
            let mut v = [0.0; 3];
            (v[a], v[b], v[self.axis]) = (dr * away[0], dr * away[1], dz);
            v
        };
        let [r0, r1] = self.radius;
        let here = if r0 == r1 { r0 } else { r0 + (z - self.lo) * (r1 - r0) / (self.hi - self.lo) };
        let on_mantle = self.on_mantle(r, z);
        let mantle = [r - on_mantle[0], z - on_mantle[1]];
        // Across the mantle, away from the axis.
        let straight = if r0 == r1 {
            [1.0, 0.0]
        } else {
            let slope = [self.hi - self.lo, r0 - r1];
            let size = slope[0].hypot(slope[1]);
            [slope[0] / size, slope[1] / size]
        };
        if r < here && z > self.lo && z < self.hi {
            if side == Side::Outer {
                return;
            }
            if !is_open(open, MANTLE) && (r > 0.0 || !lammps) {
                f.add_apart(0, lift(mantle), lift([-straight[0], -straight[1]]), -2.0 * on_mantle[0]);
            }
            if !is_open(open, 0) {
                f.add(1, unit(self.axis, 1.0), z - self.lo, 0.0);
            }
            if !is_open(open, 1) {
                f.add(2, unit(self.axis, -1.0), self.hi - z, 0.0);
            }
            return;
        }
        if side == Side::Inner {
            return;
        }
        let bent = match (lammps, r0 == r1) {
            (false, _) => 2.0 * on_mantle[0],
            (true, true) if open == 0 => 2.0 * on_mantle[0],
            (true, true) => 0.0,
            // LAMMPS takes cones for hollow from outside too.
            (true, false) => -2.0 * on_mantle[0],
        };
        let disc = |radius: f64, end: f64| [r - r.min(radius), z - end];
        let candidates = [
            (MANTLE, mantle, straight, bent),
            (0, disc(r0, self.lo), [0.0, -1.0], 0.0),
            (1, disc(r1, self.hi), [0.0, 1.0], 0.0),
        ];
        let mut best: Option<([f64; 2], [f64; 2], f64)> = None;
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        for (face, apart, normal, bent) in candidates {
            if !is_open(open, face) && best.is_none_or(|(b, ..)| square(apart) < square(b)) {
                best = Some((apart, normal, bent));
            }
        }
        if let Some((apart, normal, bent)) = best {
            f.add_apart(3, lift(apart), lift(normal), bent);
        }
    }

    /// The nearest point of the mantle's line, as radius and height.
    fn on_mantle(&self, r: f64, z: f64) -> [f64; 2] {
        let [r0, r1] = self.radius;
        if r0 == r1 {
            return [r0, z.clamp(self.lo, self.hi)];
        }
        let (dr, dz) = (r1 - r0, self.hi - self.lo);
        let t = (((r - r0) * dr + (z - self.lo) * dz) / (dr * dr + dz * dz)).clamp(0.0, 1.0);
        [r0 + t * dr, self.lo + t * dz]
    }
}

/// Faces 0 to 5 from inside, as for a block; 6 from outside.
fn prism(x: Vec3, lo: &Vec3, hi: &Vec3, tilt: &Vec3, side: Side, open: u8, f: &mut Finder) {
    let size = sub(*hi, *lo);
    let edges = [[size[0], 0.0, 0.0], [tilt[0], size[1], 0.0], [tilt[1], tilt[2], size[2]]];
    let inward: [Vec3; 3] = std::array::from_fn(|d| {
        let n = cross(edges[(d + 1) % 3], edges[(d + 2) % 3]);
        scale(1.0 / length(n), n)
    });
    let from_low = sub(x, *lo);
    let height = |face: usize| {
        let d = face / 2;
        match face % 2 {
            0 => dot(from_low, inward[d]),
            _ => -dot(sub(from_low, edges[d]), inward[d]),
        }
    };
    let normal = |face: usize| scale(if face.is_multiple_of(2) { 1.0 } else { -1.0 }, inward[face / 2]);
    let closed = (0..6).filter(|k| !is_open(open, *k));
    if (0..6).all(|k| height(k) > 0.0) {
        if side != Side::Outer {
            closed.for_each(|k| f.add(k as u32, normal(k), height(k), 0.0));
        }
        return;
    }
    if side == Side::Inner {
        return;
    }
    let mut best: Option<(f64, Vec3, Vec3)> = None;
    for face in closed {
        let d = face / 2;
        let start = if face.is_multiple_of(2) { *lo } else { add(*lo, edges[d]) };
        let (u, v) = (edges[(d + 1) % 3], edges[(d + 2) % 3]);
        let far = add(start, add(u, v));
        for t in [[start, add(start, u), far], [start, far, add(start, v)]] {
            let apart = sub(x, triangle::nearest(x, &t).0);
            if best.is_none_or(|(b, ..)| dot(apart, apart) < b) {
                best = Some((dot(apart, apart), apart, scale(-1.0, normal(face))));
            }
        }
    }
    if let Some((_, apart, normal)) = best {
        f.add_apart(6, apart, normal, 0.0);
    }
}

/// The point of an ellipsoid about the origin nearest to `d` (Eberly, Distance from a Point to an Ellipsoid): in the
/// octant of positive coordinates, half axes in falling order, the root of a function that falls.
fn on_ellipsoid(d: Vec3, half: Vec3) -> Vec3 {
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| half[*b].total_cmp(&half[*a]));
    let (e, y) = (order.map(|k| half[k]), order.map(|k| d[k].abs()));
    let point = in_octant(e, y);
    let mut out = [0.0; 3];
    for (k, p) in order.into_iter().zip(point) {
        out[k] = p.copysign(d[k]);
    }
    out
}

fn in_octant(e: Vec3, y: Vec3) -> Vec3 {
    if y[2] > 0.0 {
        return on_level(e, y);
    }
    let square = |a: f64, b: f64| a * a - b * b;
    let (span0, span1) = (square(e[0], e[2]), square(e[1], e[2]));
    if e[0] * y[0] < span0 && (e[1] * y[1] < span1 || y[1] == 0.0) {
        let (u, v) = (e[0] * y[0] / span0, if y[1] == 0.0 { 0.0 } else { e[1] * y[1] / span1 });
        let rest = 1.0 - u * u - v * v;
        if rest > 0.0 {
            return [e[0] * u, e[1] * v, e[2] * rest.sqrt()];
        }
    }
    if y[1] > 0.0 {
        return on_level(e, y);
    }
    let span = square(e[0], e[1]);
    if e[0] * y[0] < span {
        let u = e[0] * y[0] / span;
        return [e[0] * u, e[1] * (1.0 - u * u).sqrt(), 0.0];
    }
    [e[0], 0.0, 0.0]
}

/// The nearest point by bisection for the last coordinate that is not zero.
fn on_level(e: Vec3, y: Vec3) -> Vec3 {
    let last = if y[2] > 0.0 { 2 } else { 1 };
    let ratio = e.map(|a| (a / e[last]).powi(2));
    let z: Vec3 = std::array::from_fn(|k| y[k] / e[k]);
    let used = 0..=last;
    let (mut low, mut high) = (z[last] - 1.0, {
        let sum: f64 = used.clone().map(|k| (ratio[k] * z[k]).powi(2)).sum();
        sum.sqrt() - 1.0
    });
    let mut s = 0.5 * (low + high);
    // Each turn halves the bracket; it ends when no number lies between its ends.
    while s > low && s < high {
        let sum: f64 = used.clone().map(|k| (ratio[k] * z[k] / (s + ratio[k])).powi(2)).sum();
        if sum > 1.0 {
            low = s;
        } else {
            high = s;
        }
        s = 0.5 * (low + high);
    }
    std::array::from_fn(|k| if k <= last { ratio[k] * y[k] / (s + ratio[k]) } else { 0.0 })
}
