//! Fatigue over a sealed plan: equilibria at the upper load, and between them as many cycles as the bond that tires first bears.
//!
//! The loads stand; each equilibrium is a step of the clock that takes no time. Bonds beyond their limit break there as in
//! `statics`. Those whose life ends break behind it, and the body is balanced again from where it is.

use super::statics::{self, Balance, Body, Ledger, Numbers, Scene, begin, implicit};
use super::verlet::cpu_seconds;
use super::{Made, Outcome, Watch};
use crate::StepPlan;
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_world::{Halt, World};
use std::time::Instant;

/// What some cycles have done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tired {
    /// How many cycles.
    pub cycles: f64,
    /// Bonds whose life ended.
    pub broken: usize,
    /// The largest stretch of a bond at the upper load.
    pub stretch: f64,
}

/// Lets as many cycles pass as the bond that tires first bears, but no more than these.
pub type Tire<'a> = &'a mut dyn FnMut(&mut World, f64) -> Result<Tired>;

/// Takes note of an equilibrium.
pub type Note<'a> = &'a mut dyn FnMut(&Row) -> Result<()>;

/// How it stands behind an equilibrium and the cycles that follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Cycles so far.
    pub cycles: f64,
    /// Bonds that broke at the equilibrium, beyond their limit.
    pub torn: usize,
    /// Bonds whose life ended with these cycles.
    pub tired: usize,
    /// Both, of all equilibria.
    pub broken: usize,
    /// The largest stretch of a bond at the equilibrium.
    pub stretch: f64,
    /// Newton's steps.
    pub newton: usize,
    /// Products with the tangent stiffness.
    pub products: usize,
    /// Wall time [s].
    pub seconds: f64,
}

/// Why it is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All cycles have passed.
    Cycles,
    /// So many equilibria as there may be have been found.
    Equilibria,
    /// Bonds break without further cycles.
    RunsAway,
    /// A fix has ended it.
    Halted,
    /// It was ended from outside.
    Ended,
}

/// Finds equilibria and lets cycles pass between them until there were so many `cycles`, or `goal.steps` equilibria have been
/// found; output appears at equilibria, as in a run. `body` and `scene` as for [`statics::statics`], `note` gets each row.
///
/// # Errors
/// The first op's that fails; bodies that cannot be balanced.
pub fn fatigue(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    (body, scene): (impl FnOnce(&World) -> Result<Body>, Scene),
    (goal, cycles): (statics::Goal, f64),
    (tire, note): (Tire, Note),
) -> Result<(Outcome, End, Row, Ledger)> {
    let (first, clock, cpu) = (w.clock.step, Instant::now(), cpu_seconds());
    begin(plan, w)?;
    let body = body(w)?;
    let mut balance = Balance::new(plan, w, body, (scene, goal));
    balance.begin()?;
    implicit(balance.w, true);
    let (mut all, mut end, mut ledger) = (Row::default(), End::Equilibria, Ledger::default());
    let mut torn = false;
    while balance.w.clock.step < balance.w.clock.last && balance.w.clock.halt == Halt::No {
        // All ranks end behind the same equilibrium.
        balance.w.settings.agree_at(balance.w.clock.step);
        if balance.w.settings.stops() || balance.w.settings.ends_at(balance.w.clock.step) {
            end = End::Ended;
            break;
        }
        let start = Instant::now();
        balance.w.clock.step += 1;
        let mut made = Numbers::default();
        par::inside(|| balance.equilibrium(&mut made, torn))?;
        if balance.runs_away {
            end = End::RunsAway;
            break;
        }
        // The scene ends in equilibrium: nothing tires behind the last one.
        let more = balance.w.clock.step < balance.w.clock.last;
        let tired = if more { tire(balance.w, cycles - all.cycles)? } else { Tired::default() };
        if tired.broken > 0 {
            balance.look_at_energy()?;
            balance.ledger.broken(balance.w, &balance.body);
            balance.stale += tired.broken;
            balance.renew(0);
        }
        ledger = balance.ledger.numbers();
        torn = tired.broken > 0;
        all = Row {
            cycles: all.cycles + tired.cycles,
            torn: made.broken,
            tired: tired.broken,
            broken: all.broken + made.broken + tired.broken,
            stretch: tired.stretch,
            newton: all.newton + made.newton,
            products: all.products + made.products,
            seconds: start.elapsed().as_secs_f64(),
        };
        note(&Row { newton: made.newton, products: made.products, ..all })?;
        let c = &balance.w.clock;
        watch.step(&Made { done: c.step - first, total: goal.steps, step: c.step, time: c.time(), dt: c.dt });
        if watch.looks(balance.w) {
            watch.scene(balance.w);
        }
        if more && tired.broken == 0 {
            // The last cycles have ended no life: the scene is in equilibrium.
            end = End::Cycles;
            break;
        }
    }
    if balance.w.clock.halt != Halt::No {
        end = End::Halted;
    }
    balance.end()?;
    implicit(w, false);
    let steps = w.clock.step - first;
    (w.clock.last, w.clock.stop) = (w.clock.step, w.clock.step);
    all.seconds = clock.elapsed().as_secs_f64();
    let interrupted = end == End::Ended;
    let outcome = Outcome { steps, time: clock.elapsed(), cpu: cpu_seconds() - cpu, interrupted };
    Ok((outcome, end, all, ledger))
}
