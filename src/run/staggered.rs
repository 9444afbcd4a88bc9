//! Steps of two lengths: bonds of peridynamic solids in short ones, contacts and everything else in long ones.
//!
//! The impulse scheme of two levels (physics.md 1.9, `kick`; Hartmann et al. 2022 with the hybrid particles' second
//! drift taken out): slow forces kick everybody by half a long step at both of its ends, between which solids make
//! `m` velocity-Verlet steps under their bonds alone. Symplectic, and momentum is conserved. Where grains are the
//! faster ones, bonds act at every m-th step, with m times their force.

use super::verlet::{MOTION, Outcome, Watch, tick};
use crate::diag::Result;
use crate::plan::{Beat, Phase, Solids, Stage, StepPlan, Tick};
use crate::world::World;
use crate::world::columns::{BOND_FORCES, SLOW_FORCES};
use std::sync::Arc;

/// How long steps and short ones relate.
#[derive(Clone, Debug, PartialEq)]
pub struct Staggered {
    /// Who moves in short steps.
    pub solids: Arc<Solids>,
    /// Short steps per long one.
    pub ratio: Ratio,
}

/// Short steps per long one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ratio {
    /// This number of short steps of solids.
    Short(i64),
    /// As many as keep the short step within this [time].
    Within(f64),
    /// Bonds act at each multiple of this number of steps.
    Rare(i64),
}

impl Staggered {
    /// Short steps in a long one of `dt`.
    fn count(&self, dt: f64) -> i64 {
        match self.ratio {
            Ratio::Short(m) => m,
            Ratio::Within(limit) => (dt / limit).ceil().clamp(1.0, 1e6) as i64,
            Ratio::Rare(_) => 1,
        }
    }
}

/// Forces at the start of a run, both parts, and its first outputs.
///
/// # Errors
/// The first op's that fails.
pub fn setup(plan: &mut StepPlan, w: &mut World, unchanged: bool, s: &Staggered) -> Result<()> {
    let m = s.count(w.clock.dt);
    if let Ratio::Rare(m) = s.ratio {
        let mut t = tick(w, true);
        (t.unchanged, t.step) = (unchanged, w.clock.step);
        if m > 1 && !unchanged {
            plan.ask(&mut t);
            plan.run(w, &t, &[Stage::Neighbor, Stage::PreForce])?;
            rare(plan, w, &t, m)?;
            plan.run(w, &t, &[Stage::InitialIntegrate, Stage::PostIntegrate, Stage::FinalIntegrate])?;
            return plan.run(w, &t, &[Stage::EndOfStep, Stage::Output]);
        }
    }
    super::verlet::setup(plan, w, unchanged)?;
    if m > 1 && (!unchanged || w.columns.get_vector(BOND_FORCES).is_none()) {
        split(plan, w, s)?;
    }
    Ok(())
}

/// Makes the steps `clock.first + 1 ..= clock.last`.
///
/// # Errors
/// The first op's that fails; the world is then as that op left it.
pub fn staggered(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    s: &Staggered,
) -> Result<Outcome> {
    super::verlet::steps(plan, w, watch, |plan, w, t| step(plan, w, t, s))
}

/// One step of two lengths up to its outputs; a plain one where one short step fills the long one.
///
/// # Errors
/// The first op's that fails.
fn step(plan: &mut StepPlan, w: &mut World, t: &Tick, s: &Staggered) -> Result<()> {
    match s.ratio {
        Ratio::Rare(1) => return plan.run(w, t, &MOTION),
        Ratio::Rare(m) => {
            plan.run(w, t, &[Stage::InitialIntegrate, Stage::PostIntegrate])?;
            plan.run(w, t, &[Stage::Neighbor, Stage::PreForce])?;
            rare(plan, w, t, m)?;
            return plan.run(w, t, &[Stage::FinalIntegrate]);
        }
        Ratio::Short(_) | Ratio::Within(_) => {}
    }
    let m = s.count(t.dt);
    if m == 1 && s.solids.twice == 0 {
        w.columns.remove(BOND_FORCES);
        w.columns.remove(SLOW_FORCES);
        return plan.run(w, t, &MOTION);
    }
    if w.columns.get_vector(BOND_FORCES).is_none_or(|c| c.len() != w.n()) {
        split(plan, w, s)?;
    }
    let long = Tick { phase: Phase::Long(s.solids.clone()), ..t.clone() };
    let slow = [Beat::Long, Beat::Both];
    exchange(w, SLOW_FORCES);
    plan.run_beats(w, &long, &[Stage::InitialIntegrate], &slow)?;
    if t.energy || t.virial {
        w.tally.clear(t.step, t.virial, t.atom_energy, w.n());
    }
    exchange(w, BOND_FORCES);
    short_steps(plan, w, t, m, s)?;
    exchange(w, BOND_FORCES);
    plan.run_beats(w, &long, &[Stage::PostIntegrate, Stage::Neighbor, Stage::PreForce], &slow)?;
    plan.run_beats(w, &long, &[Stage::Force, Stage::PostForce], &slow)?;
    plan.run_beats(w, &long, &[Stage::FinalIntegrate], &slow)?;
    join(w);
    Ok(())
}

/// `m` velocity-Verlet steps of the solids under their bonds; `f` holds bond forces before and after.
fn short_steps(plan: &mut StepPlan, w: &mut World, t: &Tick, m: i64, s: &Staggered) -> Result<()> {
    let phase = Phase::Short(s.solids.clone());
    let mut short =
        Tick { phase, dt: t.dt / m as f64, energy: false, virial: false, atom_energy: false, ..t.clone() };
    for k in 1..=m {
        if k == m {
            (short.energy, short.virial, short.atom_energy) = (t.energy, t.virial, t.atom_energy);
        }
        plan.run_beats(w, &short, &[Stage::InitialIntegrate], &[Beat::Both])?;
        bonds(plan, w, &short)?;
        plan.run_beats(w, &short, &[Stage::FinalIntegrate], &[Beat::Both])?;
    }
    Ok(())
}

/// Bond forces alone, less what constraints take away.
fn bonds(plan: &mut StepPlan, w: &mut World, t: &Tick) -> Result<()> {
    w.particles.f.fill([0.0; 3]);
    plan.run_beats(w, t, &[Stage::Force], &[Beat::Short])?;
    plan.run_beats(w, t, &[Stage::PostForce], &[Beat::Both])
}

/// Forces where bonds act at multiples of `m` steps: `m` times then, else not at all. Where somebody asks for sums at
/// another step, bonds are looked at without moving on.
fn rare(plan: &mut StepPlan, w: &mut World, t: &Tick, m: i64) -> Result<()> {
    let due = t.step.rem_euclid(m) == 0;
    if due || t.energy || t.virial {
        // Bonds that relax have done so since they were looked at last.
        let dt = m as f64 * t.dt;
        let look = Tick { dt, setup: t.setup || !due, unchanged: t.unchanged || !due, ..t.clone() };
        plan.run_beats(w, &look, &[Stage::Force], &[Beat::Short])?;
        let times = if due { m as f64 } else { 0.0 };
        w.particles.f.iter_mut().flatten().for_each(|a| *a *= times);
    }
    plan.run_beats(w, t, &[Stage::Force], &[Beat::Long, Beat::Both])?;
    plan.run(w, t, &[Stage::PostForce])
}

/// The present forces as bonds' and others'.
fn split(plan: &mut StepPlan, w: &mut World, s: &Staggered) -> Result<()> {
    let n = w.n();
    let all = w.particles.f.clone();
    let constrain = Tick { phase: Phase::Short(s.solids.clone()), ..tick(w, true) };
    let look = Tick { unchanged: true, ..constrain.clone() };
    w.particles.f.fill([0.0; 3]);
    plan.run_beats(w, &look, &[Stage::Force], &[Beat::Short])?;
    plan.run_beats(w, &constrain, &[Stage::PostForce], &[Beat::Both])?;
    let own = std::mem::replace(&mut w.particles.f, all);
    let rest: Vec<[f64; 3]> =
        w.particles.f.iter().zip(&own).map(|(f, b)| std::array::from_fn(|d| f[d] - b[d])).collect();
    *w.columns.vector(BOND_FORCES, n) = own;
    *w.columns.vector(SLOW_FORCES, n) = rest;
    Ok(())
}

/// Lets the forces and a column change places.
fn exchange(w: &mut World, column: &str) {
    let n = w.n();
    std::mem::swap(&mut w.particles.f, w.columns.vector(column, n));
}

/// Keeps the slow forces that `f` holds, and shows both parts together.
fn join(w: &mut World) {
    let n = w.n();
    w.columns.vector(SLOW_FORCES, n).clone_from(&w.particles.f);
    let Some(bonds) = w.columns.get_vector(BOND_FORCES) else { return };
    for (f, b) in w.particles.f.iter_mut().zip(bonds) {
        (0..3).for_each(|d| f[d] += b[d]);
    }
}
