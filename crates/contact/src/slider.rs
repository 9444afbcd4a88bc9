//! A spring and a dashpot that slide at a limit: friction across the normal and resistance to rolling.

use super::Advance;
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, choose, dot, length, scale, sub};

/// Component along the normal, relative to the limit, below which a spring counts as tangential.
const TILT: f64 = 1e-10;

/// What a spring remembers, and how that follows the turning normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Memory {
    /// The displacement ξ, turned into the present tangent plane with its length kept (Luding 2008, eq. 17).
    Displacement,
    /// The displacement ξ, of which the component along the normal is dropped (Silbert et al. 2001).
    Projected,
    /// The elastic force −k ξ itself, turned as a displacement; what was built up at another stiffness stays.
    Force,
}

/// How well a force that slid is known again as one of the size of the limit, relative to its parts: limits come from
/// overlaps, and one of a millionth of the radius has only ten good digits.
const KNOWN: f64 = 1e-9;

/// Whether a slider acts, or is looked at after it did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// It acts.
    First,
    /// It has acted and left its spring behind, in the setup of a run or in a step.
    Again {
        /// Whether in a setup, where the spring does not move on before it acts.
        setup: bool,
    },
}

/// Where the normal that turns a spring is from (`synchronized_verlet`, Vyas et al. 2025).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sync {
    /// The end of the step.
    Off,
    /// Its middle, as the velocities that move the spring on; then the spring is turned on into the plane of its end. The dashpot does
    /// not turn.
    Spring,
    /// The same, and the dashpot turns.
    Both,
    /// The same, but what a spring that slides is shortened by is a dashpot that does not turn, as LAMMPS 22Jul2025 has it.
    Lammps2025,
}

/// One contact's spring, dashpot and limit in the tangent plane.
#[derive(Clone, Copy, Debug)]
pub struct Slider<R> {
    /// The normal in the middle of the step (where springs are synchronized) and at its end.
    pub n: [Vec3<R>; 2],
    /// Whether these differ.
    pub sync: Sync,
    /// k [force/length].
    pub stiffness: R,
    /// The stiffness by which a spring that slides is shortened: k, but where LAMMPS is wrong.
    pub slack: R,
    /// η [mass/time].
    pub damping: R,
    /// Whether a spring that slides is rid of no more drag along the sliding than the limit: a spring that must not be set beyond rest.
    pub capped: bool,
    /// The largest force it carries.
    pub limit: R,
    /// The velocity v across the normal that it resists.
    pub v: Vec3<R>,
}

impl<R: Real> Slider<R> {
    /// F = −k ξ − η v, at most the limit; `xi` moves on by v dt and is shortened to what the slider carries when
    /// it slides (Luding 2008, eq. 20).
    #[inline(always)]
    pub fn force(&self, xi: &mut Vec3<R>, memory: Memory, step: Advance) -> Vec3<R> {
        let zero = self.limit.like(0.0);
        let v = if step.history { self.advance(xi, memory, step.dt) } else { self.v };
        let drag = scale(-self.damping, v);
        let by_force = memory == Memory::Force;
        let trial = if by_force { add(drag, *xi) } else { sub(drag, scale(self.stiffness, *xi)) };
        let size = length(trial);
        let slides = size.above(self.limit);
        // In lanes, where now some slide and now none, the branch costs more than what it saves.
        if R::ONE && !R::any(slides) {
            return trial;
        }
        let stretched = dot(*xi, *xi).above(zero);
        // Without stiffness no displacement carries a force: it stays as it is.
        let stiff = self.slack.above(zero);
        let slack = R::choose(stiff, self.slack, zero.like(1.0));
        // Both quotients by one division.
        let inverse = zero.like(1.0) / (size * slack);
        let along = slack * inverse;
        let sliding = scale(R::choose(stretched, self.limit * along, zero), trial);
        let unturned = self.sync == Sync::Lammps2025;
        let mut elastic = sub(sliding, if unturned { scale(-self.damping, self.v) } else { drag });
        if self.capped {
            // Along the sliding direction a drag beyond the limit leaves the spring at rest; across it all of the drag counts, so that
            // what slid gives the same force when it is looked at once more.
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

    /// The force that [`Slider::force`] gave as it left the displacement `xi` behind, where a spring that slides is
    /// shortened by another stiffness than its own: then −`slack` ξ − η v is as large as the limit.
    #[inline(always)]
    pub fn again(&self, mut xi: Vec3<R>, setup: bool) -> Vec3<R> {
        let zero = self.limit.like(0.0);
        let drag = scale(-self.damping, self.v);
        let sliding = sub(drag, scale(self.slack, xi));
        let off = (length(sliding) - self.limit).abs();
        let parts = length(drag) + self.slack * length(xi) + self.limit;
        let slid = (parts * KNOWN).above(off);
        // Any other gives the same force twice.
        let other = self.force(&mut xi, Memory::Projected, Advance { dt: 0.0, history: false });
        let felt = choose::<R>(slid, sliding, other);
        if !setup {
            return felt;
        }
        // In a setup the spring may be what the step before it left. Without a drag and with a softer spring, what slid
        // then does not slide again.
        let [drags, stiffens] = [dot(drag, drag).above(zero), self.stiffness.above(self.slack)];
        choose::<R>(drags, felt, choose::<R>(stiffens, felt, other))
    }

    /// What is remembered, turned with the normal and moved on; the velocity that the dashpot resists.
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

    /// Turns what is remembered into the plane across `n` where it leans out of it; where it does.
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

/// `xi` without its component `tilt` along `n`, at its old length.
#[inline(always)]
fn into_plane<R: Real>(xi: Vec3<R>, n: Vec3<R>, tilt: R) -> Vec3<R> {
    let flat = sub(xi, scale(tilt, n));
    let flat_length = length(flat);
    let one = tilt.like(1.0);
    scale(R::choose(flat_length.above(tilt.like(0.0)), length(xi) / flat_length, one), flat)
}
