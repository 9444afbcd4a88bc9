//! Minimization of the energy over a sealed plan: what all styles share, from the first forces to the last output.

mod descent;
mod fire;
mod line;
mod quickmin;

use super::verlet::{cpu_seconds, tick};
use super::{Made, Outcome, Watch};
use crate::{Stage, StepPlan, Tick};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_base::par;
use perigrain_world::World;
use perigrain_world::minimizer::{ForceNorm, MinStyle};
use std::time::Instant;

/// What keeps the relative change of energies near zero finite, in LAMMPS' criterion.
const TINY_ENERGY: f64 = 1e-8;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Relative change of the energy in an iteration.
    pub etol: f64,
    /// Length of all forces.
    pub ftol: f64,
    /// Iterations at most.
    pub iterations: i64,
    /// Evaluations of forces at most (`cg` and `sd`, as in LAMMPS).
    pub evaluations: i64,
}

/// Why a minimization has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// All iterations were made.
    Iterations,
    /// So many evaluations were made.
    Evaluations,
    /// The energy hardly changes.
    Energy,
    /// The forces are small.
    Force,
    /// A search direction leads uphill.
    Uphill,
    /// Smaller steps along the line do not help.
    ZeroStep,
    /// There is no force at all.
    ZeroForce,
    /// The force along the line does not change.
    ZeroCurvature,
    /// FIRE went uphill too often in a row.
    Stuck,
    /// The limit of `timer timeout`, or a fix.
    Ended,
}

impl Stop {
    /// LAMMPS' words.
    pub fn text(self) -> &'static str {
        match self {
            Stop::Iterations => "max iterations",
            Stop::Evaluations => "max force evaluations",
            Stop::Energy => "energy tolerance",
            Stop::Force => "force tolerance",
            Stop::Uphill => "search direction is not downhill",
            Stop::ZeroStep => "linesearch alpha is zero",
            Stop::ZeroForce => "forces are zero",
            Stop::ZeroCurvature => "quadratic factors are zero",
            Stop::Stuck => "max iterations with v.f negative",
            Stop::Ended => "walltime limit reached",
        }
    }
}

/// How a minimization went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// Why it stopped.
    pub stop: Stop,
    /// Energy at the start, before the last iteration, at the end.
    pub energy: [f64; 3],
    /// Two-norm of all forces at the start and the end.
    pub two_norm: [f64; 2],
    /// Largest component of a force at the start and the end.
    pub largest: [f64; 2],
    /// The last step along the last direction; 0 for FIRE.
    pub alpha: f64,
    /// Iterations.
    pub iterations: i64,
    /// Evaluations of forces.
    pub evaluations: i64,
}

/// How the energy is read after forces have been computed.
pub type Energy<'a> = &'a dyn Fn(&World) -> f64;

/// A minimization under way.
struct Search<'a> {
    plan: &'a mut StepPlan,
    w: &'a mut World,
    watch: &'a mut dyn Watch,
    read: Energy<'a>,
    goal: Goal,
    /// What sums over particles are divided by: their number where energies are per particle.
    per: f64,
    /// The present energy.
    energy: f64,
    /// The energy before the last iteration.
    previous: f64,
    evaluations: i64,
    alpha: f64,
    first: i64,
    /// Iterations that the deck requests.
    requested: i64,
    /// The time step before FIRE changed it.
    dt: f64,
    interrupted: bool,
    /// How far a coordinate may change in one line search or step [length].
    farthest: f64,
    /// Places on a line are only tried: what can break or flow does so where a line search ends.
    tries: bool,
}

/// Minimizes the energy that `read` finds, as the world's settings say; output appears as in a run, iterations being
/// steps. `normalized` says that this energy is per particle.
///
/// # Errors
/// The first op's that fails.
pub fn minimize(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    (read, normalized): (Energy, bool),
    goal: Goal,
) -> Result<(Outcome, Stats)> {
    let per = if normalized { w.n().max(1) as f64 } else { 1.0 };
    let (first, last, dt) = (w.clock.step, w.clock.last, w.clock.dt);
    let farthest = farthest(w);
    let mut s = Search {
        plan,
        w,
        watch,
        read,
        goal,
        per,
        energy: 0.0,
        previous: 0.0,
        evaluations: 0,
        alpha: 0.0,
        first,
        requested: last - first,
        dt,
        interrupted: false,
        farthest,
        tries: false,
    };
    s.begin()?;
    s.tries = tries(s.w);
    let (initial, norms) = (s.energy, s.norms());
    s.previous = initial;
    let (clock, cpu) = (Instant::now(), cpu_seconds());
    let stop = match s.w.settings.minimizer.style {
        MinStyle::Cg | MinStyle::Sd => descent::descend(&mut s)?,
        MinStyle::Fire => fire::relax(&mut s)?,
        MinStyle::Quickmin => quickmin::relax(&mut s)?,
    };
    if stop != Stop::Iterations {
        s.last_output()?;
    }
    s.w.clock.dt = dt;
    s.w.clock.stop = s.w.clock.last;
    let stop = if s.interrupted && stop == Stop::Iterations { Stop::Ended } else { stop };
    let iterations = s.w.clock.step - first;
    let after = s.norms();
    let stats = Stats {
        stop,
        energy: [initial, s.previous, s.energy],
        two_norm: [norms.0, after.0],
        largest: [norms.1, after.1],
        alpha: s.alpha,
        iterations,
        evaluations: s.evaluations,
    };
    let outcome = Outcome {
        steps: iterations,
        time: clock.elapsed(),
        cpu: cpu_seconds() - cpu,
        interrupted: s.interrupted,
    };
    Ok((outcome, stats))
}

impl Search<'_> {
    /// Forces of the first scene and its output.
    fn begin(&mut self) -> Result<()> {
        if matches!(self.w.settings.minimizer.style, MinStyle::Fire | MinStyle::Quickmin) {
            self.w.particles.v.fill([0.0; 3]);
        }
        let mut t = tick(self.w, true);
        self.plan.request_sums(&mut t);
        let forces = [Stage::Neighbor, Stage::PreForce, Stage::Force, Stage::PostForce, Stage::EndOfStep];
        self.plan.run(self.w, &t, &forces)?;
        self.energy = (self.read)(self.w);
        self.plan.reset_meters(true);
        self.plan.run(self.w, &t, &[Stage::Output])
    }

    /// Forces and energy where the particles are now. Not counted.
    fn look(&mut self, ending: bool, trial: bool) -> Result<f64> {
        // Values belong to a scene, not to a step: several scenes share one here.
        self.w.slots.invalidate();
        let mut t = Tick { ending, trial, ..tick(self.w, false) };
        if self.w.settings.lammps() {
            // Springs of contacts grow there by the time step that the deck named, whatever FIRE makes of it.
            t.dt = self.dt;
        }
        self.plan.request_sums(&mut t);
        let forces = [Stage::Neighbor, Stage::PreForce, Stage::Force, Stage::PostForce, Stage::EndOfStep];
        let (plan, w) = (&mut *self.plan, &mut *self.w);
        par::inside(|| plan.run(w, &t, &forces)).map_err(|e| thrown(e, self.farthest))?;
        Ok((self.read)(self.w))
    }

    /// As `look`, counted and kept as the present energy.
    fn evaluate(&mut self) -> Result<()> {
        self.energy = self.look(false, false)?;
        self.evaluations += 1;
        Ok(())
    }

    /// As `evaluate`, of a place that a line search tries.
    fn attempt(&mut self) -> Result<()> {
        self.energy = self.look(false, self.tries)?;
        self.evaluations += 1;
        Ok(())
    }

    /// Begins an iteration, unless the search has to stop.
    fn next(&mut self) -> Option<Stop> {
        if self.w.clock.step - self.first >= self.goal.iterations {
            return Some(Stop::Iterations);
        }
        self.w.settings.agree_at(self.w.clock.step);
        if self.w.settings.ends_at(self.w.clock.step) || self.w.clock.halt != perigrain_world::Halt::No {
            return Some(Stop::Ended);
        }
        if !self.interrupted && self.w.settings.stops() {
            // This iteration is the last one, as if no more had been requested.
            self.interrupted = true;
            self.goal.iterations = self.w.clock.step - self.first + 1;
            self.w.clock.last = self.w.clock.step + 1;
        }
        self.w.clock.step += 1;
        None
    }

    /// Output of an iteration that is not the end for another reason than their number.
    fn output(&mut self) -> Result<()> {
        let mut t = tick(self.w, false);
        self.plan.request_sums(&mut t);
        self.plan.run(self.w, &t, &[Stage::Output])?;
        let c = &self.w.clock;
        let (done, total) = (c.step - self.first, self.requested);
        self.watch.step(&Made { done, total, step: c.step, time: c.time(), dt: c.dt });
        if self.watch.looks(self.w) {
            self.watch.scene(self.w);
        }
        Ok(())
    }

    /// The end came early: all outputs show the last scene, whatever their intervals.
    fn last_output(&mut self) -> Result<()> {
        self.w.clock.last = self.w.clock.step;
        self.energy = self.look(true, false)?;
        let mut t = Tick { ending: true, ..tick(self.w, false) };
        self.plan.request_sums(&mut t);
        self.plan.run(self.w, &t, &[Stage::Output])
    }

    /// Whether the energy changed less than the tolerance in this iteration.
    fn energy_settled(&self) -> bool {
        // A number with a unit: without LAMMPS' faults, energies that are small in joules count as others do.
        let tiny = if self.w.settings.lammps() { TINY_ENERGY } else { 0.0 };
        let scale = 0.5 * (self.energy.abs() + self.previous.abs() + tiny);
        let change = (self.energy - self.previous).abs();
        change < self.goal.etol * scale || (scale == 0.0 && self.goal.etol > 0.0)
    }

    /// Whether the forces are shorter than the tolerance.
    fn force_settled(&self) -> bool {
        let f = &self.w.particles.f;
        let square = |i: usize| dot(f[i], f[i]);
        let length = match self.w.settings.minimizer.norm {
            ForceNorm::Two => par::sum(f.len(), square),
            ForceNorm::Max => par::max(f.len(), square),
            ForceNorm::Inf => par::max(f.len(), |i| f[i].iter().fold(0.0, |m: f64, a| m.max(a * a))),
        };
        self.goal.ftol > 0.0 && length < self.goal.ftol * self.goal.ftol
    }

    /// Two-norm and largest component of all forces.
    fn norms(&self) -> (f64, f64) {
        let f = &self.w.particles.f;
        let sum = par::sum(f.len(), |i| dot(f[i], f[i]));
        (sum.sqrt(), largest(f))
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// How far a coordinate may change: LAMMPS' 0.1 knows no particles.
fn farthest(w: &World) -> f64 {
    let least = |list: &[f64]| list.iter().copied().filter(|a| *a > 0.0).reduce(f64::min);
    let grain = least(&w.particles.radius).map(|r| 2.0 * r);
    let site = least(&w.particles.volume).map(f64::cbrt);
    let size = grain.into_iter().chain(site).reduce(f64::min).filter(|_| !w.settings.lammps());
    w.settings.minimizer.farthest(size)
}

/// Whether places of a line search are only tried: where bonds may break or flow. LAMMPS lets them do so wherever it looks.
fn tries(w: &World) -> bool {
    let line = matches!(w.settings.minimizer.style, MinStyle::Cg | MinStyle::Sd);
    let bonds = !w.bonds.list.is_empty() || w.families.as_ref().is_some_and(|f| f.change());
    line && bonds && !w.settings.lammps()
}

/// Lost particles have mostly been thrown: adds how far they may move.
fn thrown(e: Diagnostics, farthest: f64) -> Diagnostics {
    let named = |d: Diagnostic| {
        match d.code == Code::LOST {
        true => d.help(format!(
            "or lower `min_modify dmax`: in one line search or step a coordinate may change by {farthest:.3e} here"
        )),
        false => d,
    }
    };
    Diagnostics(e.0.into_iter().map(named).collect())
}

/// v ← v + f/m · dt, then v ← a v + b f.
fn kick(w: &mut World, dt: f64, mix: Option<(f64, f64)>) {
    let factor = dt * w.settings.units.constants().ftm2v;
    let p = &mut w.particles;
    par::each((&mut p.v[..], &p.f[..], &p.mass[..]), |_, (v, f, mass)| {
        for ((v, f), mass) in v.iter_mut().zip(f).zip(mass) {
            let k = factor / mass;
            (0..3).for_each(|d| v[d] += k * f[d]);
            if let Some((a, b)) = mix {
                (0..3).for_each(|d| v[d] = a * v[d] + b * f[d]);
            }
        }
    });
}

/// This time step, or the one in which no coordinate changes by more than `farthest`.
fn shortened(w: &World, dt: f64, farthest: f64) -> f64 {
    let fastest = largest(&w.particles.v);
    if dt * fastest > farthest { farthest / fastest } else { dt }
}

/// x ← x + v · dt.
fn drift(w: &mut World, dt: f64) {
    let p = &mut w.particles;
    par::each((&mut p.x[..], &p.v[..]), |_, (x, v)| {
        for (x, v) in x.iter_mut().zip(v) {
            (0..3).for_each(|d| x[d] += dt * v[d]);
        }
    });
}

/// The scalar product of two long vectors.
fn product(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    par::sum(a.len().min(b.len()), |i| dot(a[i], b[i]))
}

/// The largest component, without its sign.
fn largest(a: &[[f64; 3]]) -> f64 {
    par::max(a.len(), |i| a[i].iter().fold(0.0, |m: f64, c| m.max(c.abs()))).max(0.0)
}
