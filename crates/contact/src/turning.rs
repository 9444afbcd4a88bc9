//! Rolling and twisting resistance: a spring, a dashpot and a slider for the relative spin.

mod torques;

use super::normal::geometric;
use super::slider::{Memory, Slider, Sync};
use super::tangential::Spring;
use super::{Advance, Ends, Geometry};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, cross, scale};
use perigrain_world::Compat;
pub use torques::{Cdt, Epsd, Epsd2, Grip};

/// Coefficients of a spring-dashpot-slider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sds {
    /// Stiffness [force/length; torque for twisting].
    pub stiffness: f64,
    /// Damping [mass/time; torque·time for twisting].
    pub damping: f64,
    /// Coefficient of friction [–; length for twisting].
    pub mu: f64,
}

impl Sds {
    fn mixed(&self, other: &Sds) -> Sds {
        Sds {
            stiffness: geometric(self.stiffness, other.stiffness),
            damping: geometric(self.damping, other.damping),
            mu: geometric(self.mu, other.mu),
        }
    }
}

/// Rolling resistance: `sds` (Luding 2008) is a pseudo-force between the surfaces that produces torques only; the others are
/// torques against the relative spin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rolling {
    /// `none`.
    #[default]
    None,
    /// `sds k gamma mu`.
    Sds(Sds),
    /// `cdt mu`.
    Cdt(Cdt),
    /// `epsd mu eta`.
    Epsd(Epsd),
    /// `epsd2 mu`.
    Epsd2(Epsd2),
}

/// What a rolling torque depends on apart from the geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn<R> {
    /// Relative spin ω_i − ω_j; of torques on walls times (R − δ/2)/(R − δ).
    pub omega: Vec3<R>,
    /// The normal load for friction.
    pub carried: R,
    /// |F_n| with its dashpot, without cohesion, or with it where that reduces friction.
    pub load: R,
    /// Contact radius, and F_n/δ of the elastic force.
    pub a: R,
    /// See `a`.
    pub secant: R,
    /// The two sides.
    pub ends: Ends<R>,
}

impl Rolling {
    /// The word in decks.
    pub fn name(&self) -> &'static str {
        match self {
            Rolling::None => "none",
            Rolling::Sds(_) => "sds",
            Rolling::Cdt(_) => "cdt",
            Rolling::Epsd(_) => "epsd",
            Rolling::Epsd2(_) => "epsd2",
        }
    }

    /// Whether the spin about the normal counts too (`full`).
    pub fn is_full(&self) -> bool {
        match self {
            Rolling::None | Rolling::Sds(_) => false,
            Rolling::Cdt(c) => c.full,
            Rolling::Epsd(c) => c.full,
            Rolling::Epsd2(c) => c.full,
        }
    }

    /// Whether it is a torque against the spin, not a pseudo-force.
    #[inline(always)]
    pub fn is_torque(&self) -> bool {
        !matches!(self, Rolling::None | Rolling::Sds(_))
    }

    /// Whether it needs the moment of inertia and the side of [`Ends`].
    #[inline(always)]
    pub fn needs_ends(&self) -> bool {
        matches!(self, Rolling::Epsd(_) | Rolling::Epsd2(_))
    }

    /// Whether it needs the contact radius.
    pub fn by_radius(&self) -> bool {
        matches!(self, Rolling::Epsd2(Epsd2 { grip: Grip::ByRadius(_), .. }))
    }

    /// The model between two types whose models are of one kind.
    pub fn mixed(&self, other: &Rolling) -> Rolling {
        match (self, other) {
            (Rolling::Sds(a), Rolling::Sds(b)) => Rolling::Sds(a.mixed(b)),
            (Rolling::Cdt(a), Rolling::Cdt(b)) => Rolling::Cdt(a.mixed(b)),
            (Rolling::Epsd(a), Rolling::Epsd(b)) => Rolling::Epsd(a.mixed(b)),
            (Rolling::Epsd2(a), Rolling::Epsd2(b)) => Rolling::Epsd2(a.mixed(b)),
            _ => Rolling::None,
        }
    }

    /// The same with the tangential stiffness that `epsd2` takes its own from.
    #[must_use]
    pub fn gripping(self, grip: Grip) -> Self {
        match self {
            Rolling::Epsd2(c) => Rolling::Epsd2(Epsd2 { grip, ..c }),
            other => other,
        }
    }

    /// Size of its history: the rolling displacement, or the torque of the spring.
    #[inline(always)]
    pub fn memory(&self) -> usize {
        if matches!(self, Rolling::None | Rolling::Cdt(_)) { 0 } else { 3 }
    }

    /// Stiffness [torque] and damping [torque time]; `a` and `secant` as in [`Turn`].
    pub(crate) fn resistance(&self, g: &Geometry, [a, secant]: [f64; 2], ends: &Ends) -> [f64; 2] {
        let square = g.curvature * g.curvature;
        match self {
            Rolling::None | Rolling::Cdt(_) => [0.0; 2],
            Rolling::Sds(c) => [square * c.stiffness, square * c.damping],
            Rolling::Epsd(c) => c.resistance(g, secant, ends),
            Rolling::Epsd2(c) => [square * c.grip.stiffness(a, secant), 0.0],
        }
    }

    /// The torque on i; the opposite acts on j. That of `sds` is against the rolling velocity R̄ ω × n (Wang et al.
    /// 2015), ω being the relative spin, at most `mu` times the normal load at the arm R̄. `n` as in [`Slider`]; the
    /// direction of the arm is the normal of `g`.
    #[inline(always)]
    pub(crate) fn torque<R: Real>(
        &self,
        g: &Geometry<R>,
        (n, sync): ([Vec3<R>; 2], Sync),
        turn: &Turn<R>,
        history: &mut [R],
        step: Advance,
    ) -> Vec3<R> {
        let Turn { omega, carried, .. } = *turn;
        let c = match self {
            Rolling::None => return [carried.like(0.0); 3],
            Rolling::Sds(c) => c,
            Rolling::Cdt(c) => return c.torque(g, turn),
            Rolling::Epsd(c) => return c.torque(g, turn, history, step),
            Rolling::Epsd2(c) => return c.torque(g, turn, history, step),
        };
        let like = |x: f64| carried.like(x);
        let v = scale(g.curvature, cross(omega, n[0]));
        let slider = Slider {
            n,
            sync: if sync == Sync::Off { sync } else { Sync::Spring },
            stiffness: like(c.stiffness),
            slack: like(c.stiffness),
            damping: like(c.damping),
            capped: false,
            limit: carried * c.mu,
            v,
        };
        let mut xi = [history[0], history[1], history[2]];
        let force = slider.force(&mut xi, Memory::Displacement, step);
        // LAMMPS' setup shortens the friction spring, but not this one.
        if step.history {
            history[..3].copy_from_slice(&xi);
        }
        scale(g.curvature, cross(g.normal, force))
    }
}

/// Twisting resistance about the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Twisting {
    /// `none`.
    #[default]
    None,
    /// `sds k gamma mu`.
    Sds(Sds),
    /// `marshall` (Marshall 2009): k_t a²/2, η_t a²/2 and (2/3) a μ from the tangential model.
    Marshall,
}

impl Twisting {
    /// The word in decks.
    pub fn name(&self) -> &'static str {
        match self {
            Twisting::None => "none",
            Twisting::Sds(_) => "sds",
            Twisting::Marshall => "marshall",
        }
    }

    /// The model between two types whose models are of one kind.
    pub fn mixed(&self, other: &Twisting) -> Twisting {
        match (self, other) {
            (Twisting::Sds(a), Twisting::Sds(b)) => Twisting::Sds(a.mixed(b)),
            _ => *self,
        }
    }

    /// Size of its history: the angle.
    #[inline(always)]
    pub fn memory(&self) -> usize {
        usize::from(*self != Twisting::None)
    }

    /// Stiffness [torque] and damping [torque time]; `a` and `form` as for [`Twisting::torque`].
    pub fn resistance(&self, spring: &Spring, a: f64, form: f64) -> [f64; 2] {
        let half = 0.5 * a * a;
        match self {
            Twisting::None => [0.0; 2],
            Twisting::Sds(c) => [c.stiffness, c.damping],
            Twisting::Marshall => [half * spring.stiffness, half * (form * spring.damping)],
        }
    }

    /// The torque about the normal on i, against the twisting velocity `omega`, at most a friction
    /// coefficient times the normal load `carried`; `a`: contact radius, `form`: normal damping divided by
    /// its constant.
    ///
    /// LAMMPS 22Jul2025 gives a sliding twist the direction of the velocity even where the spring pushes the
    /// other way; `compat` reproduces this.
    #[inline(always)]
    pub fn torque<R: Real>(
        &self,
        spring: &Spring,
        [a, form]: [R; 2],
        omega: R,
        carried: R,
        angle: &mut R,
        step: Advance,
        compat: Compat,
    ) -> R {
        let (zero, one) = (a.like(0.0), a.like(1.0));
        let [stiffness, damping, limit] = match self {
            Twisting::None => return zero,
            Twisting::Sds(c) => [zero.like(c.stiffness), zero.like(c.damping), carried * c.mu],
            Twisting::Marshall => {
                let half = a * a * 0.5;
                [
                    half * spring.stiffness,
                    half * (form * spring.damping),
                    a * (2.0 / 3.0 * spring.mu) * carried,
                ]
            }
        };
        if step.history {
            *angle = *angle + omega * step.dt;
        }
        let trial = -(stiffness * *angle) - damping * omega;
        let slides = trial.abs().above(limit);
        let ask = if compat.lammps() { -omega } else { trial };
        let sign = R::choose(ask.above(zero), one, R::choose(zero.above(ask), -one, zero));
        let sliding = limit * sign;
        let carried = -(sliding + damping * omega) / stiffness;
        *angle = R::choose(R::both(slides, stiffness.above(zero)), carried, *angle);
        R::choose(slides, sliding, trial)
    }
}
