//! bpm/beam: a bond whose forces and torques derive from an energy.
//!
//! A cylinder of K. Jarolin, M. Dosta, Comput. Part. Mech. 8 (2021), Eq. 1–4, as a potential. With a and b
//! the bond's axis carried by either end, n its direction, l its length and p = (p₀, p⃗) the rotation of the
//! first end relative to the second,
//!
//! U = ½ k_n (l − L)² + ¼ S (|a − n|² + |b − n|²) + ½ B |a − b|² + 2 k_t |p⃗|²,   S = k_s L²,   B = k_b − k_t − S/4,
//!
//! which is stretch, shear, bending and twist: ½ k_s L² |n − ½(a + b)|² + ½ (k_b − ½ k_t) |a − b|² and the
//! remainder of k_t. Momentum and angular momentum are conserved to rounding, and a body in its initial state
//! has exactly zero force. No angles are computed.

use crate::law::{Acts, BondLaw, Ends, Motion};
use crate::stiffness::{Beam, Modes, Shear, Stiffness};
use crate::sweep::{Out, Sweep, all};
use perigrain_base::math::body::{after, back, turned};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use std::f64::consts::PI;

/// Breaking criterion. D. Potyondy, P. Cundall, Int. J. Rock Mech. Min. Sci. 41, 1329 (2004).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Criterion {
    /// Tension and bending together reach one strength, shear and twist the other.
    #[default]
    Sum,
    /// Each of the four alone; tension and bending count only in beams under tension.
    Separate,
}

/// Coefficients of a bond type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coeffs {
    /// Young's modulus [pressure] and Poisson's ratio.
    pub elastic: [f64; 2],
    /// Strength in tension and shear [pressure]; infinite for unbreakable bonds.
    pub strength: [f64; 2],
    /// Weight of bending and twist in the breaking criterion, 0 to 1.
    pub moment: f64,
    /// Damping ratios (fractions of critical damping) of stretch, shear, twist and bending.
    pub damping: [f64; 4],
}

/// Index of a single bond's radius [length]; followed by a factor on both strengths, and the reduced mass and
/// moment of inertia of its ends.
pub const RADIUS: usize = 0;
/// See [`RADIUS`].
pub const FACTOR: usize = 1;
/// See [`RADIUS`].
pub const MASS: usize = 2;
/// See [`RADIUS`].
pub const INERTIA: usize = 3;

/// The law with the options of its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Potential {
    /// Model of the shear stiffness.
    pub shear: Shear,
    /// Breaking criterion.
    pub criterion: Criterion,
    /// Whether forces fade towards breaking by 1 − B⁴; energy is then not conserved.
    pub smooth: bool,
}

/// Stiffnesses and section in lanes.
#[derive(Clone, Copy)]
struct Section<R> {
    area: R,
    normal: R,
    shear: R,
    twist: R,
    bend: R,
}

impl Potential {
    /// The stiffnesses of a bond.
    pub fn stiffness(&self, k: &Coeffs, radius: f64, length: f64) -> Stiffness {
        Beam { young: k.elastic[0], poisson: k.elastic[1], radius, length }.stiffness(self.shear)
    }

    /// Loads of a bond: tension, shear force [force], bending and twisting moments [force length], and the
    /// fraction of its strength used.
    pub fn bears(&self, k: &Coeffs, own: &[f64; 4], b: &Ends<f64>) -> [f64; 5] {
        let c = self.section(k, own[RADIUS], b.length);
        let borne = elastic(&c, b).borne();
        [borne.tension, borne.shear, borne.bend, borne.twist, load(self, k, own, c.area, &borne)]
    }

    /// The fraction of its strength that a bond of this radius and factor uses under a tension, a shear
    /// force, and bending and twisting moments.
    pub fn share(
        &self,
        k: &Coeffs,
        [radius, factor]: [f64; 2],
        [tension, shear, bend, twist]: [f64; 4],
    ) -> f64 {
        let borne = Borne { tension, shear, bend, twist };
        load(self, k, &[radius, factor, 0.0, 0.0], PI * radius * radius, &borne)
    }

    /// [`Beam::stiffness`] for lanes.
    #[inline(always)]
    fn section<R: Real>(&self, k: &Coeffs, radius: R, rest: R) -> Section<R> {
        let [young, poisson] = k.elastic;
        let g = young / (2.0 * (1.0 + poisson));
        let square = radius * radius;
        let area = square * PI;
        let moment = area * square * 0.25;
        let per = rest.like(1.0) / rest;
        let shear = match self.shear {
            Shear::Paper => area * per * g,
            Shear::Timoshenko(kappa) => {
                let slow = rest / (area * (kappa * g));
                rest.like(1.0) / (slow + rest * rest * rest / (moment * (12.0 * young)))
            }
            Shear::None => rest.like(0.0),
        };
        Section {
            area,
            normal: area * per * young,
            shear,
            twist: moment * per * (2.0 * g),
            bend: moment * per * young,
        }
    }
}

/// Results of the energy of a bond.
struct Elastic<R> {
    n: Vec3<R>,
    force: Vec3<R>,
    torque: [Vec3<R>; 2],
    energy: R,
    tension: R,
    shear: R,
    bend: R,
    /// 2 k_t p₀ p⃗ and a + b.
    twist: [Vec3<R>; 2],
}

impl<R: Real> Elastic<R> {
    #[inline(always)]
    fn borne(&self) -> Borne<R> {
        let [twist, both] = self.twist;
        let middle = length(both);
        let there = middle.above(middle.like(0.0));
        let along = dot(twist, both).abs() / R::choose(there, middle, middle.like(1.0));
        let twist = R::choose(there, along, middle.like(0.0));
        Borne { tension: self.tension, shear: self.shear, bend: self.bend, twist }
    }
}

/// Forces and torques: the exact derivatives of the energy.
#[inline(always)]
fn elastic<R: Real>(c: &Section<R>, b: &Ends<R>) -> Elastic<R> {
    let l = length(b.r);
    let per = l.like(1.0) / l;
    let n = scale(per, b.r);
    let s = c.shear * b.length * b.length;
    let mixed = c.bend - c.twist - s * 0.25;

    let a = turned(b.quat[1], b.axis);
    let e = turned(b.quat[0], b.axis);
    let p = after(b.quat[0], back(b.quat[1]));
    let twist = scale(c.twist * p[0] * 2.0, [p[1], p[2], p[3]]);

    let longer = l - b.length;
    let tension = c.normal * longer;
    let (off, other, apart) = (sub(a, n), sub(e, n), sub(a, e));
    let t = add(off, other);
    let t = sub(t, scale(dot(n, t), n));
    let per_length = s * 0.5 * per;
    // a × n and a × b are exactly zero for equal vectors.
    let (half, ab) = (s * 0.5, cross(a, e));
    let second = add(add(scale(half, cross(a, n)), scale(mixed, ab)), twist);
    let first = sub(sub(scale(half, cross(e, n)), scale(mixed, ab)), twist);
    let turn2 = p[1] * p[1] + p[2] * p[2] + p[3] * p[3];
    Elastic {
        n,
        force: sub(scale(per_length, t), scale(tension, n)),
        torque: [first, second],
        energy: tension * longer * 0.5
            + s * 0.25 * (dot(off, off) + dot(other, other))
            + mixed * 0.5 * dot(apart, apart)
            + c.twist * turn2 * 2.0,
        tension,
        shear: per_length * length(t),
        bend: c.bend * length(apart),
        twist: [twist, add(a, e)],
    }
}

/// Forces of a bond of given stiffnesses.
pub struct Pulled {
    /// Force on the first end [force].
    pub force: Vec3,
    /// Torques on both [force length].
    pub torque: [Vec3; 2],
    /// Energies of stretch, shear, bend and twist [energy].
    pub energy: Modes,
}

/// From the same potential: ½ k_n (l − L)², ½ k_s L² |n − ½(a + b)|², ½ k_b |a − b|²; the remainder is twist.
#[inline(always)]
pub fn pulled(k: &Stiffness, b: &Ends<f64>) -> Pulled {
    let Stiffness { normal, shear, twist, bend } = *k;
    let e = elastic(&Section { area: 0.0, normal, shear, twist, bend }, b);
    let off = sub(e.n, scale(0.5, e.twist[1]));
    let stretch = 0.5 * e.tension * (length(b.r) - b.length);
    let sheared = 0.5 * shear * b.length * b.length * dot(off, off);
    let bent = if bend > 0.0 { 0.5 * e.bend * e.bend / bend } else { 0.0 };
    let energy = [stretch, sheared, bent, e.energy - stretch - sheared - bent];
    Pulled { force: e.force, torque: e.torque, energy }
}

/// Loads of a bond [force], [force length].
struct Borne<R> {
    tension: R,
    shear: R,
    bend: R,
    twist: R,
}

/// The fraction of its strength used: N/A + β M_b r/I and Q/A + β M_t r/J, J = 2 I.
#[inline(always)]
fn load<R: Real>(law: &Potential, k: &Coeffs, own: &[R; 4], area: R, b: &Borne<R>) -> R {
    let none = area.like(0.0);
    let per_area = none.like(1.0) / area;
    let per_moment = per_area / own[RADIUS] * k.moment;
    let (tension, bend) = (b.tension * per_area, b.bend * per_moment * 4.0);
    let (shear, twist) = (b.shear * per_area, b.twist * per_moment * 2.0);
    let (normal, across) = match law.criterion {
        Criterion::Sum => (tension + bend, shear + twist),
        Criterion::Separate => {
            let pulled = b.tension.above(none);
            (R::choose(pulled, tension.most(bend), none), shear.most(twist))
        }
    };
    let share = (normal * (1.0 / k.strength[0])).most(across * (1.0 / k.strength[1]));
    (share / own[FACTOR]).most(none)
}

impl BondLaw<4> for Potential {
    type Coeffs = Coeffs;
    const TURNS: bool = true;

    #[inline(always)]
    fn act<R: Real>(&self, k: &Coeffs, own: &[R; 4], b: &Ends<R>, motion: Option<&Motion<R>>) -> Acts<R> {
        let c = self.section(k, own[RADIUS], b.length);
        let elastic = elastic(&c, b);
        let none = c.area.like(0.0);
        let (mut force, mut torque, mut power) = (elastic.force, elastic.torque, none);
        let mut share = none;
        if k.strength[0].is_finite() || k.strength[1].is_finite() {
            share = load(self, k, own, c.area, &elastic.borne());
        }
        if let Some(m) = motion {
            let (drag, slow, heat) = damped(k, own, &c, b.r, elastic.n, m);
            force = sub(force, drag);
            torque = [add(torque[0], slow[0]), add(torque[1], slow[1])];
            power = heat;
        }
        if self.smooth {
            let square = share * share;
            let fade = none.like(1.0) - square * square;
            force = scale(fade, force);
            torque = [scale(fade, torque[0]), scale(fade, torque[1])];
            power = power * fade;
        }
        Acts { force, torque, energy: elastic.energy, load: share, power }
    }

    fn sweep(&self, pass: &Sweep<'_, 4, Coeffs>, out: &mut Out) {
        all(self, pass, out);
    }
}

/// Dashpots c = 2 ζ √(k m) in all four modes, at the middle of the bond: the force they subtract from that on
/// the first end, torques on both, and dissipated power.
#[inline(always)]
fn damped<R: Real>(
    k: &Coeffs,
    own: &[R; 4],
    c: &Section<R>,
    r: Vec3<R>,
    n: Vec3<R>,
    m: &Motion<R>,
) -> (Vec3<R>, [Vec3<R>; 2], R) {
    let half = own[MASS].like(0.5);
    let v = sub(m.v, scale(half, cross(add(m.omega[0], m.omega[1]), r)));
    let along = dot(v, n);
    let across = sub(v, scale(along, n));
    let normal = (c.normal * own[MASS]).sqrt() * (2.0 * k.damping[0]) * along;
    let shear = scale((c.shear * own[MASS]).sqrt() * (2.0 * k.damping[1]), across);
    let turning = sub(m.omega[0], m.omega[1]);
    let about = dot(turning, n);
    let rolling = sub(turning, scale(about, n));
    let twist = (c.twist * own[INERTIA]).sqrt() * (2.0 * k.damping[2]) * about;
    let bend = scale((c.bend * own[INERTIA]).sqrt() * (2.0 * k.damping[3]), rolling);
    let moment = add(scale(twist, n), bend);
    let lever = scale(half, cross(r, shear));
    let power = normal * along + dot(shear, across) + twist * about + dot(bend, rolling);
    (add(scale(normal, n), shear), [sub(lever, moment), add(lever, moment)], power)
}

#[cfg(test)]
mod tests;
