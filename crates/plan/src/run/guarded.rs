//! Steps under a guard: a block that made energy is taken back, and made again in shorter steps.

use crate::{Energy, Guard, StepPlan, Tick};
use perigrain_base::diag::{Code, Diagnostics, Result};
use perigrain_world::World;

/// A run's guard at work.
pub struct Guarded {
    guard: Guard,
    /// The scene at the end of the last good block.
    good: World,
    energy: Energy,
    /// The longest step that the run has had [time].
    longest: f64,
    /// Good blocks since the step became shorter.
    streak: i64,
}

/// What becomes of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Continue.
    Good,
    /// The scene is that of the last good block again.
    Back,
}

impl Guarded {
    /// Takes the present scene for good.
    ///
    /// # Errors
    /// No energies.
    pub fn new(mut guard: Guard, plan: &mut StepPlan, w: &mut World) -> Result<Self> {
        plan.release(w)?;
        let energy = if w.tally.step == Some(w.clock.step) { (guard.look)(w)? } else { Energy::default() };
        Ok(Self { guard, good: w.clone(), energy, longest: w.clock.dt, streak: 0 })
    }

    /// The guard, for the next run.
    pub fn into_guard(self) -> Guard {
        self.guard
    }

    /// Judges a step that was made up to its outputs.
    ///
    /// # Errors
    /// Those of the step that shorter steps cannot mend, and steps that would be too short.
    pub fn judge(
        &mut self,
        plan: &mut StepPlan,
        w: &mut World,
        t: &Tick,
        made: Result<()>,
    ) -> Result<Verdict> {
        let why = match made {
            Err(e) if mendable(&e) => "particles are lost".to_string(),
            Err(e) => return Err(e),
            Ok(()) if !self.guard.when.fires(t) => return Ok(Verdict::Good),
            Ok(()) => {
                let now = (self.guard.look)(w)?;
                match self.off(now) {
                    Some(why) => why,
                    None => return Ok(Verdict::Good),
                }
            }
        };
        let (bad, step) = (w.clock.step, self.good.clock.dt * self.guard.rule.shrink);
        let Guard { name, rule, .. } = &self.guard;
        if step < rule.shortest {
            let text =
                format!("{name}: {why} at step {bad}, and steps as short as {step:.3e} do not mend it");
            return Err(perigrain_base::diag::Diagnostic::error(Code::UNSTABLE, None, text)
                .help("look for particles created inside each other, or raise the tolerance")
                .into());
        }
        plan.release(w)?;
        let newer = w.rebuild.generation.max(self.good.rebuild.generation);
        let places = w.rebuild.places.max(self.good.rebuild.places);
        *w = self.good.clone();
        // Lists made since must not be taken for those to come.
        w.rebuild.generation = newer + 1;
        w.rebuild.places = places + 1;
        w.rebuild.due = true;
        w.clock.set_dt(step);
        self.good.clock.set_dt(step);
        self.streak = 0;
        let line =
            format!("{name}: {why} at step {bad}; back to step {}, time step {step:.6e}", w.clock.step);
        (self.guard.write_line)(&line)?;
        Ok(Verdict::Back)
    }

    /// Keeps the scene after the outputs of a step, where a block ends.
    ///
    /// # Errors
    /// No energies.
    pub fn keep(&mut self, plan: &mut StepPlan, w: &mut World, t: &Tick) -> Result<()> {
        if !self.guard.when.fires(t) {
            return Ok(());
        }
        self.energy = (self.guard.look)(w)?;
        self.longest = self.longest.max(w.clock.dt);
        self.streak += 1;
        let rule = &self.guard.rule;
        if rule.recover > 0 && self.streak >= rule.recover && w.clock.dt < self.longest {
            let longer = (w.clock.dt / rule.shrink).min(self.longest);
            w.clock.set_dt(longer);
            self.streak = 0;
        }
        plan.release(w)?;
        self.good.clone_from(w);
        Ok(())
    }

    /// What is wrong with the energy, if something is.
    fn off(&self, now: Energy) -> Option<String> {
        let before = self.energy;
        let measure = before.held.abs() + (now.turnover - before.turnover).abs();
        let part = (now.residual - before.residual).abs() / measure.max(f64::MIN_POSITIVE);
        // A part that is no number is wrong too.
        let right = part <= self.guard.rule.tolerance;
        (!right).then(|| match now.residual.is_finite() {
            true => format!("energy is off by {:.3} %", 100.0 * part),
            false => "energy is no longer finite".to_string(),
        })
    }
}

/// Whether shorter steps may help.
fn mendable(problems: &Diagnostics) -> bool {
    problems.0.iter().all(|d| [Code::LOST, Code::NOT_FINITE].contains(&d.code))
}
