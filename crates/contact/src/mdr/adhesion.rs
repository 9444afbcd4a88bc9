//! Surfaces that stick while a contact unloads: Johnson, Kendall & Roberts by the method of dimensionality reduction.

use super::Material;
use super::side::Ellipse;
use std::f64::consts::PI;

/// Surfaces stick at most inside this part of the largest radius: at the rim of the ellipse springs are upright. LAMMPS
/// takes this part of the present radius, so that a contact that unloads by less than a hundredth of its radius in each
/// step sticks only near its end.
const STUCK: f64 = 0.99;

/// LAMMPS' iteration for the radius inside which surfaces stick ends when its springs fit within this length.
const COARSE: f64 = 1e-10;

/// Force on a plane at elastic depth `d`, and the radius of contact for damping. Springs inside the radius `stuck` are
/// glued to the plane until they are longer than √(2π a γ/E_c). `coarse`: with LAMMPS' iteration.
pub fn force(
    m: &Material,
    shape: &Ellipse,
    d: f64,
    stuck: &mut f64,
    loads: bool,
    coarse: bool,
) -> (f64, f64) {
    let plane = m.plane();
    let free = shape.radius(d);
    if m.cohesion == 0.0 {
        *stuck = free;
        return (shape.force(plane, d), free);
    }
    if loads || free >= *stuck {
        let pressed = if coarse { STUCK * free } else { free.min(0.5 * STUCK * shape.b) };
        let before = std::mem::replace(stuck, pressed);
        return (shape.force(plane, d), before);
    }
    let springs = Springs { shape, depth: d, energy: 2.0 * PI * m.cohesion / plane };
    if springs.misfit(*stuck) < 0.0 {
        *stuck = springs.last(*stuck, coarse).unwrap_or(0.0);
    }
    let a = *stuck;
    if a == 0.0 {
        return (0.0, 0.0);
    }
    let rim = shape.depth(a);
    (shape.force(plane, rim) + 2.0 * plane * (d - rim) * a, a)
}

/// Energy of the springs at elastic depth `d`, of which those inside the radius `stuck` are glued to the plane:
/// U(d_a) + F(d_a) (d − d_a) + E_c a (d − d_a)² where the plane has gone back from d_a, the depth of the rim.
pub fn energy(m: &Material, shape: &Ellipse, d: f64, stuck: f64) -> f64 {
    let plane = m.plane();
    if m.cohesion == 0.0 || shape.radius(d) >= stuck {
        return shape.energy(plane, d);
    }
    let rim = shape.depth(stuck);
    let back = d - rim;
    shape.energy(plane, rim) + shape.force(plane, rim) * back + plane * stuck * back * back
}

/// The springs of a contact that unloads.
struct Springs<'a> {
    shape: &'a Ellipse,
    /// Depth of the plane.
    depth: f64,
    /// 2π γ/E_c [length].
    energy: f64,
}

impl Springs<'_> {
    /// By how much the springs at radius `a` are shorter than they can be.
    fn misfit(&self, a: f64) -> f64 {
        self.depth - self.shape.depth(a) + (self.energy * a).sqrt()
    }

    fn slope(&self, a: f64) -> f64 {
        let Ellipse { a: height, b: width } = *self.shape;
        let rise = (0.25 * width * width - a * a).sqrt();
        0.5 * (self.energy / a).sqrt() - height / width * a / rise
    }

    /// The largest radius whose springs hold, from a larger one on; `None` where none holds.
    fn last(&self, from: f64, coarse: bool) -> Option<f64> {
        let most = least_radius(self.shape, self.energy);
        if self.misfit(most) < 0.0 {
            return None;
        }
        // Between the summit of the misfit and `from` it falls ever faster: Newton's steps cannot jump over the root.
        let enough = if coarse { COARSE } else { 1e-14 * (self.depth.abs() + self.shape.depth(from).abs()) };
        let mut a = from;
        for _ in 0..100 {
            let f = self.misfit(a);
            if f.abs() < enough {
                break;
            }
            let next = a - f / self.slope(a);
            if next == a || next <= most || next.is_nan() {
                break;
            }
            a = next;
        }
        Some(a)
    }
}

/// The radius at which a contact tears: where the misfit of springs is largest, √(2πγ/(E_c a))/2 = (A/B) a/√(B²/4 − a²), with
/// `energy` 2πγ/E_c.
pub fn least_radius(shape: &Ellipse, energy: f64) -> f64 {
    let Ellipse { a: height, b: width } = *shape;
    // 4 A² a³ + e B² (a² − B²/4) = 0. The left side grows ever faster: from above Newton's steps come down to the root; neither of
    // its terms alone lets it be larger than where they begin.
    let (cubic, square) = (4.0 * height * height, energy * width * width);
    let rim = 0.25 * width * width;
    let mut a = (square * rim / cubic).cbrt().min(0.5 * width);
    for _ in 0..60 {
        let next = a - (cubic * a * a * a + square * (a * a - rim)) / (a * (3.0 * cubic * a + 2.0 * square));
        if next >= a || next.is_nan() {
            break;
        }
        a = next;
    }
    a
}
