//! The force along the normal of one pair of types, and the radius of the area of contact.

use super::Geometry;
use perigrain_base::math::real::Real;
use std::f64::consts::PI;

/// How the force depends on the overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// No force.
    None,
    /// F = k δ.
    Hooke,
    /// F = k a δ, a = √(R̄ δ).
    Hertz,
    /// F = k a δ − 4π γ R̄, a = √(R̄ δ).
    Dmt,
    /// F = k a³/R̄ − 4 a √(π γ E* a), δ = a²/R̄ − 2 √(π γ a/E*), k = (4/3) E*.
    Jkr,
    /// Plastic grains: the contact remembers what [`super::powder`] has found for it.
    Mdr,
}

/// A normal force, ready for contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Its form.
    pub form: Form,
    /// k [pressure; force/length for Hooke].
    pub stiffness: f64,
    /// Surface energy γ [energy/area].
    pub cohesion: f64,
}

/// The force of one contact along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push<R> {
    /// Elastic and cohesive force on i, positive apart.
    pub force: R,
    /// The stiffness that damping models see, k a or k [force/length].
    pub secant: R,
    /// The force needed to pull the grains apart, 0 without cohesion.
    pub pull_off: R,
}

impl Elastic {
    /// The radius of the area of contact.
    #[inline(always)]
    pub fn radius<R: Real>(&self, g: &Geometry<R>) -> R {
        match self.form {
            Form::Jkr => self.jkr_radius(g.curvature, g.overlap),
            _ => (g.curvature * g.overlap).sqrt(),
        }
    }

    /// The force for an area of contact of radius `a`.
    #[inline(always)]
    pub fn push<R: Real>(&self, g: &Geometry<R>, a: R) -> Push<R> {
        let zero = g.overlap.like(0.0);
        let secant = match self.form {
            Form::None | Form::Mdr => zero,
            Form::Hooke => zero.like(self.stiffness),
            Form::Hertz | Form::Dmt | Form::Jkr => a * self.stiffness,
        };
        let plain = Push { force: secant * g.overlap, secant, pull_off: zero };
        match self.form {
            Form::None | Form::Hooke | Form::Hertz | Form::Mdr => plain,
            Form::Dmt => {
                let pull_off = g.curvature * (4.0 * PI * self.cohesion);
                Push { force: plain.force - pull_off, pull_off, ..plain }
            }
            Form::Jkr => {
                let adhesion = a * (a * (PI * self.cohesion * self.young())).sqrt() * 4.0;
                let force = secant * a * a / g.curvature - adhesion;
                Push { force, pull_off: g.curvature * (3.0 * PI * self.cohesion), ..plain }
            }
        }
    }

    /// The energy of an overlap, ∫ F dδ from touch on. With adhesion it is negative at first.
    pub fn energy(&self, g: &Geometry) -> f64 {
        let (k, depth) = (self.stiffness, g.overlap.max(0.0));
        match self.form {
            // What plastic grains give back depends on all that has happened to them.
            Form::None | Form::Mdr => 0.0,
            Form::Hooke => 0.5 * k * depth * depth,
            Form::Hertz => 0.4 * k * (g.curvature * depth).sqrt() * depth * depth,
            Form::Dmt => {
                let pull_off = 4.0 * PI * self.cohesion * g.curvature;
                0.4 * k * (g.curvature * depth).sqrt() * depth * depth - pull_off * g.overlap
            }
            Form::Jkr => {
                // Simpson's rule; the force is smooth in δ but at the tear, where the slope is infinite.
                const PANELS: usize = 64;
                let at = |k: usize| {
                    let overlap = g.overlap * k as f64 / PANELS as f64;
                    let g = Geometry { overlap, ..*g };
                    self.push(&g, self.radius(&g)).force
                };
                let weight = |k: usize| [1.0, 4.0, 2.0][usize::from(k != 0 && k != PANELS) * (2 - k % 2)];
                let sum: f64 = (0..=PANELS).map(|k| weight(k) * at(k)).sum();
                sum * g.overlap / (3 * PANELS) as f64
            }
        }
    }

    /// dF/dδ [force/length].
    pub fn tangent(&self, g: &Geometry) -> f64 {
        let small = 1e-6 * g.overlap.abs();
        if small == 0.0 {
            return if self.form == Form::Hooke { self.stiffness } else { 0.0 };
        }
        // Plastic grains: as stiff as elastic ones of this overlap.
        let form = if self.form == Form::Mdr { Form::Hertz } else { self.form };
        let elastic = Self { form, ..*self };
        let at = |overlap: f64| {
            let g = Geometry { overlap, ..*g };
            elastic.push(&g, elastic.radius(&g)).force
        };
        (at(g.overlap + small) - at(g.overlap - small)) / (2.0 * small)
    }

    /// How far the surfaces of an existing contact come apart before it breaks: −δ where a JKR contact tears under a
    /// given force, a³ = 9π γ R̄²/(4 E*).
    pub fn gap(&self, curvature: f64) -> f64 {
        if self.form != Form::Jkr || self.cohesion == 0.0 {
            return 0.0;
        }
        let e = self.young();
        let a = (9.0 * PI * self.cohesion * curvature * curvature / (4.0 * e)).cbrt();
        2.0 * (PI * self.cohesion * a / e).sqrt() - a * a / curvature
    }

    /// E* [pressure], of models that have one.
    #[inline(always)]
    fn young(&self) -> f64 {
        0.75 * self.stiffness
    }

    /// a(δ), the largest root of δ = a²/R̄ − 2 √(π γ a/E*), in the closed form of Parteli et al. (2014),
    /// doi 10.1038/srep06227, eq. 7.
    #[inline(always)]
    fn jkr_radius<R: Real>(&self, curvature: R, overlap: R) -> R {
        // No closures: they are not inlined into code for wide registers.
        let (e, gamma) = (self.young(), self.cohesion);
        let zero = overlap.like(0.0);
        let depth = curvature * overlap;
        let square = curvature * curvature;
        let attraction = square * square * (gamma * gamma * e);
        let own = attraction * (27.0 * PI * PI);
        let elastic = depth * depth * depth * (8.0 * e * e * e);
        let inner = (attraction * (own + elastic * 2.0)).most(zero).sqrt();
        let cube = (own + elastic + inner * (3.0 * 3.0_f64.sqrt() * PI)).each(f64::cbrt);
        let part = depth * depth * (4.0 * e) / cube + cube / e;
        let first = (depth * 2.0 + part).most(zero).sqrt();
        let last = square * (6.0 * 6.0_f64.sqrt() * gamma * PI / e) / first;
        let a = (first + (depth * 4.0 - part + last).most(zero).sqrt()) / 6.0_f64.sqrt();
        // Without attraction the quotients are 0/0 at first touch.
        R::choose(cube.above(zero), a, depth.most(zero).sqrt())
    }
}
