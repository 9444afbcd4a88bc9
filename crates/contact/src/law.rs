//! The granular law of a pair of types: normal, damping, tangential, rolling and twisting forces of a contact.

use super::normal::{Force, Push};
use super::slider::{Look, Sync};
use super::tangential::{Friction, Spring};
use super::turning::{Rolling, Twisting};
use super::{Advance, Arm, Damping, Geometry, Heat, MOST_MEMORY, Motion, Stored, Wrench, split_velocity};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_world::Compat;

/// The granular contact law of one pair of types (LAMMPS' `pair_style granular`, `gran/*` and walls), F on i from j:
/// F = (F_n − η v_n) n + F_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granular {
    /// Normal force.
    pub normal: Force,
    /// Damping model.
    pub damping: Damping,
    /// Its constant.
    pub damping_constant: f64,
    /// Whether the normal force is never attractive.
    pub limit_damping: bool,
    /// Tangential force.
    pub spring: Spring,
    /// Rolling resistance.
    pub rolling: Rolling,
    /// Twisting resistance.
    pub twisting: Twisting,
    /// Heat conduction.
    pub heat: Heat,
    /// Lever arms of the tangential force.
    pub arm: Arm,
    /// Whether some part needs the contact radius.
    pub(crate) by_radius: bool,
    /// Whether friction also acts while damping makes the normal force attractive at the end of a contact:
    /// LAMMPS uses |F_n| as the normal load.
    pub(crate) rubs_pulling: bool,
    /// The LAMMPS version whose errors are reproduced.
    pub(crate) compat: Compat,
}

/// Normals and velocities of a contact, by integration scheme.
struct Way<R> {
    /// Geometry along which normal forces act.
    acts: Geometry<R>,
    /// Normals for the springs, in the middle of the step and at its end.
    n: [Vec3<R>; 2],
    /// Normal at the end of the step.
    end: Vec3<R>,
    /// Normal velocity.
    v_n: R,
    /// Velocity across the middle normal.
    v_across: Vec3<R>,
}

/// A loop over contacts of one law.
pub(crate) trait Loop {
    /// Runs the loop.
    fn run(self, law: &Granular);
}

/// The law, written once for one contact and for lanes of contacts.
impl Granular {
    /// Numbers in the history of a contact: the tangential spring of i against j, then the rolling
    /// displacement, then the twisting angle, then the history of the normal law. A new contact begins with
    /// zeros. Seen from j the first three have the opposite sign, the others are the same
    /// (`world::contacts::mirror`).
    #[inline(always)]
    pub fn memory(&self) -> usize {
        self.before_normal() + self.normal.memory()
    }

    /// Whether the normal force is computed before the contacts are evaluated and read from their history;
    /// the fast loop does not support this.
    pub fn is_precomputed(&self) -> bool {
        self.normal.is_precomputed()
    }

    /// The largest gap between surfaces before an existing contact ends (cohesion) [length].
    pub fn gap(&self, curvature: f64) -> f64 {
        self.normal.gap(curvature)
    }

    /// Heat flow from the warmer to the colder side per temperature difference [energy/(time temperature)].
    #[inline(always)]
    pub fn conductance<R: Real>(&self, g: &Geometry<R>) -> R {
        if self.heat == Heat::None {
            return g.overlap.like(0.0);
        }
        self.heat.conductance(self.normal.radius(g))
    }

    /// Current normal and tangential stiffness of the contact, dF/dδ and k_t [force/length].
    pub fn springs(&self, g: &Geometry) -> [f64; 2] {
        [self.normal.tangent(g).max(0.0), self.spring.present(self.normal.radius(g))]
    }

    /// Current stiffness and damping of the contact: normal and tangential [force/length, force time/length],
    /// then rolling and twisting [torque, torque time].
    pub fn resistance(&self, g: &Geometry, history: &[f64]) -> [[f64; 4]; 2] {
        let a = self.normal.radius(g);
        let secant = self.normal.push(g, a, &mut self.normal_memory(history)).secant;
        let form = self.damping.form(a, secant, g.mass);
        let finite = |eta: f64| if eta.is_finite() { eta.max(0.0) } else { 0.0 };
        let ([along, across], square) = (self.springs(g), g.curvature * g.curvature);
        let rolling = self.rolling.resistance().map(|k| square * k);
        let twisting = self.twisting.resistance(&self.spring, a, form);
        let dashpots = [self.damping_constant, self.spring.damping].map(|eta| finite(form * eta));
        [
            [along, across, rolling[0], twisting[0]],
            [dashpots[0], dashpots[1], rolling[1], finite(twisting[1])],
        ]
    }

    /// The part of `history` of the normal law, padded with zeros.
    fn normal_memory(&self, history: &[f64]) -> [f64; MOST_MEMORY] {
        let mut memory = [0.0; MOST_MEMORY];
        let own = history.get(self.before_normal()..).unwrap_or(&[]);
        memory.iter_mut().zip(own).for_each(|(to, from)| *to = *from);
        memory
    }

    /// The elastic and cohesive normal force, and, for a dissipative law, the stored energy, else zero.
    pub fn pressing(&self, g: &Geometry, history: &[f64]) -> [f64; 2] {
        let mut memory = self.normal_memory(history);
        let held = if self.normal.flows() { self.normal.energy(g, &memory) } else { 0.0 };
        [self.normal.push(g, self.normal.radius(g), &mut memory).force, held]
    }

    /// The elastic and cohesive normal force of one contact or of lanes; updates `history`.
    #[inline(always)]
    pub(crate) fn push<R: Real>(&self, g: &Geometry<R>, history: &mut [R]) -> R {
        self.normal.push(g, self.normal.radius(g), &mut history[self.before_normal()..]).force
    }

    /// Whether the law dissipates energy apart from damping.
    pub fn flows(&self) -> bool {
        self.normal.flows()
    }

    /// The energy stored in the contact, given its history.
    pub fn stored(&self, g: &Geometry, history: &[f64]) -> Stored {
        let mut memory = self.normal_memory(history);
        let a = self.normal.radius(g);
        let normal = self.normal.energy(g, &memory);
        let push = self.normal.push(g, a, &mut memory).force;
        Stored { push, normal, across: self.spring.energy(a, history), flows: self.normal.flows() }
    }

    /// Force and torques of one contact; updates `history`, [`Granular::memory`] numbers.
    #[inline(always)]
    pub fn contact<R: Real>(
        &self,
        g: &Geometry<R>,
        i: &Motion<R>,
        j: &Motion<R>,
        history: &mut [R],
        step: Advance,
    ) -> Wrench<R> {
        let zero = g.overlap.like(0.0);
        let a = if self.by_radius { self.normal.radius(g) } else { zero };
        let (history, remembered) = history.split_at_mut(self.before_normal());
        let push: Push<R> = self.normal.push(g, a, remembered);
        let form = self.damping.form(a, push.secant, g.mass);

        let (v_n, v_across) = split_velocity(g, i, j);
        let mut way = Way { acts: *g, n: [g.normal; 2], end: g.normal, v_n, v_across };
        if self.spring.sync != Sync::Off {
            way = self.synchronized(g, i, j, step.dt);
        }
        let Way { acts: g, n, end, v_n, v_across } = &way;
        let v_n = *v_n;
        let mut normal_force = push.force - form * self.damping_constant * v_n;
        if self.limit_damping {
            normal_force = normal_force.most(zero);
        }
        let carried = if self.normal.sticks() {
            (push.force + push.hold).abs()
        } else if self.rubs_pulling {
            normal_force.abs()
        } else {
            normal_force.most(zero)
        };

        // Slip of the two surfaces: v_t − (R_i ω_i + R_j ω_j) × n, full radii as in LAMMPS.
        let spin = add(scale(g.radii[0], i.spin), scale(g.radii[1], j.spin));
        let slip = sub(*v_across, cross(spin, n[0]));
        let (own, rest) = history.split_at_mut(self.before_turning());
        let friction = self.spring.force(*n, a, form, slip, carried, own, step);

        let lever = cross(friction, g.normal);
        let mut w = Wrench {
            force: add(scale(normal_force, g.normal), friction),
            torque_i: scale(self.arm(g, 0), lever),
            torque_j: scale(self.arm(g, 1), lever),
        };
        if self.rolling.memory() + self.twisting.memory() > 0 {
            let omega = sub(i.spin, j.spin);
            self.turn(g, [n[0], *end], omega, [a, form, carried], rest, step, &mut w);
        }
        w
    }

    /// Geometry and velocities of a contact with synchronized springs. In the middle of the step, when the
    /// velocities are those given, its normal was along d − ½ v dt (Vyas et al. 2025). Slip is across that
    /// normal, and the spring rotates with it. Forces act along the normal at the particles' current
    /// positions: LAMMPS lets them act along the middle normal as well, which brakes grains that roll around
    /// each other without friction, and gives them angular momentum.
    #[inline(always)]
    fn synchronized<R: Real>(&self, g: &Geometry<R>, i: &Motion<R>, j: &Motion<R>, dt: f64) -> Way<R> {
        let apart = scale(g.radii[0] + g.radii[1] - g.overlap, g.normal);
        let half = scale(g.overlap.like(0.5 * dt), sub(i.velocity, j.velocity));
        let middle = sub(apart, half);
        let middle = scale(g.overlap.like(1.0) / length(middle), middle);
        let then = Geometry { normal: middle, ..*g };
        let (v_then, v_across) = split_velocity(&then, i, j);
        if self.compat.lammps() {
            let classic =
                matches!(self.spring.kind, Friction::LinearHistoryClassic | Friction::MindlinClassic);
            let end = if classic { middle } else { g.normal };
            return Way { acts: then, n: [middle, end], end: g.normal, v_n: v_then, v_across };
        }
        Way { acts: *g, n: [middle, g.normal], end: g.normal, v_n: split_velocity(g, i, j).0, v_across }
    }

    /// Discards the contact radius from which the spring shrinks during unloading: the spring has shrunk
    /// already.
    pub fn keep_shrunk(&self, history: &mut [f64]) {
        if let ([_, _, _, radius, ..], 4) = (history, self.spring.memory()) {
            *radius = 0.0;
        }
    }

    /// The law that reproduces the force of the last evaluation from the history it left behind; `setup`:
    /// that evaluation was in the setup of a run.
    #[must_use]
    pub fn again(&self, setup: bool) -> Self {
        Self { spring: self.spring.again(setup), ..*self }
    }

    /// Runs a loop with this law, with a separate call for each frequent combination of models, so that the
    /// compiler specializes the loop for it.
    #[inline(always)]
    pub(crate) fn within(&self, work: impl Loop) {
        use {Damping::*, Friction::*};
        if let Some(law) = self.known(hertz, Viscoelastic, MindlinClassic, Arm::Radius) {
            return work.run(&law);
        }
        if let Some(law) = self.known(hooke, MassVelocity, LinearHistoryClassic, Arm::Radius) {
            return work.run(&law);
        }
        if let Some(law) = self.known(hertz, Tsuji, Mindlin, Arm::Middle) {
            return work.run(&law);
        }
        work.run(self);
    }
}

/// The force, if it is Hertz'.
#[inline(always)]
fn hertz(force: &Force) -> Option<Force> {
    let Force::Hertz(law) = force else { return None };
    Some(Force::Hertz(*law))
}

/// The force, if it is Hooke's.
#[inline(always)]
fn hooke(force: &Force) -> Option<Force> {
    let Force::Hooke(law) = force else { return None };
    Some(Force::Hooke(*law))
}

impl Granular {
    /// This law, if it has the given models and no resistance to rolling and twisting, in a form in which the
    /// compiler knows the models.
    #[inline(always)]
    fn known(
        &self,
        normal: impl Fn(&Force) -> Option<Force>,
        damping: Damping,
        kind: Friction,
        arm: Arm,
    ) -> Option<Self> {
        let normal = normal(&self.normal)?;
        let plain = self.rolling == Rolling::None && self.twisting == Twisting::None;
        let same = self.damping == damping
            && self.spring.kind == kind
            && self.arm == arm
            && self.spring.look == Look::First
            && self.spring.sync == Sync::Off;
        (same && plain).then_some(Self {
            normal,
            damping,
            spring: Spring { kind, look: Look::First, sync: Sync::Off, ..self.spring },
            rolling: Rolling::None,
            twisting: Twisting::None,
            arm,
            by_radius: kind.by_radius() || normal.by_radius(),
            ..*self
        })
    }

    /// Lever arm of the tangential force about the centre of i (0) or j (1).
    #[inline(always)]
    fn arm<R: Real>(&self, g: &Geometry<R>, k: usize) -> R {
        match self.arm {
            Arm::Middle => g.radii[k] - g.overlap * 0.5,
            Arm::Radius | Arm::Point => g.radii[k],
        }
    }

    /// Index of the rolling displacement in the history.
    pub fn rolls_at(&self) -> Option<usize> {
        (self.rolling.memory() > 0).then(|| self.before_turning())
    }

    /// Number of entries before those of the normal law, which are the same seen from j: at least the three
    /// that are not.
    #[inline(always)]
    fn before_normal(&self) -> usize {
        let own = self.before_turning() + self.rolling.memory() + self.twisting.memory();
        if self.normal.memory() > 0 { own.max(3) } else { own }
    }

    /// Number of entries before those of rolling and twisting, which are the same seen from j: at least the
    /// three that are not.
    #[inline(always)]
    fn before_turning(&self) -> usize {
        let own = self.spring.memory();
        if self.rolling.memory() + self.twisting.memory() > 0 { own.max(3) } else { own }
    }

    /// Adds the torques of rolling and twisting resistance.
    #[inline(always)]
    fn turn<R: Real>(
        &self,
        g: &Geometry<R>,
        n: [Vec3<R>; 2],
        omega: Vec3<R>,
        [a, form, carried]: [R; 3],
        history: &mut [R],
        step: Advance,
        w: &mut Wrench<R>,
    ) {
        let (roll, rest) = history.split_at_mut(self.rolling.memory());
        if self.rolling != Rolling::None {
            let torque = self.rolling.torque(g, (n, self.spring.sync), omega, carried, roll, step);
            w.torque_i = add(w.torque_i, torque);
            w.torque_j = sub(w.torque_j, torque);
        }
        if let Some(angle) = rest.first_mut().filter(|_| self.twisting != Twisting::None) {
            let about = dot(omega, g.normal);
            let size =
                self.twisting.torque(&self.spring, [a, form], about, carried, angle, step, self.compat);
            let torque = scale(size, g.normal);
            w.torque_i = add(w.torque_i, torque);
            w.torque_j = sub(w.torque_j, torque);
        }
    }
}
