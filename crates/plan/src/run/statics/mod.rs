//! Equilibria over a sealed plan, load step by load step: the load parameter is time.
//!
//! A load step moves the clock; what stands on a path moves there, loads that depend on time change, and the free particles
//! follow to the place where no force is left on them (Newton's method, its linear systems by conjugate gradients). Nothing
//! breaks, flows or is remembered while places are only tried. At an equilibrium the bonds stretched beyond their limit
//! break, some at a time, and the body is balanced again at the same loads.

mod adr;
mod balance;
mod bodies;
mod ledger;
mod linear;
mod opening;
mod path;

use super::verlet::{cpu_seconds, tick};
use super::{Made, Outcome, Watch};
use crate::{Stage, StepPlan, Tick};
pub(super) use balance::Balance;
pub use bodies::Body;
pub use ledger::Ledger;
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_statics::network::Network;
use perigrain_world::named::Constant;
use perigrain_world::{Halt, World};
use std::time::Instant;

/// The numbers of the load step that was made last.
pub static NUMBERS: Constant<Numbers> = Constant::new("statics");

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

/// How the load of a load step is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// Time moves by the same amount in each load step.
    Load,
    /// Time moves, forwards or back, to where the next bond is at its limit, and this bond breaks.
    Damage,
    /// Time moves, forwards or back, to where the bond that opens fastest has opened by so much of its length.
    Opening(f64),
}

/// How equilibria are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Newton's method and conjugate gradients.
    Newton,
    /// Adaptive dynamic relaxation.
    Adr,
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
    /// How its load is found.
    pub control: Control,
    /// Load steps end where the load has fallen to this share of its peak.
    pub until: Option<f64>,
    /// Load steps are cut where no balance is found.
    pub adapt: bool,
    /// How equilibria are found.
    pub solver: Solver,
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
    /// The estimated error of the energy norm, as a root of energy.
    pub error: f64,
    /// The larger one of the two-norms of reactions and loads [force].
    pub load: f64,
    /// Bonds that broke.
    pub broken: usize,
    /// Energies from the first load step on.
    pub ledger: Ledger,
    /// Wall time [s].
    pub seconds: f64,
}

/// What load steps read from a scene.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// The bonds that live, as springs.
    pub springs: fn(&World) -> Network,
    /// The largest load ratio of bonds, after an evaluation of forces.
    pub ratio: fn(&World) -> f64,
}

/// The springs of living bonds are found anew between load steps where more bonds than this have broken since: each makes a further step or two of
/// conjugate gradients, and springs with their clusters take as long as some thirty.
const STALE: usize = 12;

/// A body is out of balance where so many times the tolerance is left.
const UNSETTLED: f64 = 10.0;

/// Takes note of a load step.
pub type Note<'a> = &'a mut dyn FnMut(&Numbers);

/// Makes load steps until `goal.steps` are made; output appears as in a run. `body` finds what may move, once
/// forces have been computed; `note` gets the numbers of each load step.
///
/// # Errors
/// The first op's that fails; bodies that cannot be balanced.
pub fn statics(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    (body, scene): (impl FnOnce(&World) -> Result<Body>, Scene),
    goal: Goal,
    note: Note,
) -> Result<(Outcome, Numbers)> {
    let (first, clock, cpu) = (w.clock.step, Instant::now(), cpu_seconds());
    begin(plan, w)?;
    let body = body(w)?;
    let mut balance = Balance::new(plan, w, body, (scene, goal));
    balance.begin()?;
    implicit(balance.w, true);
    let mut all = Numbers { time: balance.w.clock.time(), ..Numbers::default() };
    let (mut interrupted, mut peak) = (false, 0.0f64);
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
        balance.renew(STALE);
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
        peak = peak.max(made.load);
        if balance.runs_away || goal.until.is_some_and(|share| made.load < share * peak) {
            break;
        }
    }
    balance.end()?;
    implicit(w, false);
    if let Some(families) = &mut *w.families {
        families.counts_warming = false;
    }
    let steps = w.clock.step - first;
    (w.clock.last, w.clock.stop) = (w.clock.step, w.clock.step);
    all.seconds = clock.elapsed().as_secs_f64();
    let outcome = Outcome { steps, time: clock.elapsed(), cpu: cpu_seconds() - cpu, interrupted };
    Ok((outcome, all))
}

/// Whether bonds flow, soften and relax where places are tried.
pub(super) fn implicit(w: &mut World, yes: bool) {
    if let Some(families) = &mut *w.families {
        families.implicit = yes;
    }
}

/// Forces of the scene as it is found, at rest: bodies are built in the first ones.
pub(super) fn begin(plan: &mut StepPlan, w: &mut World) -> Result<()> {
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
    /// Forces of the last equilibrium with all sums that output requests at some time: lines behind show them.
    pub(super) fn end(&mut self) -> Result<()> {
        let mut t = Tick { ending: true, trial: true, dt: self.time_left(), ..tick(self.w, false) };
        self.plan.request_sums(&mut t);
        self.w.slots.invalidate();
        self.plan.run(self.w, &t, &[Stage::PreForce, Stage::Force, Stage::PostForce])
    }

    /// Energy and output of the first scene.
    pub(super) fn begin(&mut self) -> Result<()> {
        self.w.facts.insert(*NUMBERS, Numbers { time: self.w.clock.time(), ..Numbers::default() });
        let t = self.tick_of_sums(true);
        self.plan.run(self.w, &t, &[Stage::PreForce, Stage::Force])?;
        self.ledger.inner(self.w, &self.body);
        self.plan.run(self.w, &t, &[Stage::PostForce, Stage::EndOfStep])?;
        self.ledger.begin(self.w, &self.body);
        // Out of balance under loads that stood before, as where bonds were cut between two lines: what that gives up is no error.
        let force = balance::norm(&self.unbalanced());
        self.unsettled = force > UNSETTLED * self.goal.tol * self.ledger.scale(self.w, &self.body);
        self.ledger.remembers = self
            .w
            .families
            .as_ref()
            .is_some_and(|families| families.remembers() && !families.knows_what_it_takes());
        self.plan.reset_meters(true);
        self.plan.run(self.w, &t, &[Stage::Output])
    }

    /// Makes one load step.
    fn load_step(&mut self) -> Result<Numbers> {
        let mut made = Numbers::default();
        (self.start, self.part) = (path::Start::of(self.w), [0.0; 2]);
        match self.goal.control {
            Control::Load => {
                self.reach_end(&mut made)?;
                self.finish(&mut made)?;
            }
            Control::Damage => {
                made.broken = self.reach_limit(&mut made)?;
                self.finish(&mut made)?;
                if made.broken > 0 {
                    self.rebalance(&mut made)?;
                    self.settle(true, false)?;
                    self.ratio.0 = self.load_ratio()?;
                }
            }
            Control::Opening(opening) => self.open(opening, &mut made)?,
        }
        self.w.clock.set_dt(self.start.dt());
        Ok(made)
    }

    /// Balances the body where the clock stands, and anew until no bond breaks there; `torn`: bonds have broken since it was balanced.
    pub(super) fn equilibrium(&mut self, made: &mut Numbers, torn: bool) -> Result<()> {
        self.rebalance(made)?;
        made.broken = self.cascade(torn, made)?;
        self.finish(made)
    }

    /// Notes the numbers of a load step, and lets output follow.
    pub(super) fn finish(&mut self, made: &mut Numbers) -> Result<()> {
        (made.step, made.time) = (self.w.clock.step - self.w.clock.first, self.w.clock.time());
        made.ledger = self.ledger.numbers();
        made.load = self.ledger.scale(self.w, &self.body);
        self.w.facts.insert(*NUMBERS, *made);
        self.output()
    }
}
