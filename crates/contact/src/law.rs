//! The granular law of a pair of types: normal, damping, tangential, rolling and twisting forces of a contact.

mod known;

use super::normal::{Force, Push};
use super::slider::{Slip, Sync};
use super::tangential::{Friction, Spring};
use super::turning::{Rolling, Turn, Twisting};
use super::{
    Advance, Arm, Cohesion, Damping, Ends, Geometry, Heat, MOST_MEMORY, Motion, Stored, Wrench,
    split_velocity,
};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, add, choose, cross, dot, length, scale, sub};
use perigrain_world::Compat;

/// The granular contact law of one pair of types (LAMMPS' `pair_style granular`, `gran/*` and walls), F on i from j:
/// F = (F_n − η v_n − k A) n + F_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granular {
    /// Normal force.
    pub normal: Force,
    /// Damping model.
    pub damping: Damping,
    /// Its constant.
    pub damping_constant: f64,
    /// Whether the normal force without cohesion is never attractive.
    pub limit_damping: bool,
    /// Tangential force.
    pub spring: Spring,
    /// Rolling resistance.
    pub rolling: Rolling,
    /// Twisting resistance.
    pub twisting: Twisting,
    /// Cohesion by the area of contact, added to the limited normal force.
    pub cohesion: Cohesion,
    /// Heat conduction.
    pub heat: Heat,
    /// Lever arms of the tangential force.
    pub arm: Arm,
    /// Whether some part needs the contact radius.
    pub(crate) by_radius: bool,
    /// Whether the second side is a wall.
    pub(crate) is_on_wall: bool,
    /// Whether friction also acts while damping makes the normal force attractive at the end of a contact:
    /// LAMMPS and `slip spring` use |F_n| as the normal load.
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
        self.normal.gap(curvature).max(self.cohesion.gap())
    }

    /// The geometry for what acts between surfaces that touch, where cohesion spans a gap between them.
    #[inline(always)]
    fn touching<R: Real>(&self, g: &Geometry<R>) -> Geometry<R> {
        match self.cohesion.spans() {
            true => Geometry { overlap: g.overlap.most(g.overlap.like(0.0)), ..*g },
            false => *g,
        }
    }

    /// Heat flow from the warmer to the colder side per temperature difference [energy/(time temperature)].
    #[inline(always)]
    pub fn conductance<R: Real>(&self, g: &Geometry<R>) -> R {
        if self.heat == Heat::None {
            return g.overlap.like(0.0);
        }
        let g = &self.touching(g);
        self.heat.conductance(g, self.normal.radius(g), self.is_on_wall)
    }

    /// The law for contacts with walls: what depends on the second side treats it as flat and at rest. Lever arms
    /// are those of `arm`.
    #[must_use]
    pub fn on_wall(&self) -> Self {
        Self { is_on_wall: true, ..*self }
    }

    /// Whether [`Granular::contact_of`] needs [`Ends`] of grains.
    #[inline(always)]
    pub fn needs_ends(&self) -> bool {
        self.rolling.needs_ends() && !self.is_on_wall
    }

    /// Current normal and tangential stiffness of the contact, dF/dδ and k_t [force/length].
    pub fn springs(&self, g: &Geometry) -> [f64; 2] {
        if g.overlap < 0.0 && self.cohesion.spans() {
            return [0.0; 2];
        }
        let a = self.normal.radius(g);
        let secant = self.normal.push(g, a, &mut [0.0; MOST_MEMORY]).secant;
        [self.normal.tangent(g).max(0.0), self.spring.present(a, secant)]
    }

    /// Current stiffness and damping of the contact: normal and tangential [force/length, force time/length],
    /// then rolling and twisting [torque, torque time].
    pub fn resistance(&self, g: &Geometry, history: &[f64]) -> [[f64; 4]; 2] {
        if g.overlap < 0.0 && self.cohesion.spans() {
            return [[0.0; 4]; 2];
        }
        let a = self.normal.radius(g);
        let secant = self.normal.push(g, a, &mut self.normal_memory(history)).secant;
        let form = self.damping.form(a, secant, g.mass);
        let finite = |eta: f64| if eta.is_finite() { eta.max(0.0) } else { 0.0 };
        let [along, across] = [self.normal.tangent(g).max(0.0), self.spring.present(a, secant)];
        let rolling = self.rolling.resistance(g, [a, secant], &Ends::of(g));
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
        let touching = self.touching(g);
        let flows = self.flows();
        let held = if flows { self.normal.energy(&touching, &memory) } else { 0.0 };
        let force = self.normal.push(&touching, self.normal.radius(&touching), &mut memory).force;
        let won = if flows { self.cohesion.energy(g, self.is_on_wall) } else { 0.0 };
        [force - self.cohesion.pull(g, self.is_on_wall), held - won]
    }

    /// The elastic and cohesive normal force of one contact or of lanes; updates `history`.
    #[inline(always)]
    pub(crate) fn push<R: Real>(&self, g: &Geometry<R>, history: &mut [R]) -> R {
        let touching = self.touching(g);
        let own = &mut history[self.before_normal()..];
        let force = self.normal.push(&touching, self.normal.radius(&touching), own).force;
        if self.cohesion == Cohesion::None { force } else { force - self.cohesion.pull(g, self.is_on_wall) }
    }

    /// Whether the law dissipates energy apart from damping: plastic flow, or bridges that rupture.
    pub fn flows(&self) -> bool {
        self.normal.flows() || self.cohesion.spans()
    }

    /// The energy stored in the contact, given its history.
    pub fn stored(&self, g: &Geometry, history: &[f64]) -> Stored {
        let mut memory = self.normal_memory(history);
        let touching = self.touching(g);
        let a = self.normal.radius(&touching);
        let normal = self.normal.energy(&touching, &memory) - self.cohesion.energy(g, self.is_on_wall);
        let Push { force, secant, .. } = self.normal.push(&touching, a, &mut memory);
        let push = force - self.cohesion.pull(g, self.is_on_wall);
        let across = self.spring.energy(self.spring.present(a, secant), history);
        Stored { push, normal, across, flows: self.flows() }
    }

    /// Force and torques of one contact; updates `history`, [`Granular::memory`] numbers. For grains whose law
    /// [needs their ends](Granular::needs_ends) these are taken from the geometry: exact for equal densities.
    pub fn contact(
        &self,
        g: &Geometry,
        i: &Motion,
        j: &Motion,
        history: &mut [f64],
        step: Advance,
    ) -> Wrench {
        self.contact_of(g, [i, j], Ends::of(g), history, step)
    }

    /// The same for one contact or for lanes, with the two [`Ends`]; of walls and where they are not needed these
    /// may be anything.
    #[inline(always)]
    pub fn contact_of<R: Real>(
        &self,
        g: &Geometry<R>,
        [i, j]: [&Motion<R>; 2],
        ends: Ends<R>,
        history: &mut [R],
        step: Advance,
    ) -> Wrench<R> {
        // By reference: a copy would take registers from all other laws.
        let across;
        let near = if self.cohesion.spans() {
            across = self.touching(g);
            &across
        } else {
            g
        };
        let mut w = self.touched(near, [i, j], ends, history, step);
        if self.cohesion.spans() {
            // Across a gap nothing but the bridge acts, and histories end.
            let zero = g.overlap.like(0.0);
            let touches = g.overlap.above(zero);
            for number in history {
                *number = R::choose(touches, *number, zero);
            }
            for part in [&mut w.force, &mut w.torque_i, &mut w.torque_j] {
                *part = choose::<R>(touches, *part, [zero; 3]);
            }
            w.force = sub(w.force, scale(self.cohesion.pull(g, self.is_on_wall), g.normal));
        }
        w
    }

    /// [`Granular::contact_of`] for surfaces that touch; without the pull of a bridge.
    #[inline(always)]
    fn touched<R: Real>(
        &self,
        g: &Geometry<R>,
        [i, j]: [&Motion<R>; 2],
        ends: Ends<R>,
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
        let mut carried = if self.normal.sticks() {
            (push.force + push.hold).abs()
        } else if self.rubs_pulling {
            normal_force.abs()
        } else {
            normal_force.most(zero)
        };
        let mut load = normal_force;
        if self.cohesion != Cohesion::None && !self.cohesion.spans() {
            normal_force = normal_force - self.cohesion.pull(g, self.is_on_wall);
            if self.cohesion.reduces() {
                carried = normal_force.abs();
                load = normal_force;
            }
        }

        // Slip of the two surfaces: v_t − (R_i ω_i + R_j ω_j) × n, full radii as in LAMMPS.
        let arms = if self.spring.slip == Slip::Spring { [self.arm(g, 0), self.arm(g, 1)] } else { g.radii };
        let spin = add(scale(arms[0], i.spin), scale(arms[1], j.spin));
        let slip = sub(*v_across, cross(spin, n[0]));
        let (own, rest) = history.split_at_mut(self.before_turning());
        let friction = self.spring.force(*n, [a, form, push.secant], slip, carried, own, step);

        let lever = cross(friction, g.normal);
        let mut w = Wrench {
            force: add(scale(normal_force, g.normal), friction),
            torque_i: scale(self.arm(g, 0), lever),
            torque_j: scale(self.arm(g, 1), lever),
        };
        if self.rolling != Rolling::None || self.twisting != Twisting::None {
            let omega = sub(i.spin, j.spin);
            let ends = if self.is_on_wall { Ends::on_wall(g) } else { ends };
            let turn = Turn { omega, carried, load: load.abs(), a, secant: push.secant, ends };
            self.turn(g, [n[0], *end], &turn, form, rest, step, &mut w);
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
        turn: &Turn<R>,
        form: R,
        history: &mut [R],
        step: Advance,
        w: &mut Wrench<R>,
    ) {
        let Turn { omega, carried, a, .. } = *turn;
        let (roll, rest) = history.split_at_mut(self.rolling.memory());
        if self.rolling != Rolling::None {
            let mut turn = *turn;
            if self.is_on_wall && self.rolling.is_torque() {
                // Measured with LIGGGHTS 3.8.0.
                let distance = g.radii[0] - g.overlap;
                turn.omega = scale((distance + g.overlap * 0.5) / distance, omega);
            }
            let torque = self.rolling.torque(g, (n, self.spring.sync), &turn, roll, step);
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
