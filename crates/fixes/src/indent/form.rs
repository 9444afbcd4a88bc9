//! Shapes of indenters: as declared, at one moment, and the forces they exert.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_styles::Reading;
use perigrain_styles::common::orthogonal;
use perigrain_world::region::across;
use perigrain_world::{Domain, World};

/// The indenter as declared; `T` is a parameter in the deck and a reading during a run.
#[derive(Clone, Copy)]
pub enum Form<T> {
    /// Around a point.
    Sphere { center: [T; 3], radius: T },
    /// Around an axis, without ends.
    Cylinder { axis: usize, center: [T; 2], radius: T },
    /// Between two discs on an axis, from `ends[0]` to `ends[1]`.
    Cone { axis: usize, center: [T; 2], radii: [T; 2], ends: [T; 2] },
    /// A half-space.
    Plane { axis: usize, place: T, high: bool },
}

impl<T> Form<T> {
    /// The same shape with other numbers; the second argument of `change` is the axis of the lattice spacing.
    pub fn map<U>(&self, mut change: impl FnMut(&T, usize) -> Result<U>) -> Result<Form<U>> {
        Ok(match self {
            Form::Sphere { center: [x, y, z], radius } => Form::Sphere {
                center: [change(x, 0)?, change(y, 1)?, change(z, 2)?],
                radius: change(radius, 0)?,
            },
            Form::Cylinder { axis, center: [a, b], radius } => {
                let [d, e] = across(*axis);
                Form::Cylinder {
                    axis: *axis,
                    center: [change(a, d)?, change(b, e)?],
                    radius: change(radius, 0)?,
                }
            }
            Form::Cone { axis, center: [a, b], radii: [r, s], ends: [lo, hi] } => {
                let [d, e] = across(*axis);
                Form::Cone {
                    axis: *axis,
                    center: [change(a, d)?, change(b, e)?],
                    radii: [change(r, *axis)?, change(s, *axis)?],
                    ends: [change(lo, *axis)?, change(hi, *axis)?],
                }
            }
            Form::Plane { axis, place, high } => {
                Form::Plane { axis: *axis, place: change(place, *axis)?, high: *high }
            }
        })
    }
}

/// The indenter at one moment.
#[derive(Clone, Copy)]
pub enum Body {
    /// Sphere or cylinder: distances count along the axes with factor 1.
    Round { center: [f64; 3], along: [f64; 3], radius: f64 },
    /// Cone around the midpoint of its axis, which reaches `half` to either side.
    Tapered { middle: [f64; 3], axis: usize, half: f64, radii: [f64; 2] },
    /// A half-space.
    Flat { axis: usize, place: f64, high: bool },
}

impl Form<Reading> {
    /// The indenter in this step, wrapped into a periodic box.
    pub fn present(&self, w: &World) -> Result<Body> {
        let wrapped = |mut x: [f64; 3]| {
            if let Some(d) = &*w.domain {
                d.wrap(&mut x, &mut [0; 3]);
            }
            x
        };
        let round = |radius: f64| {
            if radius < 0.0 {
                return fail(Code::BAD_VALUE, None, format!("the indenter's radius is negative: {radius}"));
            }
            Ok(radius)
        };
        let tapered = matches!(self, Form::Cylinder { .. } | Form::Cone { .. });
        if tapered && w.tilted() {
            // Its axis spans the box, and would be displaced from one image to the next.
            return Err(orthogonal("a cylinder or cone of fix indent"));
        }
        Ok(match self {
            Form::Plane { axis, place, high } => Body::Flat { axis: *axis, place: place.get(w), high: *high },
            Form::Sphere { center, radius } => {
                let center = wrapped(center.map(|c| c.get(w)));
                Body::Round { center, along: [1.0; 3], radius: round(radius.get(w))? }
            }
            Form::Cylinder { axis, center: [a, b], radius } => {
                let [d, e] = across(*axis);
                let (mut center, mut along) = (w.domain()?.lo, [1.0; 3]);
                (center[d], center[e], along[*axis]) = (a.get(w), b.get(w), 0.0);
                Body::Round { center: wrapped(center), along, radius: round(radius.get(w))? }
            }
            Form::Cone { axis, center: [a, b], radii: [r, s], ends: [lo, hi] } => {
                let [d, e] = across(*axis);
                let (lo, hi) = (lo.get(w), hi.get(w));
                check_ends(lo, hi)?;
                let mut middle = [0.5 * (lo + hi); 3];
                (middle[d], middle[e]) = (a.get(w), b.get(w));
                let radii = [round(r.get(w))?, round(s.get(w))?];
                Body::Tapered { middle: wrapped(middle), axis: *axis, half: 0.5 * (hi - lo), radii }
            }
        })
    }
}

/// Checks that the ends of a cone are in order.
///
/// # Errors
/// Ends in the wrong order.
pub fn check_ends(lo: f64, hi: f64) -> Result<()> {
    if lo < hi {
        return Ok(());
    }
    fail(Code::BAD_VALUE, None, format!("the cone must end behind its beginning: {hi} is not beyond {lo}"))
}

/// The point of the segment from `a` to `b` that is nearest to `p`.
fn nearest(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let d = [b[0] - a[0], b[1] - a[1]];
    let square = d[0] * d[0] + d[1] * d[1];
    let share = if square > 0.0 { ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    [a[0] + share * d[0], a[1] + share * d[1]]
}

/// The vector from `p` (distance from the axis, position along it from the middle) to the nearest point of a
/// cone's surface.
fn way_out(p: [f64; 2], half: f64, radii: [f64; 2]) -> [f64; 2] {
    let [low, high] = [[radii[0], -half], [radii[1], half]];
    let sides = [nearest(p, low, high), nearest(p, [0.0, -half], low), nearest(p, [0.0, half], high)];
    let ways = sides.map(|q| [q[0] - p[0], q[1] - p[1]]);
    let square = |way: &[f64; 2]| way[0] * way[0] + way[1] * way[1];
    ways.into_iter().min_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default()
}

/// If the square of a distance exceeds that of a length by this factor, the distance is longer despite
/// rounding.
const BEYOND: f64 = 1.0 + 1e-9;

impl Body {
    /// Force on a particle at `x` and its energy: K (r − R)² outwards (inwards for `inside`) and K/3 |r −
    /// R|³. The nearest image in `repeats` counts, which is the box if it is periodic in any direction.
    #[inline]
    pub fn push(
        &self,
        repeats: Option<&Domain>,
        x: [f64; 3],
        k: f64,
        inside: bool,
        lammps: bool,
    ) -> Option<([f64; 3], f64)> {
        let image = |apart| repeats.map_or(apart, |b| b.minimum_image(apart));
        match *self {
            Body::Flat { axis, place, high } => {
                let sign = if high { 1.0 } else { -1.0 };
                let depth = sign * (place - x[axis]);
                if depth >= 0.0 {
                    return None;
                }
                let mut f = [0.0; 3];
                f[axis] = -sign * k * depth * depth;
                Some((f, -(k / 3.0 * depth * depth * depth)))
            }
            Body::Round { center, along, radius } => {
                let d: [f64; 3] = image(std::array::from_fn(|d| along[d] * (x[d] - center[d])));
                let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                // Most particles are so far away that the square alone decides.
                if !inside && square > BEYOND * radius * radius {
                    return None;
                }
                let r = square.sqrt();
                let depth = if inside { radius - r } else { r - radius };
                if depth >= 0.0 {
                    return None;
                }
                let size = if inside { -k * depth * depth } else { k * depth * depth };
                // Exactly at the centre the direction is undefined.
                let force = if r > 0.0 { d.map(|d| d * size / r) } else { [0.0; 3] };
                Some((force, -(k / 3.0 * depth * depth * depth)))
            }
            Body::Tapered { middle, axis, half, radii } => {
                let d = image(std::array::from_fn(|d| x[d] - middle[d]));
                tapered(d, axis, half, radii, inside).map(|way| pushed(d, way, k, inside, lammps))
            }
        }
    }
}

/// The vector to a cone's surface from a position relative to its middle; `None` where the cone does not act.
fn tapered(d: [f64; 3], axis: usize, half: f64, radii: [f64; 2], inside: bool) -> Option<[f64; 3]> {
    let [a, b] = across(axis);
    let (rho, z) = (d[a].hypot(d[b]), d[axis]);
    let radius = radii[0] + (radii[1] - radii[0]) * (z + half) / (2.0 * half);
    let within = z.abs() <= half && rho <= radius;
    if within == inside {
        return None;
    }
    let [out, along] = way_out([rho, z], half, radii);
    let mut way = [0.0; 3];
    way[axis] = along;
    // Exactly on the axis the direction is undefined.
    let share = if rho > 0.0 { out / rho } else { 0.0 };
    (way[a], way[b]) = (share * d[a], share * d[b]);
    Some(way)
}

/// Force and energy for a particle at `d` from a cone's middle with the vector `way` to the surface. In
/// LAMMPS the forces point towards or away from the middle, and the energies are negative.
fn pushed(d: [f64; 3], way: [f64; 3], k: f64, inside: bool, lammps: bool) -> ([f64; 3], f64) {
    let size = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let depth = size(way);
    let energy = k / 3.0 * depth * depth * depth;
    if !lammps {
        return (way.map(|c| c * k * depth), energy);
    }
    let (sign, r) = (if inside { -1.0 } else { 1.0 }, size(d));
    let force = if r > 0.0 { d.map(|c| sign * c * k * depth * depth / r) } else { [0.0; 3] };
    (force, -energy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_face_of_a_cone() {
        // From radius 1 at z = -2 to radius 4 at z = 2: the side has slope 3/4.
        let way = |d: [f64; 3], inside: bool| tapered(d, 2, 2.0, [1.0, 4.0], inside);
        assert_eq!(way([0.0, 0.5, -1.75], false), Some([0.0, 0.0, -0.25]));
        assert_eq!(way([0.5, 0.0, 1.5], false), Some([0.0, 0.0, 0.5]));
        // On the side at (2.5, 0); inwards by 1: (2.5 - 0.8, 0.6).
        let [x, y, z] = way([0.0, 1.7, 0.6], false).unwrap();
        assert!(x == 0.0 && (y - 0.8).abs() < 1e-15 && (z + 0.6).abs() < 1e-15, "{x} {y} {z}");
        let [x, _, z] = way([3.3, 0.0, -0.6], true).unwrap();
        assert!((x + 0.8).abs() < 1e-15 && (z - 0.6).abs() < 1e-15, "{x} {z}");
        assert_eq!(way([0.0, 0.0, 5.0], true), Some([0.0, 0.0, -3.0]));
        assert_eq!((way([0.0, 0.0, 5.0], false), way([0.0, 1.0, 1.0], true)), (None, None));
    }

    /// The force is the gradient of the energy, unlike in LAMMPS.
    #[test]
    fn a_cone_conserves_energy() {
        let energy = |d: [f64; 3]| {
            tapered(d, 0, 1.5, [0.0, 2.0], false).map_or(0.0, |way| pushed(d, way, 7.0, false, false).1)
        };
        for d in [[0.3, 0.2, -0.4], [1.2, 0.5, 0.9], [-0.7, 0.05, 0.2], [1.4, 0.1, 0.0]] {
            let way = tapered(d, 0, 1.5, [0.0, 2.0], false).unwrap();
            let (force, _) = pushed(d, way, 7.0, false, false);
            for k in 0..3 {
                let h = 1e-5;
                let [mut a, mut b] = [d, d];
                (a[k], b[k]) = (d[k] - h, d[k] + h);
                let slope = (energy(a) - energy(b)) / (2.0 * h);
                assert!((slope - force[k]).abs() < 1e-8, "{d:?} {k}: {slope} {}", force[k]);
            }
        }
    }
}
