//! Velocity Verlet over a sealed plan: the loop, short enough to read aloud.

use super::guarded::{Guarded, Verdict};
use crate::{Stage, StepPlan, Tick};
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_base::stop;
use perigrain_world::columns::HEATFLOW;
use perigrain_world::named::Acting;
use perigrain_world::{Fields, Halt, World};
use std::time::{Duration, Instant};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Steps made.
    pub steps: i64,
    /// Wall time of the steps, setup not included.
    pub time: Duration,
    /// CPU time of the whole process during the steps.
    pub cpu: f64,
    /// Ended from outside before the last step.
    pub interrupted: bool,
}

/// Where a run stands after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    /// Steps of this run that are made.
    pub done: i64,
    /// Steps of this run.
    pub total: i64,
    /// The step counter.
    pub step: i64,
    /// Elapsed time [time units of the deck].
    pub time: f64,
    /// Step size [time units of the deck].
    pub dt: f64,
}

/// Observes a run step by step, for a progress bar or a film.
pub trait Watch: Send {
    /// A run of `steps` steps was requested; it may be made in several stretches.
    fn requested(&mut self, _steps: i64) {}
    /// A run begins; its setup comes next.
    fn begins(&mut self, _w: &World) {}
    /// A step is made.
    fn step(&mut self, made: &Made);
    /// Whether the scene is wanted after the next step, whose number the clock holds.
    fn looks(&mut self, _w: &World) -> bool {
        false
    }
    /// The scene after a step for which [`Watch::looks`] returned `true`; all collective results are up to date.
    fn scene(&mut self, _w: &World) {}
}

/// Computes forces at the start of a run and makes its first outputs.
///
/// When the scene is `unchanged` since the last run, forces, bonds and contact history are kept, and a run cut in two equals one
/// run to the bit; only sums that were not requested before are computed.
///
/// # Errors
/// The first op's that fails.
pub fn setup(plan: &mut StepPlan, w: &mut World, unchanged: bool) -> Result<()> {
    let mut t = tick(w, true);
    t.unchanged = unchanged;
    plan.request_sums(&mut t);
    if unchanged {
        w.rebuild.builds = 0;
        w.rebuild.dangerous = 0;
        tally_anew(plan, w, &t)?;
        return plan.run(w, &t, &[Stage::Output]);
    }
    plan.run(w, &t, &[Stage::Neighbor, Stage::PreForce, Stage::Force, Stage::PostForce])?;
    plan.run(w, &t, &[Stage::InitialIntegrate, Stage::PostIntegrate, Stage::FinalIntegrate])?;
    plan.run(w, &t, &[Stage::EndOfStep, Stage::Output])
}

/// Energy and virial of the present state where the last step did not tally them; forces stay as they are.
fn tally_anew(plan: &mut StepPlan, w: &mut World, t: &Tick) -> Result<()> {
    let have = &w.tally;
    let stands = have.step == Some(t.step);
    let enough = (!t.energy || stands)
        && (!t.virial || (stands && have.with_virial))
        && (!t.atom_energy || (stands && have.with_atoms))
        && (!t.atom_virial || (stands && have.with_atom_virial));
    if enough {
        return Ok(());
    }
    let kept = (w.particles.f.clone(), w.particles.torque.clone());
    let n = w.particles.len();
    let warm = w.columns.property(*HEATFLOW).map(|key| (w.columns.scalar(key, n).clone(), key));
    // Fixes see that nothing has changed: they add their virial and leave the forces alone.
    plan.run(w, t, &[Stage::PreForce, Stage::Force, Stage::PostForce])?;
    if let Some((heat, key)) = warm {
        *w.columns.scalar(key, n) = heat;
    }
    (w.particles.f, w.particles.torque) = kept;
    Ok(())
}

/// Makes the steps `clock.first + 1 ..= clock.last`.
///
/// # Errors
/// The first op's that fails; the world is then as that op left it.
pub fn verlet(plan: &mut StepPlan, w: &mut World, watch: &mut dyn Watch) -> Result<Outcome> {
    w.travel.begin(plan.guard.is_none() && plan.reports_travel());
    // A guard may take steps back.
    let sure = plan.guard.is_none();
    plan.deal(w, w.clock.last - w.clock.step);
    let outcome =
        steps(plan, w, watch, |plan, w, t, looked| plan.step(w, t, |w| sure && !looked && !over(w)));
    match outcome {
        Ok(_) => w.undeal(),
        // Ranks need not have come to the same place.
        Err(_) => w.part(),
    }
    w.travel.begin(false);
    outcome
}

/// Whether the present step is the last one, or the run has been requested to end.
fn over(w: &World) -> bool {
    let c = &w.clock;
    c.step >= c.last || c.halt != Halt::No || w.settings.stops() || w.settings.ends_at(c.step)
}

/// The stages of a step before anything is put out.
pub(super) const MOTION: [Stage; 8] = [
    Stage::InitialIntegrate,
    Stage::PostIntegrate,
    Stage::Exchange,
    Stage::Neighbor,
    Stage::PreForce,
    Stage::Force,
    Stage::PostForce,
    Stage::FinalIntegrate,
];

/// And those that put out.
const OUTPUTS: [Stage; 2] = [Stage::EndOfStep, Stage::Output];

/// Makes the steps of a run, each by `step`, with a flag whether the scene is read after it, and then its outputs.
///
/// # Errors
/// As [`verlet`].
pub(super) fn steps(
    plan: &mut StepPlan,
    w: &mut World,
    watch: &mut dyn Watch,
    step: impl Fn(&mut StepPlan, &mut World, &Tick, bool) -> Result<()> + Sync,
) -> Result<Outcome> {
    let (begin, cpu) = (Instant::now(), cpu_seconds());
    let (first, last) = (w.clock.step, w.clock.last);
    let ramps_end_here = w.clock.stop == last;
    let mut guard = match plan.guard.take() {
        Some(guard) => Some(Guarded::new(guard, plan, w)?),
        None => None,
    };
    // All of it on one thread of the pool: to hand over at every step would take longer than many a step.
    let mut trial = par::Trial::begin();
    let ended = par::inside(|| -> Result<Option<Early>> {
        let mut ended = None;
        while w.clock.step < w.clock.last && w.clock.halt == Halt::No {
            // A step whose first half is made is made as it was begun.
            if !plan.begun() {
                w.settings.agree_at(w.clock.step);
                ended = ended.or_else(|| Early::requested(w));
                if ended.is_some() && !Early::one_more(w, first) {
                    break;
                }
            }
            let _names_are_known = Acting::op();
            let builds = w.rebuild.builds;
            w.clock.step += 1;
            let mut t = tick(w, false);
            plan.request_sums(&mut t);
            let looked = watch.looks(w);
            match &mut guard {
                None => {
                    let traffic = w.traffic();
                    step(plan, w, &t, looked)?;
                    plan.run(w, &t, &OUTPUTS)?;
                    plan.judge_shares(w, &t, traffic);
                }
                Some(guard) => {
                    let made = step(plan, w, &t, looked);
                    if guard.judge(plan, w, &t, made)? == Verdict::Back {
                        continue;
                    }
                    plan.run(w, &t, &OUTPUTS)?;
                    guard.keep(plan, w, &t)?;
                }
            }
            let c = &w.clock;
            let (done, total) = (c.step - first, last - first);
            watch.step(&Made { done, total, step: c.step, time: c.time(), dt: c.dt });
            if looked {
                w.whole(Fields::ALL);
                watch.scene(w);
            }
            if let Some(trial) = &mut trial {
                trial.step(w.rebuild.builds != builds);
            }
        }
        Ok(ended)
    })?;
    drop(trial);
    plan.guard = guard.map(Guarded::into_guard);
    let steps = w.clock.step - first;
    if ended.is_some() && ramps_end_here {
        w.clock.stop = w.clock.step;
    }
    if ended == Some(Early::TimedOut) {
        w.clock.halt = Halt::All;
    }
    let interrupted = ended == Some(Early::Interrupted);
    Ok(Outcome { steps, time: begin.elapsed(), cpu: cpu_seconds() - cpu, interrupted })
}

/// Why a run ends before the last step that the deck requests.
///
/// The next step is made as the last one of a shorter run: its row, its sums and its files are those of a run of that length, and
/// so is the scene it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Early {
    /// A signal, or a program around this one.
    Interrupted,
    /// The time limit.
    TimedOut,
}

impl Early {
    /// Whether the run has to end, and why.
    fn requested(w: &World) -> Option<Self> {
        if w.settings.stops() {
            return Some(Self::Interrupted);
        }
        w.settings.ends_at(w.clock.step).then_some(Self::TimedOut)
    }

    /// Makes the next step the last one; `false` where no step is made yet: the run ends as it is.
    fn one_more(w: &mut World, first: i64) -> bool {
        let some = w.clock.step > first;
        w.clock.last = w.clock.step + i64::from(some);
        some
    }
}

/// Forces and output for each scene that `next` puts in; nothing moves. `next` returns `false` when there are no more.
///
/// # Errors
/// The first op's that fails, and those of `next`.
pub fn look(
    plan: &mut StepPlan,
    w: &mut World,
    mut next: impl FnMut(&mut World) -> Result<bool>,
) -> Result<Outcome> {
    let (begin, cpu) = (Instant::now(), cpu_seconds());
    let (mut steps, mut interrupted) = (0, false);
    loop {
        w.settings.agree(None);
        interrupted |= w.settings.stops();
        if !interrupted {
            // The time limit.
            stop::check()?;
        }
        if interrupted || !next(w)? {
            break;
        }
        let mut shown = tick(w, steps == 0);
        plan.request_sums(&mut shown);
        let forces = Tick { setup: true, ..shown.clone() };
        plan.run(w, &forces, &[Stage::Neighbor, Stage::PreForce, Stage::Force, Stage::PostForce])?;
        if shown.setup {
            plan.end_first(w, &shown)?;
        } else {
            plan.run(w, &shown, &[Stage::EndOfStep])?;
        }
        plan.run(w, &shown, &[Stage::Output])?;
        plan.release(w)?;
        steps += 1;
    }
    Ok(Outcome { steps, time: begin.elapsed(), cpu: cpu_seconds() - cpu, interrupted })
}

/// The tick of the step the clock stands at.
pub(super) fn tick(w: &World, setup: bool) -> Tick {
    let c = &w.clock;
    Tick { first: c.first, last: c.last, setup, unchanged: false, ..Tick::between_runs(c) }
}

/// User + system time of this process [s], from /proc where there is one, else 0.
pub(super) fn cpu_seconds() -> f64 {
    let Ok(stat) = std::fs::read_to_string("/proc/self/stat") else { return 0.0 };
    let Some((_, rest)) = stat.rsplit_once(')') else { return 0.0 };
    let fields: Vec<f64> = rest.split_whitespace().map(|s| s.parse().unwrap_or(0.0)).collect();
    // utime and stime are fields 14 and 15 of proc(5); ticks are 1/100 s on Linux.
    fields.get(11).zip(fields.get(12)).map_or(0.0, |(u, s)| (u + s) / 100.0)
}
