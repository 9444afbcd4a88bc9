//! Ops in the order of a step, with what was left out and why.

use super::ending::Ending;
use super::meter::{Stopwatch, Timing};
use super::needs::{self, Needs};
use super::{About, Act, BlockSums, FusedPass, Guard, Meter, Op, OpClass, Stage, Tick, When, fuse};
use perigrain_base::diag::{Diagnostics, Result, Span};
use perigrain_world::field::{CONTACTS, RADIUS, X};
use perigrain_world::named::Acting;
use perigrain_world::{Fields, World};
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// An op with its times and the command it came from.
pub struct Placed {
    /// The op.
    pub op: Box<dyn Op>,
    /// What it tells of itself; `when` may be the union of its readers' times, `level` what `run_style` and `fix_modify` say.
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
    fn stated(&self) -> (&str, Needs) {
        (&self.about.name, self.about.needs)
    }

    /// Lets the op act by itself, see [`Placed::timed`]; it touches what it states.
    fn alone<T>(
        &mut self,
        w: &mut World,
        t: &Tick,
        clock: &mut Stopwatch,
        act: impl FnOnce(&mut dyn Op, &mut World) -> Result<T>,
    ) -> Result<T> {
        begin_watch(w);
        let outcome = self.timed(w, t, clock, act);
        // Who fails may look around for words that help.
        if outcome.is_ok() {
            end_watch(w, std::iter::once(self.stated()));
        }
        outcome
    }

    /// Lets the op act, and adds up what that costs; `clock` is when the one before was done.
    fn timed<T>(
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
        self.meter.time += clock.lap();
        self.meter.calls += 1;
        self.meter.bytes += self.op.bytes(w);
        outcome.map_err(|e| placed_error(e, self, t))
    }
}

/// Forgets what has been touched so far.
fn begin_watch(w: &World) {
    #[cfg(debug_assertions)]
    w.touched();
    let _ = w;
}

/// What ops have touched since is what they state, together: a debug build ends where that is not so, a release does not ask.
fn end_watch<'a>(w: &World, ops: impl Iterator<Item = (&'a str, Needs)>) {
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

/// So many particles are moved without looking at the clock.
const FEW: usize = 200;

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
    /// How many levels of steps there are (`run_style respa`), if more than one.
    pub levels: Option<usize>,
    /// The end of the last step has begun the present one.
    begun: bool,
    /// In which steps ops are timed.
    timing: Timing,
    /// Whether nobody reads forces between the drift and the next ones; unknown at first.
    pub(super) unread: Option<bool>,
    /// Steps in which only what acts in every step acts, in a run up to the step beside it.
    pub(super) quiet: (Range<i64>, i64),
    /// The ending of quiet steps before quiet steps.
    pub(super) usual: Option<Arc<Ending>>,
}

impl StepPlan {
    /// Adds an op at the end of its stage (ops of a stage keep the order in which they are added).
    pub fn add(&mut self, placed: Placed) {
        let stage = placed.about.stage;
        let at = self.ops.iter().position(|p| p.about.stage > stage).unwrap_or(self.ops.len());
        self.ops.insert(at, placed);
        (self.unread, self.quiet, self.usual) = (None, Default::default(), None);
    }

    /// Tells every op what all of them write, now that they are known.
    pub fn settle(&mut self) {
        let changed = self.ops.iter().fold(Fields::NONE, |all, p| all | p.about.needs.written_by_name());
        self.ops.iter_mut().for_each(|p| p.op.settle(changed));
    }

    /// Fills in which sums are asked for at this tick.
    pub fn ask(&mut self, t: &mut Tick) {
        self.look_ahead(t);
        let any = |list: &[When]| list.iter().any(|w| t.ending || self.fires(w, t));
        let (energy, virial, atoms) = (any(&self.energy), any(&self.virial), any(&self.atom_energy));
        let atom_virial = any(&self.atom_virial);
        // Those of this step are there when all forces are.
        let reads = |p: &Placed| {
            p.about.stage != Stage::Force
                && p.about.needs.reads(CONTACTS)
                && (t.ending || self.fires(&p.about.when, t))
        };
        let contacts = atom_virial || self.ops.iter().any(reads);
        t.energy = energy || atoms;
        t.virial = virial || atom_virial;
        t.atom_energy = atoms;
        t.atom_virial = atom_virial;
        t.contacts = contacts;
    }

    /// Runs the ops of some stages, which must be in order, at this tick: those that act in its level of steps.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn run(&mut self, w: &mut World, t: &Tick, stages: &[Stage]) -> Result<()> {
        let Some((first, end)) = stages.first().zip(stages.last()) else { return Ok(()) };
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
            let ends = t.ending && p.about.stage == Stage::Output && p.about.when != When::Never;
            if ends || self.fires(&p.about.when, t) {
                let clock = match self.ops[k].about.when {
                    When::Always => clock.get_or_insert_with(|| self.timing.clock(t)),
                    _ => {
                        clock = None;
                        own.insert(Stopwatch::all())
                    }
                };
                self.ops[k].alone(w, t, clock, |op, w| op.run(w, t))?;
            }
        }
        Ok(())
    }

    /// Runs what saves a run that ends before its last step, unless it acted at this step.
    ///
    /// # Errors
    /// The first op's that fails, with the place of its command.
    pub fn part(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        for k in 0..self.ops.len() {
            let about = &self.ops[k].about;
            if about.at_parting && !self.fires(&about.when, t) {
                self.ops[k].alone(w, t, &mut Stopwatch::all(), |op, w| op.run(w, t))?;
            }
        }
        Ok(())
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

    /// Whether all that move particles report how far, and none grows; who adds or wraps particles has lists made anew.
    pub fn reports_travel(&self) -> bool {
        let moves = |p: &&Placed| p.about.needs.changes(X | RADIUS);
        let anew = |p: &Placed| matches!(p.about.stage, Stage::Exchange | Stage::Neighbor);
        self.ops.iter().filter(moves).all(|p| anew(p) || p.about.reports_travel)
    }

    /// Whether the last step has made the beginning of the next one, which has to be made then.
    pub fn begun(&self) -> bool {
        self.begun
    }

    /// Makes one step up to its outputs. Ops that act on each particle by itself are fused after the forces. Where `more`
    /// steps are sure to follow and nobody looks in between, the last kick is made with the first one of the next step.
    ///
    /// # Errors
    /// The first op's that fails.
    pub fn step(&mut self, w: &mut World, t: &Tick, more: impl Fn(&World) -> bool) -> Result<()> {
        use Stage::{InitialIntegrate, PostIntegrate};
        let Self { timing, ops, .. } = self;
        timing.step(|| ops.iter().map(|p| p.meter.time).sum());
        if !self.goes_on() {
            self.run(w, t, &[InitialIntegrate])?;
        }
        self.run(w, t, &[PostIntegrate, Stage::Exchange, Stage::Neighbor, Stage::PreForce])?;
        if self.force_and_end(w, t, &more)? {
            return Ok(());
        }
        self.run(w, t, &[Stage::Force])?;
        self.end(w, t, more)
    }

    /// Where one op alone adds forces and all that follows acts on each particle by itself: particles that have all their forces
    /// are moved while they are in fast memory, if the op tells who has. Every particle sees the same as otherwise. `false` where
    /// that is not so, and nothing has been done.
    fn force_and_end(&mut self, w: &mut World, t: &Tick, more: &impl Fn(&World) -> bool) -> Result<bool> {
        let ending = self.ending(t);
        let Some(force) = ending.force else { return Ok(false) };
        let (order, clears) = (&ending.order[..], ending.clears);
        let last = ending.last.filter(|_| more(w));
        if needs::collecting() {
            return Ok(false);
        }
        begin_watch(w);
        let acts = self.offers(w, t, order, [last, clears]);
        let pass = FusedPass::new(&acts, w.n()).filter(|_| !acts.is_empty() && acts.len() == order.len());
        let Some(mut pass) = pass else { return Ok(false) };
        let (mut clock, mut moving) = (self.timing.clock(t), Duration::ZERO);
        let looks = clock;
        let p = &mut self.ops[force];
        let told = p.timed(w, t, &mut clock, |op, w| {
            op.run_streaming(w, t, &mut |w, particles| {
                // To look at the clock takes longer than to move a few particles.
                match particles.len() > FEW {
                    true => moving += looks.of(|| pass.ready(w, particles)),
                    false => pass.ready(w, particles),
                }
            })
        })?;
        p.meter.time = p.meter.time.saturating_sub(moving);
        let sums = if told { pass.finish() } else { fuse(w, &acts) };
        self.fused(w, t, (order, last), sums, moving + clock.lap());
        end_watch(w, std::iter::once(&force).chain(order).map(|&k| self.ops[k].stated()));
        Ok(true)
    }

    /// Tells ops what came of a fused pass, which took so long.
    fn fused(
        &mut self,
        w: &mut World,
        t: &Tick,
        (ops, last): (&[usize], Option<usize>),
        sums: Vec<BlockSums>,
        elapsed: Duration,
    ) {
        let each = elapsed / sums.len().max(1) as u32;
        for (&k, sum) in ops.iter().zip(sums) {
            let p = &mut self.ops[k];
            p.op.fused(w, t, sum);
            p.meter.time += each;
            p.meter.calls += 1;
            p.meter.bytes += p.op.bytes(w);
            self.begun |= last == Some(k);
        }
    }

    /// What these ops, from the first on, do to blocks of particles. The last kick of the step goes on into the next one, and what
    /// clears forces then, if there is one.
    fn offers(&self, w: &World, t: &Tick, ops: &[usize], [last, clears]: [Option<usize>; 2]) -> Vec<Act> {
        let goes_on = |k: usize| last == Some(k) || (last.is_some() && clears == Some(k));
        let on = Tick { on: true, ..t.clone() };
        ops.iter().map_while(|&k| self.ops[k].op.fusible(w, if goes_on(k) { &on } else { t })).collect()
    }

    /// Whether the step before has made the beginning of this one.
    pub fn goes_on(&mut self) -> bool {
        std::mem::take(&mut self.begun)
    }

    /// What is left of a step, or of one of a level, after its forces. Ops that act on each particle by itself are fused;
    /// `more` as for [`StepPlan::step`].
    ///
    /// # Errors
    /// The first op's that fails.
    pub fn end(&mut self, w: &mut World, t: &Tick, more: impl Fn(&World) -> bool) -> Result<()> {
        let ending = self.ending(t);
        let (order, clears) = (&ending.order[..], ending.clears);
        let (mut at, mut clock) = (0, self.timing.clock(t));
        while at < order.len() {
            let last = ending.last.filter(|_| self.begun || more(w));
            begin_watch(w);
            let mut acts = self.offers(w, t, &order[at..], [last, clears]);
            acts.truncate(if needs::collecting() { 1 } else { acts.len() });
            if acts.is_empty() {
                let (k, p) = (order[at], &mut self.ops[order[at]]);
                let on = last == Some(k) && t.phase.levels == 1 && p.about.goes_on;
                if !self.begun && clears != Some(k) {
                    let t = Tick { on, ..t.clone() };
                    p.alone(w, &t, &mut clock, |op, w| op.run(w, &t))?;
                }
                self.begun |= on;
                if !self.begun && last == Some(k) {
                    return Ok(());
                }
                at += 1;
                continue;
            }
            let sums = fuse(w, &acts);
            let elapsed = clock.lap();
            self.fused(w, t, (&order[at..], last), sums, elapsed);
            end_watch(w, order[at..at + acts.len()].iter().map(|&k| self.ops[k].stated()));
            at += acts.len();
        }
        Ok(())
    }

    /// Makes ops of forces give what they hold of the scene back to the world; they take it up anew at their next step.
    ///
    /// # Errors
    /// As `finish`.
    pub fn release(&mut self, w: &mut World) -> Result<()> {
        self.ops.iter_mut().filter(|p| p.about.stage == Stage::Force).try_for_each(|p| p.op.finish(w))
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
        classes.map(|c| (c, self.ops.iter().filter(|p| p.about.class == c).map(|p| p.meter.time).sum()))
    }

    /// Sets all meters to zero.
    pub fn reset_meters(&mut self) {
        self.timing = Timing::default();
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
            d.help.push(format!("in op `{}` at step {}", p.about.name, t.step));
        }
    }
    e
}
