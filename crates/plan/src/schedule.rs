//! Ops in the order of a step, with what was left out and why.

use super::ending::{Ending, Usually};
use super::meter::{Stopwatch, Timing};
#[cfg(debug_assertions)]
use super::needs;
use super::needs::Needs;
use super::step::Rooms;
use super::{About, Guard, Meter, Op, OpClass, Span as Rows, Stage, Tick, When, share};
use perigrain_base::diag::{Diagnostics, Result, Span};
use perigrain_world::field::{CONTACTS, RADIUS, X};
use perigrain_world::named::Acting;
use perigrain_world::share::Traffic;
use perigrain_world::{Fields, World};
use std::ops::Range;
use std::time::Duration;

/// An op with its times and the command it came from.
pub struct Placed {
    /// The op.
    pub op: Box<dyn Op>,
    /// Its declaration; `when` may be the union of its readers' times, `level` what `run_style` and `fix_modify` set.
    pub about: About,
    /// The command that created it, for messages.
    pub from: Option<Span>,
    /// The value it provides, as `c_dmg`; empty for ops that provide none to others.
    pub provides: String,
    /// What it has cost.
    pub meter: Meter,
}

impl Placed {
    /// An op at its own times.
    pub fn new(op: Box<dyn Op>, from: Option<Span>) -> Self {
        Self { about: op.about(), op, from, provides: String::new(), meter: Meter::default() }
    }

    /// Its name and what it states.
    pub(super) fn stated(&self) -> (&str, Needs) {
        (&self.about.name, self.about.needs)
    }

    /// Lets the op act by itself, see [`Placed::timed`]; it touches what it states.
    pub(super) fn alone<T>(
        &mut self,
        w: &mut World,
        t: &Tick,
        clock: &mut Stopwatch,
        act: impl FnOnce(&mut dyn Op, &mut World) -> Result<T>,
    ) -> Result<T> {
        let (span, before) = (self.span(w, t), w.traffic());
        share::before(w, span, std::iter::once(self.about.needs));
        begin_watch(w);
        let outcome = self.timed(w, t, clock, act);
        // A failing op may read more of the scene to explain the failure.
        if outcome.is_ok() {
            end_watch(w, std::iter::once(self.stated()));
        }
        share::after(w, std::iter::once(self.about.needs));
        self.note(w, t, (span, before));
        outcome
    }

    /// Keeps what ranks have exchanged for the op in a quiet step.
    pub(super) fn note(&mut self, w: &World, t: &Tick, (span, before): (Rows, Traffic)) {
        if w.share.is_some() && t.quiet {
            self.meter.exchange(span, w.traffic().since(before));
        }
    }

    /// Of which rows the op needs values at this tick, where particles are shared out to ranks.
    pub(super) fn span(&mut self, w: &mut World, t: &Tick) -> Rows {
        match w.share {
            Some(_) if !(self.about.collective && t.collective) => self.op.span(w, t),
            _ => Rows::All,
        }
    }

    /// Lets the op act, and adds up what that costs; `clock` is when the one before was done.
    pub(super) fn timed<T>(
        &mut self,
        w: &mut World,
        t: &Tick,
        clock: &mut Stopwatch,
        act: impl FnOnce(&mut dyn Op, &mut World) -> Result<T>,
    ) -> Result<T> {
        let outcome = {
            let _names_are_known = Acting::op();
            act(&mut *self.op, w)
        };
        self.meter.calls += 1;
        if clock.runs() {
            self.meter.time += clock.lap();
            self.meter.reckon(self.op.bytes(w));
        }
        outcome.map_err(|e| placed_error(e, self, t))
    }
}

/// Clears the record of touched fields.
pub(super) fn begin_watch(w: &World) {
    #[cfg(debug_assertions)]
    w.touched();
    let _ = w;
}

/// Checks that the fields touched since are those that the ops state together: a debug build panics otherwise, a release build
/// does not check.
pub(super) fn end_watch<'a>(w: &World, ops: impl Iterator<Item = (&'a str, Needs)> + Clone) {
    #[cfg(debug_assertions)]
    if let Some(lie) = needs::lie(ops, w.touched()) {
        panic!("{lie}");
    }
    #[cfg(not(debug_assertions))]
    let _ = (w, ops);
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
    /// When the energy is read.
    pub energy: Vec<When>,
    /// When the virial is read.
    pub virial: Vec<When>,
    /// When per-particle energies are read.
    pub atom_energy: Vec<When>,
    /// When per-particle virials are read.
    pub atom_virial: Vec<When>,
    /// Fixes whose values something reads in every step, or within some steps.
    pub watched: Vec<String>,
    /// By how many quiet steps of a run more have gathered rows from all ranks than have not.
    pub(super) gathering: u32,
    /// The watch over the energy.
    pub guard: Option<Guard>,
    /// How many levels of steps there are (`run_style respa`), if more than one.
    pub levels: Option<usize>,
    /// The end of the last step has begun the present one.
    pub(super) begun: bool,
    /// In which steps ops are timed.
    pub(super) timing: Timing,
    /// Whether nothing reads forces between the drift and the next ones; unknown at first.
    pub(super) unread: Option<bool>,
    /// Steps in which only what acts in every step acts, in a run up to the step beside it.
    pub(super) quiet: (Range<i64>, i64),
    /// The ops of those steps, and the sums they request.
    pub(super) usually: Usually,
    pub(super) requested: Requested,
    /// The ending of quiet steps before quiet steps.
    pub(super) usual: Option<Box<Ending>>,
    /// Room that steps use again.
    pub(super) rooms: Rooms,
}

/// Which sums are requested at a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Requested {
    energy: bool,
    virial: bool,
    atom_energy: bool,
    atom_virial: bool,
    contacts: bool,
}

impl StepPlan {
    /// Adds an op at the end of its stage (ops of a stage keep the order in which they are added).
    pub fn add(&mut self, placed: Placed) {
        let stage = placed.about.stage;
        let at = self.ops.iter().position(|p| p.about.stage > stage).unwrap_or(self.ops.len());
        self.ops.insert(at, placed);
        (self.unread, self.quiet, self.usual) = (None, Default::default(), None);
        self.rooms = Rooms::default();
    }

    /// Gives every op the fields that all of them write, now that they are known.
    pub fn settle(&mut self) {
        let changed = self.ops.iter().fold(Fields::NONE, |all, p| all | p.about.needs.written_by_name());
        self.ops.iter_mut().for_each(|p| p.op.settle(changed));
    }

    /// Fills in which sums are requested at this tick.
    pub fn request_sums(&mut self, t: &mut Tick) {
        self.look_ahead(t);
        let requested = match self.is_quiet(t) && !t.ending {
            true => self.requested,
            false => self.requested_by(|w| t.ending || self.fires(w, t)),
        };
        t.quiet = self.is_quiet(t) && !t.ending && t.step < t.last;
        t.collective = !t.quiet || !self.watched.is_empty();
        t.energy = requested.energy;
        t.virial = requested.virial;
        t.atom_energy = requested.atom_energy;
        t.atom_virial = requested.atom_virial;
        t.contacts = requested.contacts;
    }

    /// Which sums the ops that act request.
    pub(super) fn requested_by(&self, acts: impl Fn(&When) -> bool) -> Requested {
        let any = |list: &[When]| list.iter().any(&acts);
        let (energy, virial, atoms) = (any(&self.energy), any(&self.virial), any(&self.atom_energy));
        let atom_virial = any(&self.atom_virial);
        // The contacts of this step exist once all forces do.
        let reads = |p: &Placed| {
            p.about.stage != Stage::Force && p.about.needs.reads(CONTACTS) && acts(&p.about.when)
        };
        Requested {
            energy: energy || atoms,
            virial: virial || atom_virial,
            atom_energy: atoms,
            atom_virial,
            contacts: atom_virial || self.ops.iter().any(reads),
        }
    }

    /// Runs the ops of some stages, which must be in order, at this tick: those that act in its level of steps.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn run(&mut self, w: &mut World, t: &Tick, stages: &[Stage]) -> Result<()> {
        let Some((first, end)) = stages.first().zip(stages.last()) else { return Ok(()) };
        if self.is_quiet(t) && !t.ending {
            return self.run_usual(w, t, stages);
        }
        let mut clock = None;
        // What acts now and then is timed each time.
        let mut own = None;
        let from = self.ops.partition_point(|p| p.about.stage < *first);
        for k in from..self.ops.len() {
            let p = &self.ops[k];
            if p.about.stage > *end {
                break;
            }
            if !stages.contains(&p.about.stage)
                || !p.about.level.acts(&t.phase)
                || (t.setup && !p.about.in_setup)
            {
                continue;
            }
            if t.ending && p.about.at_parting {
                // It acts once the run is over.
                continue;
            }
            let ends = t.ending && p.about.stage == Stage::Output && p.about.when != When::Never;
            if ends || self.fires(&p.about.when, t) {
                let clock = match self.ops[k].about.when {
                    When::Always => clock.get_or_insert_with(|| self.timing.clock(t)),
                    _ => {
                        clock = None;
                        own.insert(self.timing.running())
                    }
                };
                self.ops[k].alone(w, t, clock, |op, w| op.run(w, t))?;
            }
        }
        Ok(())
    }

    /// [`StepPlan::run`] in a step in which only what acts in every step acts.
    fn run_usual(&mut self, w: &mut World, t: &Tick, stages: &[Stage]) -> Result<()> {
        let places = self.usually.of(stages);
        if places.is_empty() {
            return Ok(());
        }
        // Of steps of one length all act whose stages follow each other without a gap.
        let all =
            t.phase.levels == 1 && stages[stages.len() - 1] as usize + 1 - stages[0] as usize == stages.len();
        let mut clock = self.timing.clock(t);
        for at in places {
            let p = &mut self.ops[self.usually.at(at)];
            if all || (stages.contains(&p.about.stage) && p.about.level.acts(&t.phase)) {
                p.alone(w, t, &mut clock, |op, w| op.run(w, t))?;
            }
        }
        Ok(())
    }

    /// Runs what saves a run that ended before its last step. The plan is finished by then: what its ops held of the scene
    /// is back in the world.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn part(&mut self, w: &mut World) -> Result<()> {
        let t = Tick { ending: true, ..Tick::between_runs(&w.clock) };
        let mut saving = self.ops.iter_mut().filter(|p| p.about.at_parting);
        saving.try_for_each(|p| p.alone(w, &t, &mut Stopwatch::all(), |op, w| op.run(w, &t)))
    }

    /// Runs what acts at the end of steps at the first tick of a run without motion: those that act in no setup too.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn end_first(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let later = Tick { setup: false, ..t.clone() };
        for p in self.ops.iter_mut().filter(|p| p.about.stage == Stage::EndOfStep) {
            let t = if p.about.in_setup { t } else { &later };
            if p.about.when.fires(t) {
                p.alone(w, t, &mut Stopwatch::all(), |op, w| op.run(w, t))?;
            }
        }
        Ok(())
    }

    /// Whether all ops that move particles report how far, and none makes them grow; ops that add or wrap particles rebuild lists
    /// anyway.
    pub fn reports_travel(&self) -> bool {
        let moves = |p: &&Placed| p.about.needs.changes(X | RADIUS);
        let anew = |p: &Placed| matches!(p.about.stage, Stage::Exchange | Stage::Neighbor);
        self.ops.iter().filter(moves).all(|p| anew(p) || p.about.reports_travel)
    }

    /// Makes force ops give the parts of the scene they hold back to the world; they take them again at their next step.
    ///
    /// # Errors
    /// As `finish`.
    pub fn release(&mut self, w: &mut World) -> Result<()> {
        self.ops.iter_mut().filter(|p| p.about.stage == Stage::Force).try_for_each(|p| p.op.finish(w))
    }

    /// Ends the run for every op.
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
        classes.map(|c| (c, self.ops.iter().filter(|p| p.about.class == c).map(|p| p.meter.time).sum()))
    }

    /// Sets all meters to zero; ops are timed from now on, or not.
    pub fn reset_meters(&mut self, timed: bool) {
        self.timing = if timed { Timing::default() } else { Timing::off() };
        for p in &mut self.ops {
            p.meter = Meter::default();
        }
    }
}

#[cold]
fn placed_error(e: Diagnostics, p: &Placed, t: &Tick) -> Diagnostics {
    let mut e = e;
    for d in &mut e.0 {
        if d.span.is_none() {
            d.span = p.from;
            d.help.push(format!("in op `{}` at step {}", p.about.name, t.step));
        }
    }
    e
}
