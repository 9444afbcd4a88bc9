//! Adhesion during unloading: Johnson, Kendall & Roberts by the method of dimensionality reduction.

use super::Material;
use super::side::Ellipse;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

/// Surfaces stick at most within this fraction of the largest radius: at the rim of the ellipse the profile
/// is vertical. LAMMPS applies the fraction to the current radius, so that a contact that unloads by less
/// than a hundredth of its radius per step sticks only near its end.
const STUCK: f64 = 0.99;

/// LAMMPS' iteration for the adhesive radius ends when its springs fit within this length.
const COARSE: f64 = 1e-10;

/// Force on a plane at elastic depth `d`, and the contact radius for damping. If the contact `unloads`,
/// springs within the radius `stuck` are glued to the plane until they are longer than √(2π a γ/E_c).
/// `coarse`: with LAMMPS' iteration.
#[inline(always)]
pub fn force<R: Real>(
    m: &Material,
    shape: &Ellipse<R>,
    d: R,
    stuck: &mut R,
    unloads: R::Mask,
    coarse: bool,
) -> (R, R) {
    let (plane, zero) = (m.plane(), d.like(0.0));
    let free = shape.radius(d);
    if m.cohesion == 0.0 {
        *stuck = free;
        return (shape.force(plane, d), free);
    }
    let pressed = if coarse { free * STUCK } else { free.least(shape.b * (0.5 * STUCK)) };
    let before = *stuck;
    let glued = R::both(unloads, before.above(free));
    *stuck = R::choose(glued, before, pressed);
    if !R::any(glued) {
        return (shape.force(plane, d), before);
    }
    let energy = 2.0 * PI * m.cohesion / plane;
    let longer = R::both(glued, zero.above(misfit(shape, d, energy, before)));
    if R::any(longer) {
        let torn = R::choose(longer, d.like(1.0), zero);
        *stuck = R::each_of([torn, shape.a, shape.b, d, *stuck], |[torn, a, b, depth, from]| {
            if torn == 0.0 {
                return from;
            }
            Springs { shape: &Ellipse { a, b }, depth, energy }.last(from, coarse).unwrap_or(0.0)
        });
    }
    let a = *stuck;
    let rim = shape.depth(a);
    let pushed = shape.force(plane, R::choose(glued, rim, d));
    let pulled = R::choose(a.above(zero), pushed + (d - rim) * (2.0 * plane) * a, zero);
    (R::choose(glued, pulled, pushed), R::choose(glued, a, before))
}

/// Energy of the springs at elastic depth `d`, of which those within the radius `stuck` are glued to the
/// plane: U(d_a) + F(d_a) (d − d_a) + E_c a (d − d_a)² if the plane has retracted from d_a, the depth of the
/// rim.
#[inline(always)]
pub fn energy<R: Real>(m: &Material, shape: &Ellipse<R>, d: R, stuck: R) -> R {
    let plane = m.plane();
    let free = shape.energy(plane, d);
    if m.cohesion == 0.0 {
        return free;
    }
    let rim = shape.depth(stuck);
    let back = d - rim;
    let glued = shape.energy(plane, rim) + shape.force(plane, rim) * back + stuck * plane * back * back;
    R::choose(stuck.above(shape.radius(d)), glued, free)
}

/// How much shorter the springs at radius `a` are than their largest length; `energy`: 2π γ/E_c.
#[inline(always)]
fn misfit<R: Real>(shape: &Ellipse<R>, depth: R, energy: f64, a: R) -> R {
    depth - shape.depth(a) + (a * energy).sqrt()
}

/// The springs of an unloading contact.
struct Springs<'a> {
    shape: &'a Ellipse,
    /// Depth of the plane.
    depth: f64,
    /// 2π γ/E_c [length].
    energy: f64,
}

impl Springs<'_> {
    fn misfit(&self, a: f64) -> f64 {
        misfit(self.shape, self.depth, self.energy, a)
    }

    fn slope(&self, a: f64) -> f64 {
        let Ellipse { a: height, b: width } = *self.shape;
        let rise = (0.25 * width * width - a * a).sqrt();
        0.5 * (self.energy / a).sqrt() - height / width * a / rise
    }

    /// The largest radius whose springs still stick, searched from a larger one down; `None` if none does.
    fn last(&self, from: f64, coarse: bool) -> Option<f64> {
        let most = least_radius(self.shape, self.energy);
        if self.misfit(most) < 0.0 {
            return None;
        }
        // Between the maximum of the misfit and `from` it falls ever faster: Newton's steps cannot jump over
        // the root.
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

/// The radius at which a contact tears: the maximum of the springs' misfit, √(2πγ/(E_c a))/2 = (A/B) a/√(B²/4
/// − a²), with `energy` 2πγ/E_c.
pub fn least_radius(shape: &Ellipse, energy: f64) -> f64 {
    let Ellipse { a: height, b: width } = *shape;
    // 4 A² a³ + e B² (a² − B²/4) = 0. The left side grows ever faster: from above, Newton's steps descend to
    // the root. Each of its terms alone bounds the root by the starting value.
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
