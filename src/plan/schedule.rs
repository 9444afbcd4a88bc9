//! Ops in the order of a step, with what was left out and why.

use super::{Beat, Guard, Meter, Op, OpClass, Stage, Tick, When};
use crate::diag::{Diagnostics, Result, Span};
use crate::world::World;
use std::time::{Duration, Instant};

/// An op with its times and the command it came from.
pub struct Placed {
    /// The op.
    pub op: Box<dyn Op>,
    /// When it acts (an op's own, or the union of its readers').
    pub when: When,
    /// The command that created it, for messages.
    pub from: Option<Span>,
    /// The value it provides, as `c_dmg`; empty for ops that provide none to others.
    pub provides: String,
    /// Whether it reads the world's contacts.
    pub reads_contacts: bool,
    /// What it has cost.
    pub meter: Meter,
}

impl Placed {
    /// An op at its own times.
    pub fn new(op: Box<dyn Op>, from: Option<Span>) -> Self {
        let (when, reads_contacts) = (op.when(), op.access().reads("contacts"));
        Self { op, when, from, provides: String::new(), reads_contacts, meter: Meter::default() }
    }
}

/// Something the plan does without, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// Why it is not needed.
    pub why: String,
}

/// The sealed step.
#[derive(Default)]
pub struct StepPlan {
    /// Ops in order.
    pub ops: Vec<Placed>,
    /// What was left out.
    pub left_out: Vec<LeftOut>,
    /// When somebody reads the energy.
    pub energy: Vec<When>,
    /// When somebody reads the virial.
    pub virial: Vec<When>,
    /// When somebody reads per-particle energies.
    pub atom_energy: Vec<When>,
    /// When somebody reads per-particle virials.
    pub atom_virial: Vec<When>,
    /// Who watches the energy.
    pub guard: Option<Guard>,
}

impl StepPlan {
    /// Adds an op at the end of its stage (ops of a stage keep the order in which they are added).
    pub fn add(&mut self, placed: Placed) {
        let stage = placed.op.stage();
        let at = self.ops.iter().position(|p| p.op.stage() > stage).unwrap_or(self.ops.len());
        self.ops.insert(at, placed);
    }

    /// Fills in which sums are asked for at this tick.
    pub fn ask(&self, t: &mut Tick) {
        let any = |list: &[When]| list.iter().any(|w| t.ending || w.fires(t));
        let (energy, virial, atoms) = (any(&self.energy), any(&self.virial), any(&self.atom_energy));
        let atom_virial = any(&self.atom_virial);
        t.energy = energy || atoms;
        t.virial = virial || atom_virial;
        t.atom_energy = atoms;
        t.atom_virial = atom_virial;
        let reads = |p: &Placed| p.reads_contacts && (t.ending || p.when.fires(t));
        t.contacts = atom_virial || self.ops.iter().any(reads);
    }

    /// Runs the ops of some stages at this tick.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn run(&mut self, w: &mut World, t: &Tick, stages: &[Stage]) -> Result<()> {
        self.run_beats(w, t, stages, &[Beat::Long, Beat::Short, Beat::Both])
    }

    /// Runs the ops of some stages at this tick, of those that act in some of the steps of two lengths.
    ///
    /// # Errors
    /// As `run`.
    pub fn run_beats(&mut self, w: &mut World, t: &Tick, stages: &[Stage], beats: &[Beat]) -> Result<()> {
        for p in &mut self.ops {
            let stage = p.op.stage();
            let fires = p.when.fires(t) || (t.ending && stage == Stage::Output && p.when != When::Never);
            if !stages.contains(&stage)
                || !beats.contains(&p.op.beat())
                || (t.setup && !p.op.in_setup())
                || !fires
            {
                continue;
            }
            let begin = Instant::now();
            let outcome = p.op.run(w, t);
            p.meter.time += begin.elapsed();
            p.meter.calls += 1;
            p.meter.bytes += p.op.bytes(w);
            outcome.map_err(|e| placed_error(e, p, t))?;
        }
        Ok(())
    }

    /// Makes ops of forces give what they hold of the scene back to the world; they take it up anew at their next step.
    ///
    /// # Errors
    /// As `finish`.
    pub fn release(&mut self, w: &mut World) -> Result<()> {
        self.ops.iter_mut().filter(|p| p.op.stage() == Stage::Force).try_for_each(|p| p.op.finish(w))
    }

    /// Tells every op that the run is over.
    ///
    /// # Errors
    /// All that went wrong.
    pub fn finish(&mut self, w: &mut World) -> Result<()> {
        let mut problems = Diagnostics::default();
        for p in &mut self.ops {
            if let Err(e) = p.op.finish(w) {
                problems.append(e);
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// Time spent per row of the timing table.
    pub fn time_by_class(&self) -> [(OpClass, Duration); 5] {
        let classes = [OpClass::Pair, OpClass::Neigh, OpClass::Output, OpClass::Modify, OpClass::Other];
        classes.map(|c| (c, self.ops.iter().filter(|p| p.op.class() == c).map(|p| p.meter.time).sum()))
    }

    /// Sets all meters to zero.
    pub fn reset_meters(&mut self) {
        for p in &mut self.ops {
            p.meter = Meter::default();
        }
    }
}

fn placed_error(e: Diagnostics, p: &Placed, t: &Tick) -> Diagnostics {
    let mut e = e;
    for d in &mut e.0 {
        if d.span.is_none() {
            d.span = p.from;
            d.help.push(format!("in op `{}` at step {}", p.op.name(), t.step));
        }
    }
    e
}
