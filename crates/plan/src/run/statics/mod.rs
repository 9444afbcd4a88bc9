//! Equilibria over a sealed plan, load step by load step: the load parameter is time.
//!
//! A load step moves the clock; what stands on a path moves there, loads that depend on time change, and the free particles
//! follow to the place where no force is left on them (Newton's method, its linear systems by conjugate gradients). Nothing
//! breaks, flows or is remembered while places are only tried. At an equilibrium the bonds stretched beyond their limit
//! break, some at a time, and the body is balanced again at the same loads.

mod balance;
mod bodies;
mod ledger;

use super::verlet::{cpu_seconds, tick};
use super::{Made, Outcome, Watch};
use crate::{Stage, StepPlan};
use balance::Balance;
pub use bodies::Body;
pub use ledger::Ledger;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_statics::network::Network;
use perigrain_world::{Halt, World};
use std::time::Instant;

/// Which bonds beyond their limit break at an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Breaking {
    /// The one stretched most beyond its limit, with those that are stretched as much.
    One,
    /// And so many of the others, most stretched first, as a share of them.
    Batch(f64),
    /// All.
    All,
    /// None.
    No,
}

impl Breaking {
    /// The share of the others that break too; `None` where all do.
    fn share(self) -> Option<f64> {
        match self {
            Breaking::One | Breaking::No => Some(0.0),
            Breaking::Batch(share) => Some(share),
            Breaking::All => None,
        }
    }
}

/// What a line of `statics` requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Load steps.
    pub steps: i64,
    /// Unbalanced force at the end of a load step, over the larger one of reactions and loads.
    pub tol: f64,
    /// What breaks.
    pub breaking: Breaking,
    /// Equilibria of one load step at most, each with other bonds.
    pub most: usize,
}

/// How a load step went, or all of them together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Which one it is, from 1.
    pub step: i64,
    /// The time that its loads belong to.
    pub time: f64,
    /// Newton's steps.
    pub newton: usize,
    /// Products with the tangent stiffness.
    pub products: usize,
    /// Unbalanced force over reactions and loads.
    pub force: f64,
    /// Bonds that broke.
    pub broken: usize,
    /// Energies from the first load step on.
    pub ledger: Ledger,
    /// Wall time [s].
    pub seconds: f64,
}

/// Takes note of a load step.
pub type Note<'a> = &'a mut dyn FnMut(&Numbers);

/// Makes load steps until `goal.steps` are made; output appears as in a run. `body` finds what may move, once
/// forces have been computed, and `springs` the bonds that still live; `note` gets the numbers of each load step.
///
/// # Errors
/// The first op's that fails; bodies that cannot be balanced.
pub fn statics(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    (body, springs): (impl FnOnce(&World) -> Result<Body>, fn(&World) -> Network),
    goal: Goal,
    note: Note,
) -> Result<(Outcome, Numbers)> {
    let (first, clock, cpu) = (w.clock.step, Instant::now(), cpu_seconds());
    begin(plan, w)?;
    let body = body(w)?;
    let mut balance = Balance::new(plan, w, body, goal);
    balance.begin()?;
    let mut all = Numbers { time: balance.w.clock.time(), ..Numbers::default() };
    let mut interrupted = false;
    while balance.w.clock.step < balance.w.clock.last && balance.w.clock.halt == Halt::No {
        // All ranks end behind the same load step.
        balance.w.settings.agree_at(balance.w.clock.step);
        if balance.w.settings.stops() || balance.w.settings.ends_at(balance.w.clock.step) {
            interrupted = true;
            break;
        }
        let start = Instant::now();
        let mut made = par::inside(|| balance.load_step())?;
        made.seconds = start.elapsed().as_secs_f64();
        note(&made);
        if made.broken > 0 {
            balance.renew(springs(balance.w));
        }
        all = Numbers {
            newton: all.newton + made.newton,
            products: all.products + made.products,
            broken: all.broken + made.broken,
            ..made
        };
        let c = &balance.w.clock;
        let (done, total) = (c.step - first, goal.steps);
        watch.step(&Made { done, total, step: c.step, time: c.time(), dt: c.dt });
        if watch.looks(balance.w) {
            watch.scene(balance.w);
        }
    }
    if let Some(families) = &mut *w.families {
        families.counts_warming = false;
    }
    let steps = w.clock.step - first;
    w.clock.stop = w.clock.last;
    all.seconds = clock.elapsed().as_secs_f64();
    let outcome = Outcome { steps, time: clock.elapsed(), cpu: cpu_seconds() - cpu, interrupted };
    Ok((outcome, all))
}

/// Forces of the scene as it is found, at rest: bodies are built in the first ones.
fn begin(plan: &mut StepPlan, w: &mut World) -> Result<()> {
    w.particles.v.fill([0.0; 3]);
    let t = tick(w, true);
    plan.run(w, &t, &[Stage::Neighbor, Stage::PreForce, Stage::Force, Stage::PostForce])?;
    if w.families.as_ref().is_some_and(|families| !families.breaking_enabled) {
        // Limits that rise under compression count from the stretches of the evaluation before.
        plan.run(w, &tick(w, false), &[Stage::PreForce, Stage::Force, Stage::PostForce])?;
    }
    if let Some(families) = &mut *w.families {
        families.counts_warming = true;
    }
    Ok(())
}

impl Balance<'_> {
    /// Energy and output of the first scene.
    fn begin(&mut self) -> Result<()> {
        let mut t = tick(self.w, true);
        self.plan.request_sums(&mut t);
        (t.energy, t.atom_energy) = (true, true);
        self.plan.run(self.w, &t, &[Stage::PreForce, Stage::Force])?;
        self.ledger.inner(self.w, &self.body);
        self.plan.run(self.w, &t, &[Stage::PostForce, Stage::EndOfStep])?;
        self.ledger.begin(self.w, &self.body);
        self.plan.reset_meters(true);
        self.plan.run(self.w, &t, &[Stage::Output])
    }

    /// Moves the clock by one load step and balances the body there.
    fn load_step(&mut self) -> Result<Numbers> {
        let mut made = Numbers::default();
        self.lead()?;
        self.follow(&mut made)?;
        for round in 0.. {
            let broken = self.settle(round > 0)?;
            if broken == 0 {
                break;
            }
            made.broken += broken;
            if round == self.goal.most {
                let text = format!("bonds still break after {round} equilibria of this load step");
                let d = Diagnostic::error(Code::HALTED, None, text);
                return Err(d.help("more load steps, or a larger `most`").into());
            }
            self.balance(&mut made)?;
        }
        (made.step, made.time) = (self.w.clock.step - self.w.clock.first, self.w.clock.time());
        made.ledger = self.ledger.numbers();
        Ok(made)
    }
}
