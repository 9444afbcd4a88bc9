//! Steps of two lengths: bonds of peridynamic solids in short ones, contacts and everything else in long ones.
//!
//! The impulse scheme of two levels (physics.md 1.9, `kick`; Hartmann et al. 2022 with the hybrid particles' second
//! drift taken out): slow forces kick all particles by half a long step at both of its ends, between which solids make
//! `m` velocity-Verlet steps under their bonds alone. Symplectic, and momentum is conserved. Where grains are the
//! faster ones, bonds act at every m-th step, with m times their force.

use super::levels::{self, Levels, exchange};
use super::verlet::{MOTION, tick};
use crate::{Solids, Stage, StepPlan, Tick};
use perigrain_base::diag::Result;
use perigrain_world::World;
use std::sync::Arc;

/// How long steps and short ones relate.
#[derive(Clone, Debug, PartialEq)]
pub struct Staggered {
    /// The particles that move in short steps.
    pub solids: Arc<Solids>,
    /// Short steps per long one.
    pub ratio: Ratio,
    /// The two levels.
    two: Levels,
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
    /// Steps of two lengths.
    pub fn new(solids: Arc<Solids>, ratio: Ratio) -> Self {
        Self { solids: solids.clone(), ratio, two: Levels::new(vec![1], Some(solids)) }
    }

    /// Short steps in a long one of `dt`.
    fn count(&self, dt: f64) -> i64 {
        match self.ratio {
            Ratio::Short(m) => m,
            Ratio::Within(limit) => (dt / limit).ceil().clamp(1.0, 1e6) as i64,
            Ratio::Rare(_) => 1,
        }
    }

    /// The two levels of a long step of `m` short ones.
    fn levels(&self, m: i64) -> Levels {
        Levels { loops: vec![m], ..self.two.clone() }
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
            plan.request_sums(&mut t);
            plan.run(w, &t, &[Stage::Neighbor, Stage::PreForce])?;
            rare(plan, w, &t, m, s)?;
            plan.run(w, &t, &[Stage::InitialIntegrate, Stage::PostIntegrate, Stage::FinalIntegrate])?;
            return plan.run(w, &t, &[Stage::EndOfStep, Stage::Output]);
        }
    }
    super::verlet::setup(plan, w, unchanged)?;
    if m > 1 && !(unchanged && levels::stand(w, &s.two)) {
        split(plan, w, s)?;
    }
    Ok(())
}

/// One step of two lengths up to its outputs; a plain one where one short step fills the long one.
///
/// # Errors
/// The first op's that fails.
pub fn step(plan: &mut StepPlan, w: &mut World, t: &Tick, s: &Staggered) -> Result<()> {
    match s.ratio {
        Ratio::Rare(1) => return plan.run(w, t, &MOTION),
        Ratio::Rare(m) => {
            plan.run(w, t, &[Stage::InitialIntegrate, Stage::PostIntegrate, Stage::Exchange])?;
            plan.run(w, t, &[Stage::Neighbor, Stage::PreForce])?;
            rare(plan, w, t, m, s)?;
            return plan.run(w, t, &[Stage::FinalIntegrate]);
        }
        Ratio::Short(_) | Ratio::Within(_) => {}
    }
    let m = s.count(t.dt);
    if m == 1 && s.solids.twice == 0 {
        s.two.forget(w);
        return plan.run(w, t, &MOTION);
    }
    if !levels::stand(w, &s.two) {
        split(plan, w, s)?;
    }
    levels::step(plan, w, t, &s.levels(m))
}

/// Forces where bonds act at multiples of `m` steps: `m` times then, else not at all. Where sums are requested at another step,
/// bonds are evaluated without advancing them.
fn rare(plan: &mut StepPlan, w: &mut World, t: &Tick, m: i64, s: &Staggered) -> Result<()> {
    let (two, due) = (s.levels(m), t.step.rem_euclid(m) == 0);
    if due || t.energy || t.virial {
        // Bonds that relax have done so since they were looked at last.
        let dt = m as f64 * t.dt;
        let look = Tick { dt, setup: t.setup || !due, unchanged: t.unchanged || !due, ..t.clone() };
        plan.run(w, &two.at(&look, 0), &[Stage::Force])?;
        let times = if due { m as f64 } else { 0.0 };
        w.particles.f.iter_mut().flatten().for_each(|a| *a *= times);
    }
    plan.run(w, &two.at(t, 1), &[Stage::Force])?;
    plan.run(w, t, &[Stage::PostForce])
}

/// The present forces as bonds' and others'; bonds turn nothing.
fn split(plan: &mut StepPlan, w: &mut World, s: &Staggered) -> Result<()> {
    let all = w.particles.f.clone();
    let constrain = s.levels(1).at(&tick(w, true), 0);
    let look = Tick { unchanged: true, ..constrain.clone() };
    w.particles.f.fill([0.0; 3]);
    plan.run(w, &look, &[Stage::Force])?;
    plan.run(w, &constrain, &[Stage::PostForce])?;
    let own = std::mem::replace(&mut w.particles.f, all.clone());
    let rest: Vec<[f64; 3]> =
        all.iter().zip(&own).map(|(f, b)| std::array::from_fn(|d| f[d] - b[d])).collect();
    s.two.forget(w);
    let torque = w.particles.torque.clone();
    for (k, part) in [(0, (own, vec![[0.0; 3]; torque.len()])), (1, (rest.into(), torque.to_vec()))] {
        (w.particles.f, *w.particles.torque) = part;
        exchange(w, &s.two, k);
    }
    (w.particles.f, w.particles.torque) = (all, torque);
    Ok(())
}
