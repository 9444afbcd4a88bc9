//! A spring and a dashpot that slide at a force limit: tangential friction and rolling resistance.

use super::Advance;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, choose, dot, length, scale, sub};

/// Component along the normal, relative to the limit, below which a spring counts as tangential.
const TILT: f64 = 1e-10;

/// The history of a spring, and how it follows the rotating normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// The displacement ξ, rotated into the current tangent plane at constant length (Luding 2008, eq. 17).
    Displacement,
    /// The displacement ξ without its component along the normal (Silbert et al. 2001).
    Projected,
    /// The elastic force −k ξ itself, rotated like a displacement; forces built up at another stiffness are
    /// kept.
    Force,
}

/// Relative tolerance for recognizing a force that slid at the limit: limits are computed from overlaps, and
/// an overlap of a millionth of the radius has only ten correct digits.
pub(super) const KNOWN: f64 = 1e-9;

/// Whether a slider is evaluated for the first time or reproduces an earlier evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// First evaluation.
    First,
    /// Evaluates the spring that an earlier evaluation left behind, in the setup of a run or in a step.
    Again {
        /// Whether that was in a setup, where the spring is not advanced before it acts.
        setup: bool,
    },
}

/// Which normal a spring rotates with (`synchronized_verlet`, Vyas et al. 2025).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// The one at the end of the step.
    Off,
    /// The one in the middle of the step, as for the velocities that advance the spring; then the spring is rotated into the
    /// tangent plane at the end of the step. The dashpot is not rotated.
    Spring,
    /// The same, with the dashpot rotated too.
    Both,
    /// The same, but a sliding spring is shortened by the dashpot before its rotation, as in LAMMPS
    /// 22Jul2025.
    Lammps2025,
}

/// What slides at the limit of friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slip {
    /// Spring and dashpot together: their sum is at most the limit (Luding 2008).
    #[default]
    Whole,
    /// The spring alone: it is cut to the limit, and no dashpot acts in a step in which it slides; the dashpot of
    /// a spring that holds is not limited. Measured with LIGGGHTS 3.8.0 (`gran_tangential_history`).
    Spring,
}

/// Spring, dashpot and limit of one contact in the tangent plane.
#[derive(Clone, Copy, Debug)]
pub struct Slider<R> {
    /// The normal in the middle of the step (for synchronized springs) and at its end.
    pub n: [Vec3<R>; 2],
    /// Which normal the spring rotates with.
    pub sync: Sync,
    /// k [force/length].
    pub stiffness: R,
    /// Stiffness used to shorten a sliding spring: k, except where LAMMPS' error is reproduced.
    pub slack: R,
    /// η [mass/time].
    pub damping: R,
    /// Whether the drag subtracted from a sliding spring is limited along the sliding direction, so that the
    /// spring never pushes in that direction.
    pub capped: bool,
    /// Largest force.
    pub limit: R,
    /// Tangential velocity v.
    pub v: Vec3<R>,
}

impl<R: Real> Slider<R> {
    /// F = −k ξ − η v, at most the limit. Advances `xi` by v dt, and when it slides shortens it to the force
    /// that the slider carries (Luding 2008, eq. 20).
    #[inline(always)]
    pub fn force(&self, xi: &mut Vec3<R>, memory: Memory, step: Advance) -> Vec3<R> {
        let zero = self.limit.like(0.0);
        let v = if step.history { self.advance(xi, memory, step.dt) } else { self.v };
        let drag = scale(-self.damping, v);
        let by_force = memory == Memory::Force;
        let trial = if by_force { add(drag, *xi) } else { sub(drag, scale(self.stiffness, *xi)) };
        let size = length(trial);
        let slides = size.above(self.limit);
        // In lanes some contacts slide and some do not: the branch would cost more than it saves.
        if R::ONE && !R::any(slides) {
            return trial;
        }
        let stretched = dot(*xi, *xi).above(zero);
        // With zero stiffness no displacement carries a force: it is kept.
        let stiff = self.slack.above(zero);
        let slack = R::choose(stiff, self.slack, zero.like(1.0));
        // Both quotients from one division.
        let inverse = zero.like(1.0) / (size * slack);
        let along = slack * inverse;
        let sliding = scale(R::choose(stretched, self.limit * along, zero), trial);
        let unturned = self.sync == Sync::Lammps2025;
        let mut elastic = sub(sliding, if unturned { scale(-self.damping, self.v) } else { drag });
        if self.capped {
            // Along the sliding direction, a drag beyond the limit leaves the spring at rest; across it all
            // of the drag counts, so that a second evaluation gives the same force.
            let beyond = (dot(drag, trial) * along - self.limit).most(zero);
            elastic = add(elastic, scale(beyond * along, trial));
        }
        let (carried, fits) = if by_force {
            (elastic, R::both(slides, stretched))
        } else {
            (scale(-(size * inverse), elastic), R::both(R::both(slides, stretched), stiff))
        };
        *xi = choose::<R>(fits, carried, *xi);
        choose::<R>(slides, sliding, trial)
    }

    /// F = −k ξ − η v while k |ξ| is at most the limit, else −k ξ with ξ cut to the limit ([`Slip::Spring`]). ξ
    /// advances by v dt and loses its component along the normal.
    #[inline(always)]
    pub fn force_of_spring(&self, xi: &mut Vec3<R>, step: Advance) -> Vec3<R> {
        let (zero, one) = (self.limit.like(0.0), self.limit.like(1.0));
        let mut bound = self.limit;
        if step.history {
            let n = self.n[1];
            *xi = add(*xi, scale(zero.like(step.dt), self.v));
            *xi = sub(*xi, scale(dot(*xi, n), n));
        } else {
            // A spring that was cut is recognized when it is evaluated again.
            bound = bound * (1.0 - KNOWN);
        }
        let pull = self.stiffness * length(*xi);
        let slides = pull.above(bound);
        *xi = scale(R::choose(slides, self.limit / pull, one), *xi);
        let drag = R::choose(slides, zero, self.damping);
        sub(scale(-self.stiffness, *xi), scale(drag, self.v))
    }

    /// The force that [`Slider::force`] returned when it left the displacement `xi` behind, if sliding
    /// springs are shortened with another stiffness than k: then −`slack` ξ − η v has the size of the limit.
    #[inline(always)]
    pub fn again(&self, mut xi: Vec3<R>, setup: bool) -> Vec3<R> {
        let zero = self.limit.like(0.0);
        let drag = scale(-self.damping, self.v);
        let sliding = sub(drag, scale(self.slack, xi));
        let off = (length(sliding) - self.limit).abs();
        let parts = length(drag) + self.slack * length(xi) + self.limit;
        let slid = (parts * KNOWN).above(off);
        // All others give the same force twice.
        let other = self.force(&mut xi, Memory::Projected, Advance { dt: 0.0, history: false });
        let felt = choose::<R>(slid, sliding, other);
        if !setup {
            return felt;
        }
        // In a setup, the spring may be the one left by the previous step. Without drag and with a softer
        // spring, a spring that slid does not slide again.
        let [drags, stiffens] = [dot(drag, drag).above(zero), self.stiffness.above(self.slack)];
        choose::<R>(drags, felt, choose::<R>(stiffens, felt, other))
    }

    /// The history, rotated with the normal and advanced; returns the velocity for the dashpot.
    #[inline(always)]
    fn advance(&self, xi: &mut Vec3<R>, memory: Memory, dt: f64) -> Vec3<R> {
        let dt = self.limit.like(dt);
        let [middle, end] = self.n;
        if memory == Memory::Projected {
            *xi = add(*xi, scale(dt, self.v));
            *xi = sub(*xi, scale(dot(*xi, end), end));
            return self.v;
        }
        self.turn(xi, middle, memory);
        let rate = if memory == Memory::Force { -(self.stiffness * dt) } else { dt };
        *xi = add(*xi, scale(rate, self.v));
        if self.sync == Sync::Off {
            return self.v;
        }
        let tilted = self.turn(xi, end, memory);
        if self.sync == Sync::Spring {
            return self.v;
        }
        choose::<R>(tilted, into_plane(self.v, end, dot(self.v, end)), self.v)
    }

    /// Rotates the history into the plane normal to `n` if it is tilted; returns whether it was.
    #[inline(always)]
    fn turn(&self, xi: &mut Vec3<R>, n: Vec3<R>, memory: Memory) -> R::Mask {
        let tilt = dot(*xi, n);
        let force = if memory == Memory::Force { tilt.abs() } else { tilt.abs() * self.stiffness };
        let tilted = force.above(self.limit * TILT);
        if R::any(tilted) {
            *xi = choose::<R>(tilted, into_plane(*xi, n, tilt), *xi);
        }
        tilted
    }
}

/// `xi` without its component `tilt` along `n`, rescaled to its old length.
#[inline(always)]
fn into_plane<R: Real>(xi: Vec3<R>, n: Vec3<R>, tilt: R) -> Vec3<R> {
    let flat = sub(xi, scale(tilt, n));
    let flat_length = length(flat);
    let one = tilt.like(1.0);
    scale(R::choose(flat_length.above(tilt.like(0.0)), length(xi) / flat_length, one), flat)
}
