//! Steps of several lengths within each other: each level has forces of its own, and a step of it holds steps of the next.
//!
//! The reversible scheme of Tuckerman, Berne & Martyna (1992): the forces of a level kick by half of its step at both ends
//! of it, and what lies between is a whole number of steps of the level below; particles drift in the shortest ones.
//! `run_style respa` is just that, with lists made anew at the beginning of a long step as in LAMMPS; of two levels for
//! grains and solids (`staggered`) the long one moves the grains, and lists follow once all have moved. Contacts of a level see
//! paths of its step (`path.rs`).

use super::path::{self, Path};
use super::verlet::tick;
use crate::{Phase, Solids, Stage, StepPlan, Tick};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::stop;
use perigrain_world::columns::{self, HEATFLOW};
use perigrain_world::{Vectors, World};
use std::cell::Cell;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a step may continue after a signal, to end as a whole one.
const PATIENCE: Duration = Duration::from_secs(2);

/// Levels of steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// How many steps of a level one of the next holds, from the shortest.
    pub loops: Vec<i64>,
    /// Of two levels: the particles that move in the short steps, and only there.
    pub solids: Option<Arc<Solids>>,
    /// What each level has of its own, from the shortest.
    pub(super) own: Arc<[columns::Level]>,
}

/// What of the steps under way is added up in the shortest ones: where mean spins of a level stand, and how many of the shortest
/// its step holds.
type Spins = Vec<(Vectors, i64)>;

impl Levels {
    /// Levels of which each holds so many steps of the one before.
    pub fn new(loops: Vec<i64>, solids: Option<Arc<Solids>>) -> Self {
        let own = (0..=loops.len()).map(columns::Level::new).collect();
        Self { loops, solids, own }
    }

    /// Removes the columns of all levels.
    pub(super) fn forget(&self, w: &mut World) {
        for own in self.own.iter() {
            own.forces.into_iter().chain(own.path).for_each(|key| w.columns.remove(key));
            w.columns.remove(own.heat);
        }
    }

    /// How many there are.
    fn count(&self) -> usize {
        self.loops.len() + 1
    }

    /// A tick as the ops of a level see it.
    pub(super) fn at(&self, t: &Tick, level: usize) -> Tick {
        let phase = Phase { level, levels: self.count(), solids: self.solids.clone(), path: [None; 2] };
        Tick { phase, ..t.clone() }
    }

    /// How many of the shortest steps a step of a level holds.
    fn shortest(&self, level: usize) -> i64 {
        self.loops[..level].iter().product()
    }

    /// Begins the path of a step of a level that holds shorter ones and has contacts. LAMMPS knows none.
    fn begin_path(&self, plan: &StepPlan, w: &mut World, here: &Phase, spins: &mut Spins) -> Option<Path> {
        let lammps = here.nested() && w.settings.lammps();
        if here.level == 0 || lammps || !path::remembers(plan, here) {
            return None;
        }
        let own = &self.own[here.level];
        if w.particles.style.sphere && path::turns_within(plan, here) {
            spins.push((path::begin_spins(w, own), self.shortest(here.level)));
        }
        Some(Path::begin(w, own))
    }

    /// Ends it: where contacts find it. In steps of two lengths grains move in one piece.
    fn end_path(&self, w: &mut World, t: &mut Tick, way: Option<Path>, spins: &mut Spins) {
        let Some(way) = way else { return };
        let grain = |kind| self.solids.as_ref().is_some_and(|solids| !solids.has(kind));
        let spin = self.own[t.phase.level].path[1];
        t.phase.path = [Some(way.end(w, t.dt, grain)), spins.pop_if(|(key, _)| *key == spin).map(|s| s.0)];
    }
}

/// Whether the forces of all levels are kept, and belong to these particles.
pub fn stand(w: &World, l: &Levels) -> bool {
    let (n, kinds) = (w.n(), if w.particles.style.sphere { 2 } else { 1 });
    let whole = |key: &Vectors| w.columns.get_vector(*key).is_some_and(|c| c.len() == n);
    let warm = w.columns.property(*HEATFLOW).is_some();
    let heat = |key| !warm || w.columns.get_scalar(key).is_some_and(|c| c.len() == n);
    l.own.iter().all(|own| own.forces.iter().take(kinds).all(whole) && heat(own.heat))
}

/// Forces of all levels at the start of a run, and its first outputs.
///
/// # Errors
/// The first op's that fails.
pub fn setup(plan: &mut StepPlan, w: &mut World, unchanged: bool, l: &Levels) -> Result<()> {
    if unchanged && stand(w, l) {
        return super::verlet::setup(plan, w, true);
    }
    let mut t = tick(w, true);
    plan.request_sums(&mut t);
    plan.run(w, &l.at(&t, l.count() - 1), &[Stage::Neighbor])?;
    w.columns.forget_levels();
    for stages in first_forces(w) {
        for k in 0..l.count() {
            exchange(w, l, k);
            plan.run(w, &l.at(&t, k), stages)?;
            exchange(w, l, k);
        }
    }
    // Weights are those of the masses that the outermost level leaves (`fix adapt`).
    for k in 0..l.count() {
        exchange(w, l, k);
        plan.run(w, &l.at(&t, k), &[Stage::PostForce])?;
        exchange(w, l, k);
    }
    join(w, l);
    plan.run(w, &t, &[Stage::InitialIntegrate, Stage::PostIntegrate, Stage::FinalIntegrate])?;
    plan.run(w, &t, &[Stage::EndOfStep, Stage::Output])
}

/// What is done level by level before the first forces, and what then: all that the outermost level changes holds for forces of
/// every level, but not in LAMMPS.
fn first_forces(w: &World) -> &'static [&'static [Stage]] {
    match w.settings.lammps() {
        true => &[&[Stage::PreForce, Stage::Force]],
        false => &[&[Stage::PreForce], &[Stage::Force]],
    }
}

/// One step of the outermost level up to its outputs.
///
/// # Errors
/// The first op's that fails.
pub fn step(plan: &mut StepPlan, w: &mut World, t: &Tick, l: &Levels) -> Result<()> {
    level(plan, w, t, (l, l.count() - 1), (false, &mut vec![]), &Waiting::default())?;
    join(w, l);
    Ok(())
}

/// A long step after a signal: it is completed if its end is near.
#[derive(Default)]
struct Waiting {
    since: Cell<Option<Instant>>,
}

impl Waiting {
    /// # Errors
    /// The wait is over, and this many short steps are made in this many.
    fn check(&self, step: i64, made: i64, all: i64) -> Result<()> {
        if !stop::present().must_end() {
            return Ok(());
        }
        let Some(since) = self.since.get() else {
            self.since.set(Some(Instant::now()));
            return Ok(());
        };
        if since.elapsed() < PATIENCE || !stop::cuts() {
            return Ok(());
        }
        let text = format!(
            "in the middle of step {step}, after {made} of the {all} short steps that fill a longer one"
        );
        let help = "no restart file holds such a scene: continue from one that `restart N` has written at a whole step";
        Err(Diagnostic::error(Code::INTERRUPTED, None, text).help(help).into())
    }
}

/// One step of a level. Of the steps in it only the last computes its sums: it ends where the step ends. In the shortest level
/// the last kick is made together with the first one of the next step where `more` follow at once.
fn level(
    plan: &mut StepPlan,
    w: &mut World,
    t: &Tick,
    (l, k): (&Levels, usize),
    (more, spins): (bool, &mut Spins),
    waiting: &Waiting,
) -> Result<()> {
    let mut here = l.at(t, k);
    let (first, last) = (here.phase.nested(), here.phase.outermost());
    exchange(w, l, k);
    let way = l.begin_path(plan, w, &here.phase, spins);
    if !plan.take_begun() {
        plan.run(w, &here, &[Stage::InitialIntegrate])?;
    }
    if first && last {
        news(plan, w, &here, way)?;
        if let Some(way) = way {
            way.leave(w);
        }
    }
    match k.checked_sub(1) {
        None => spins.iter().for_each(|(key, steps)| path::add_spins(w, *key, *steps)),
        Some(below) => {
            let m = l.loops[below];
            let lasting = Tick { dt: t.dt / m as f64, ..t.clone() };
            let passing = lasting.silent();
            for i in 1..=m {
                waiting.check(t.step, i - 1, m)?;
                let t = if i < m { &passing } else { &lasting };
                level(plan, w, t, (l, below), (i < m, &mut *spins), waiting)?;
            }
        }
    }
    if last && !first {
        news(plan, w, &here, way)?;
    } else if let Some(way) = way {
        way.arrive(w);
    }
    l.end_path(w, &mut here, way, spins);
    forces(plan, w, &here)?;
    plan.end(w, &here, |_| more && k == 0)?;
    exchange(w, l, k);
    Ok(())
}

/// What follows a motion before forces. A path ends before particles are wrapped, come and go.
fn news(plan: &mut StepPlan, w: &mut World, t: &Tick, way: Option<Path>) -> Result<()> {
    plan.run(w, t, &[Stage::PostIntegrate])?;
    if let Some(way) = way {
        way.arrive(w);
    }
    plan.run(w, t, &[Stage::Exchange, Stage::Neighbor])
}

/// The forces of a level, but for what fixes do to them.
fn forces(plan: &mut StepPlan, w: &mut World, t: &Tick) -> Result<()> {
    plan.run(w, t, &[Stage::PreForce])?;
    if w.settings.lammps() && t.phase.nested() {
        // Whatever their level, pairs and bonds take the longest step for theirs.
        return plan.run(w, &Tick { dt: w.clock.dt, ..t.clone() }, &[Stage::Force]);
    }
    plan.run(w, t, &[Stage::Force])
}

/// Lets the present forces, torques and heat flows and those of a level change places.
pub(super) fn exchange(w: &mut World, l: &Levels, k: usize) {
    let (n, own) = (w.n(), l.own[k]);
    let [force, torque] = own.forces;
    std::mem::swap(&mut *w.particles.f, w.columns.vector(force, n));
    if w.particles.style.sphere {
        std::mem::swap(&mut *w.particles.torque, w.columns.vector(torque, n));
    }
    if let Some(heat) = w.columns.property(*HEATFLOW) {
        w.columns.swap_scalars(heat, own.heat, n);
    }
}

/// Shows the forces, torques and heat flows of all levels together.
fn join(w: &mut World, l: &Levels) {
    let p = &mut w.particles;
    for (k, own) in l.own.iter().enumerate() {
        for (sum, key) in [&mut p.f, &mut p.torque].into_iter().zip(own.forces) {
            let part = w.columns.get_vector(key).unwrap_or_default();
            if k == 0 {
                sum.clear();
                sum.extend_from_slice(part);
                continue;
            }
            for (sum, part) in sum.iter_mut().zip(part) {
                (0..3).for_each(|d| sum[d] += part[d]);
            }
        }
    }
    let Some(heat) = w.columns.property(*HEATFLOW) else { return };
    let n = w.n();
    let mut sum = vec![0.0; n];
    for own in l.own.iter() {
        let part = w.columns.get_scalar(own.heat).unwrap_or_default();
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    *w.columns.scalar(heat, n) = sum;
}
