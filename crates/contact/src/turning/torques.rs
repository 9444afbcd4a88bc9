//! Rolling resistance by torques against the relative spin: `cdt`, `epsd`, `epsd2` (LIGGGHTS manual, gran_rolling_friction_cdt,
//! …_epsd, …_epsd2; Ai et al. 2011, doi 10.1016/j.powtec.2010.09.030, models A and C). What the manual leaves open is measured
//! with LIGGGHTS 3.8.0.

use super::super::normal::geometric;
use super::super::slider::KNOWN;
use super::super::{Advance, Ends, Geometry};
use super::Turn;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, choose, dot, length, scale, sub};

/// `cdt mu`: a torque of constant size, M = −μ k_n δ R̄ ω_t/|ω|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cdt {
    /// Coefficient of rolling friction.
    pub mu: f64,
    /// Whether the spin about the normal counts too: M = −μ k_n δ R̄ ω/|ω|.
    pub full: bool,
}

/// `epsd mu eta c`: a spring with a dashpot and a limit,
/// M = −k_r ∫ω_t dt − C_r ω_t, with k_r = c k_n μ² R̄² and C_r = 2 η √(I_r k_r).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsd {
    /// Coefficient of rolling friction.
    pub mu: f64,
    /// The part of the critical damping.
    pub eta: f64,
    /// Factor c of the stiffness.
    pub factor: f64,
    /// Whether the spin about the normal counts too.
    pub full: bool,
}

/// `epsd2 mu`: the spring of `epsd` with k_r = k_t R̄², without a dashpot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsd2 {
    /// Coefficient of rolling friction.
    pub mu: f64,
    /// Whether the spin about the normal counts too.
    pub full: bool,
    /// k_t.
    pub grip: Grip,
}

/// A tangential stiffness k_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grip {
    /// k_t itself [force/length].
    Is(f64),
    /// k_t divided by the contact radius [pressure].
    ByRadius(f64),
    /// k_t divided by F_n/δ.
    OfNormal(f64),
}

impl Grip {
    /// k_t at contact radius `a` and normal stiffness `secant` [force/length].
    #[inline(always)]
    pub fn stiffness<R: Real>(&self, a: R, secant: R) -> R {
        match *self {
            Grip::Is(k) => a.like(k),
            Grip::ByRadius(k) => a * k,
            Grip::OfNormal(k) => secant * k,
        }
    }
}

impl Cdt {
    pub(super) fn mixed(&self, other: &Self) -> Self {
        Self { mu: geometric(self.mu, other.mu), full: self.full }
    }

    #[inline(always)]
    pub(super) fn torque<R: Real>(&self, g: &Geometry<R>, turn: &Turn<R>) -> Vec3<R> {
        let zero = turn.load.like(0.0);
        let speed = length(turn.omega);
        let most = turn.secant * g.overlap.most(zero) * g.curvature * self.mu;
        let size = R::choose(speed.above(zero), most / speed, zero);
        scale(-size, counted(turn.omega, g.normal, self.full))
    }
}

impl Epsd {
    pub(super) fn mixed(&self, other: &Self) -> Self {
        Self {
            mu: geometric(self.mu, other.mu),
            eta: geometric(self.eta, other.eta),
            factor: geometric(self.factor, other.factor),
            full: self.full,
        }
    }

    #[inline(always)]
    fn stiffness<R: Real>(&self, g: &Geometry<R>, secant: R) -> R {
        secant * (g.curvature * g.curvature) * (self.factor * self.mu * self.mu)
    }

    #[inline(always)]
    fn damping<R: Real>(&self, stiffness: R, ends: &Ends<R>) -> R {
        (ends.inertia * stiffness).sqrt() * (2.0 * self.eta)
    }

    pub(super) fn resistance(&self, g: &Geometry, secant: f64, ends: &Ends) -> [f64; 2] {
        let stiffness = self.stiffness(g, secant);
        [stiffness, self.damping(stiffness, ends)]
    }

    #[inline(always)]
    pub(super) fn torque<R: Real>(
        &self,
        g: &Geometry<R>,
        turn: &Turn<R>,
        history: &mut [R],
        step: Advance,
    ) -> Vec3<R> {
        let stiffness = self.stiffness(g, turn.secant);
        let damping = self.damping(stiffness, &turn.ends);
        let limit = turn.load * g.curvature * self.mu;
        spring(turn, counted(turn.omega, g.normal, self.full), [stiffness, damping, limit], history, step)
    }
}

impl Epsd2 {
    pub(super) fn mixed(&self, other: &Self) -> Self {
        Self { mu: geometric(self.mu, other.mu), ..*self }
    }

    #[inline(always)]
    pub(super) fn torque<R: Real>(
        &self,
        g: &Geometry<R>,
        turn: &Turn<R>,
        history: &mut [R],
        step: Advance,
    ) -> Vec3<R> {
        let stiffness = self.grip.stiffness(turn.a, turn.secant) * (g.curvature * g.curvature);
        let limit = turn.load * g.curvature * self.mu;
        let none = limit.like(0.0);
        spring(turn, counted(turn.omega, g.normal, self.full), [stiffness, none, limit], history, step)
    }
}

/// The spin that counts: all of it, or its part across the normal.
#[inline(always)]
fn counted<R: Real>(omega: Vec3<R>, n: Vec3<R>, full: bool) -> Vec3<R> {
    if full { omega } else { sub(omega, scale(dot(omega, n), n)) }
}

/// The torque of a spring, which is the history, and a dashpot: the spring is cut at the limit, where no dashpot acts. The torque
/// keeps its direction in space when the normal turns. It is stored as that on the grain with the smaller tag.
#[inline(always)]
fn spring<R: Real>(
    turn: &Turn<R>,
    omega: Vec3<R>,
    [stiffness, damping, limit]: [R; 3],
    history: &mut [R],
    step: Advance,
) -> Vec3<R> {
    let one = limit.like(1.0);
    let mut moment = scale(turn.ends.side, [history[0], history[1], history[2]]);
    let mut bound = limit;
    if step.history {
        moment = sub(moment, scale(stiffness * step.dt, omega));
    } else {
        // A torque that was cut is recognized when it is evaluated again.
        bound = bound * (1.0 - KNOWN);
    }
    let size = length(moment);
    let slides = size.above(bound);
    moment = scale(R::choose(slides, limit / size, one), moment);
    history[..3].copy_from_slice(&scale(turn.ends.side, moment));
    choose::<R>(slides, moment, sub(moment, scale(damping, omega)))
}
