//! How far particles go in a step that holds shorter ones: what springs of contacts grow by.
//!
//! A spring that is advanced by the step times a velocity at its end is no function of places: where particles swing in the shorter
//! steps, it makes energy. By the path it is one while it sticks, its force a gradient, and steps of several lengths stay symplectic.

use crate::level::Level;
use crate::{Phase, Stage, StepPlan};
use perigrain_world::columns;
use perigrain_world::field::{CONTACTS, TORQUE, WALL_CONTACTS};
use perigrain_world::{Vectors, World};

/// The path of one step of a level.
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// Where it is added up.
    key: Vectors,
}

/// Whether ops that act at this level keep contact history.
pub(super) fn remembers(plan: &StepPlan, phase: &Phase) -> bool {
    forces(plan, |level| level.acts(phase), |needs| needs.changes(CONTACTS | WALL_CONTACTS))
}

/// Whether forces of shorter steps than those of this level turn particles.
pub(super) fn turns_within(plan: &StepPlan, phase: &Phase) -> bool {
    let within = |level: Level| {
        (0..phase.level).any(|k| level.acts(&Phase { level: k, ..phase.clone() })) && level != Level::Every
    };
    forces(plan, within, |needs| needs.changes(TORQUE))
}

fn forces(plan: &StepPlan, acts: impl Fn(Level) -> bool, does: impl Fn(&crate::Needs) -> bool) -> bool {
    let force = |stage| matches!(stage, Stage::Force | Stage::PostForce);
    plan.ops.iter().any(|p| force(p.about.stage) && acts(p.about.level) && does(&p.about.needs))
}

impl Path {
    /// A step begins.
    pub fn begin(w: &mut World, own: &columns::Level) -> Self {
        let (path, n) = (Self { key: own.path[0] }, w.n());
        let sum = w.columns.vector(path.key, n);
        sum.clear();
        sum.resize(n, [0.0; 3]);
        path.leave(w);
        path
    }

    /// From here on motion counts.
    pub fn leave(self, w: &mut World) {
        self.add(w, -1.0);
    }

    /// From here on it does not: particles are wrapped, and new ones come.
    pub fn arrive(self, w: &mut World) {
        self.add(w, 1.0);
    }

    fn add(self, w: &mut World, sign: f64) {
        let n = w.n();
        let mut sum = std::mem::take(w.columns.vector(self.key, n));
        for (sum, x) in sum.iter_mut().zip(&*w.particles.x) {
            (0..3).for_each(|d| sum[d] += sign * x[d]);
        }
        *w.columns.vector(self.key, n) = sum;
    }

    /// The way over the length of the step: particles that moved in it as in one piece (`whole`) keep their velocity to the bit.
    pub fn end(self, w: &mut World, dt: f64, whole: impl Fn(u16) -> bool) -> Vectors {
        let n = w.n();
        let mut mean = std::mem::take(w.columns.vector(self.key, n));
        let p = &w.particles;
        for ((mean, v), kind) in mean.iter_mut().zip(&*p.v).zip(&*p.kind) {
            *mean = if whole(*kind) { *v } else { mean.map(|way| way / dt) };
        }
        *w.columns.vector(self.key, n) = mean;
        self.key
    }
}

/// Mean spins of a step of a level begin.
pub(super) fn begin_spins(w: &mut World, own: &columns::Level) -> Vectors {
    let n = w.n();
    let mean = w.columns.vector(own.path[1], n);
    mean.clear();
    mean.resize(n, [0.0; 3]);
    own.path[1]
}

/// Spins of one of the shortest steps, of which the level's holds so many.
pub(super) fn add_spins(w: &mut World, key: Vectors, steps: i64) {
    let (n, part) = (w.n(), 1.0 / steps as f64);
    let mut mean = std::mem::take(w.columns.vector(key, n));
    for (mean, spin) in mean.iter_mut().zip(&*w.particles.omega) {
        (0..3).for_each(|d| mean[d] += part * spin[d]);
    }
    *w.columns.vector(key, n) = mean;
}
