//! What a step is made of: ops, their stage, what they read and write, and when they act.

use super::acts::{BlockSums, Room};
use super::{Level, Needs, Phase, Span};
use perigrain_base::diag::Result;
use perigrain_world::{Fields, World};
use std::ops::Range;
use std::sync::Arc;

/// The stages of a step in their order, in LAMMPS' words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// First half kick and drift.
    InitialIntegrate,
    /// After the drift.
    PostIntegrate,
    /// Particles come and go.
    Exchange,
    /// Wrap, shrink, lost test, lists.
    Neighbor,
    /// Before forces: clear them.
    PreForce,
    /// Pair and bond forces.
    Force,
    /// Forces of fixes.
    PostForce,
    /// Second half kick.
    FinalIntegrate,
    /// After the step.
    EndOfStep,
    /// Tables and files.
    Output,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 10] = [
        Stage::InitialIntegrate,
        Stage::PostIntegrate,
        Stage::Exchange,
        Stage::Neighbor,
        Stage::PreForce,
        Stage::Force,
        Stage::PostForce,
        Stage::FinalIntegrate,
        Stage::EndOfStep,
        Stage::Output,
    ];

    /// Whether ops of this stage also act in a run's setup by default.
    pub fn in_setup(self) -> bool {
        !matches!(
            self,
            Stage::InitialIntegrate
                | Stage::PostIntegrate
                | Stage::Exchange
                | Stage::FinalIntegrate
                | Stage::EndOfStep
        )
    }

    /// The stage's name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::InitialIntegrate => "initial integrate",
            Stage::PostIntegrate => "post integrate",
            Stage::Exchange => "exchange",
            Stage::Neighbor => "neighbor",
            Stage::PreForce => "pre force",
            Stage::Force => "force",
            Stage::PostForce => "post force",
            Stage::FinalIntegrate => "final integrate",
            Stage::EndOfStep => "end of step",
            Stage::Output => "output",
        }
    }
}

/// At which steps of a run an op acts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum When {
    /// Every step.
    Always,
    /// Steps that are multiples of N.
    Every(i64),
    /// The setup of a run.
    First,
    /// The last step of a run.
    Last,
    /// `repeat` steps, `every` apart, of which the last is a multiple of `freq` (averages over time).
    Samples {
        /// Distance of two samples.
        every: i64,
        /// Number of samples.
        repeat: i64,
        /// Distance of two averages.
        freq: i64,
    },
    /// These steps (ascending).
    At(Arc<[i64]>),
    /// Whenever one of these does.
    Any(Vec<When>),
    /// Only on request between runs.
    Never,
}

impl When {
    /// Whether the op acts at this tick.
    pub fn fires(&self, t: &Tick) -> bool {
        match self {
            When::Always => true,
            When::Every(n) => *n > 0 && t.step % n == 0,
            When::First => t.setup,
            When::Last => t.step == t.last,
            When::Samples { every, repeat, freq } => {
                let before = (-t.step).rem_euclid(*freq);
                before % every == 0 && before / every < *repeat
            }
            When::At(steps) => steps.binary_search(&t.step).is_ok(),
            When::Any(list) => list.iter().any(|w| w.fires(t)),
            When::Never => false,
        }
    }

    /// Whether the op acts in every step, and in setups.
    pub fn is_always(&self) -> bool {
        match self {
            When::Always | When::Every(1) => true,
            When::Any(list) => list.iter().any(When::is_always),
            _ => false,
        }
    }

    /// The first step from `step` on at which it may act, in a run up to `last`: the end of time if there is none. Steps before
    /// it are silent but for the setup and an early end of a run.
    pub fn next(&self, step: i64, last: i64) -> i64 {
        match self {
            When::Always => step,
            When::Every(n) if *n > 0 => step + (-step).rem_euclid(*n),
            When::Last if step <= last => last,
            When::Samples { every, repeat, freq } => {
                let before = (-step).rem_euclid(*freq);
                // The samples of an average begin so long before its step.
                let begin = (repeat - 1) * every;
                step + if before > begin { before - begin } else { before % every }
            }
            When::At(steps) => steps.get(steps.partition_point(|s| *s < step)).copied().unwrap_or(i64::MAX),
            When::Any(list) => list.iter().map(|w| w.next(step, last)).min().unwrap_or(i64::MAX),
            When::Every(_) | When::First | When::Last | When::Never => i64::MAX,
        }
    }

    /// The union of two.
    #[must_use]
    pub fn or(self, other: When) -> When {
        match (self, other) {
            (When::Always, _) | (_, When::Always) => When::Always,
            (When::Never, w) | (w, When::Never) => w,
            (a, b) if a == b => a,
            (When::Any(mut a), When::Any(b)) => {
                a.extend(b.into_iter().filter(|w| !a.contains(w)).collect::<Vec<_>>());
                When::Any(a)
            }
            (When::Any(mut a), b) | (b, When::Any(mut a)) => {
                if !a.contains(&b) {
                    a.push(b);
                }
                When::Any(a)
            }
            (a, b) => When::Any(vec![a, b]),
        }
    }
}

impl std::fmt::Display for When {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            When::Always => write!(f, "every step"),
            When::Every(n) => write!(f, "every {n} steps"),
            When::First => write!(f, "first"),
            When::Last => write!(f, "last"),
            When::Samples { every, repeat, freq } => {
                write!(f, "{repeat} samples every {every} steps up to each multiple of {freq}")
            }
            When::At(steps) => write!(f, "at {} chosen steps", steps.len()),
            When::Any(list) => {
                write!(f, "{}", list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
            }
            When::Never => write!(f, "on demand"),
        }
    }
}

/// The present step as ops see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Present step.
    pub step: i64,
    /// First step of the run.
    pub first: i64,
    /// Last step of the run.
    pub last: i64,
    /// Step size.
    pub dt: f64,
    /// Whether this is the run's setup (forces at the start, no motion).
    pub setup: bool,
    /// In setup: the scene is as the last run left it, so forces, bonds and history stand already.
    pub unchanged: bool,
    /// The end has come early (a minimization has converged): all outputs show it, whatever their intervals.
    pub ending: bool,
    /// A place that a line search tries: no bond breaks or flows there, and no history is kept of it.
    pub trial: bool,
    /// The energy is read at this step.
    pub energy: bool,
    /// The virial is read at this step.
    pub virial: bool,
    /// Per-particle energies are read at this step.
    pub atom_energy: bool,
    /// The level of this step among several.
    pub phase: Phase,
    /// The world's contacts are read at this step.
    pub contacts: bool,
    /// Per-particle virials are read at this step.
    pub atom_virial: bool,
    /// The op that ends this step also begins the next one in the same pass, if it (or its fix) does so; nothing reads the scene
    /// in between.
    pub on: bool,
    /// The collective results of ops (sums of forces and the like) may be read after this step.
    pub collective: bool,
    /// Only the ops of every step act.
    pub quiet: bool,
}

impl Tick {
    /// The same tick without any sums.
    pub fn silent(&self) -> Tick {
        let none = (false, false, false, false);
        let mut t = self.clone();
        (t.energy, t.virial, t.atom_energy, t.atom_virial) = none;
        t.contacts = false;
        t
    }

    /// The tick of something that happens between runs.
    pub fn between_runs(c: &perigrain_world::Clock) -> Tick {
        Tick {
            step: c.step,
            first: c.step,
            last: c.step,
            dt: c.dt,
            setup: false,
            unchanged: true,
            ending: false,
            trial: false,
            energy: false,
            virial: false,
            atom_energy: false,
            phase: Phase::default(),
            contacts: false,
            atom_virial: false,
            on: false,
            collective: true,
            quiet: false,
        }
    }
}

/// The row of LAMMPS' timing table an op's time goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OpClass {
    /// Pair and bond forces.
    Pair,
    /// Lists, wrapping.
    Neigh,
    /// Thermo, dumps and what they need.
    Output,
    /// Fixes.
    Modify,
    /// The rest.
    Other,
}

/// What an op declares once, when it is placed in a plan.
#[derive(Clone, Debug)]
pub struct About {
    /// A name for plan and timing, as `fix ball indent`.
    pub name: String,
    /// The stage of the step.
    pub stage: Stage,
    /// The fields it touches, and how.
    pub needs: Needs,
    /// The steps at which it acts. Providers of values get the union of their consumers' times instead.
    pub when: When,
    /// Whether it acts in the setup of a run too.
    pub in_setup: bool,
    /// The level of steps in which it acts.
    pub level: Level,
    /// Whether it reports to the world's account ([`Travel`](perigrain_world::Travel)) how far it moves particles in whole steps.
    pub reports_travel: bool,
    /// Whether it may act on blocks of particles ([`Way::Blocks`]); it never rests then.
    pub fuses: bool,
    /// Whether it computes a collective result of all particles that others may read ([`Tick::collective`]).
    pub collective: bool,
    /// Whether `run` can begin the next step as well, where [`Tick::on`] is set.
    pub begins_next: bool,
    /// Whether it also acts once the run is over, if that ended before its last step ([`Tick::ending`]): ops that save the run.
    pub at_parting: bool,
    /// The row of the timing table.
    pub class: OpClass,
}

impl About {
    /// Acts every step and in the outermost level, in the setup of a run where its stage usually does.
    pub fn new(name: impl Into<String>, stage: Stage, needs: Needs) -> Self {
        let class = match stage {
            Stage::Force => OpClass::Pair,
            Stage::Neighbor => OpClass::Neigh,
            Stage::Output => OpClass::Output,
            Stage::PreForce => OpClass::Other,
            _ => OpClass::Modify,
        };
        let (when, in_setup, level) = (When::Always, stage.in_setup(), Level::Outermost);
        let (reports_travel, fuses, collective, begins_next, at_parting) =
            (false, false, false, false, false);
        Self {
            name: name.into(),
            stage,
            needs,
            when,
            in_setup,
            level,
            reports_travel,
            fuses,
            collective,
            begins_next,
            at_parting,
            class,
        }
    }
}

/// How an op acts at one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// By itself, through [`Op::run`].
    Alone,
    /// On each particle by itself: such ops are fused into one pass over blocks of particles.
    Blocks,
    /// Not at all, as it knows without reading particles; its last result stays valid. It is left out.
    Rests,
}

/// One thing a step does. Ops own scratch only; whatever outlives a step lives in `World`.
pub trait Op: Send {
    /// What the plan has to know about it, queried once.
    fn about(&self) -> About;
    /// Called once all ops of a plan are known, with the fields that some of them change by name.
    fn settle(&mut self, _changed: Fields) {}
    /// Acts.
    ///
    /// # Errors
    /// Failures of the physics (lost particles, numbers out of control) and of files.
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()>;
    /// As `run`, for the last op that adds forces: it may call `ready` with the particles that have all of theirs while these are
    /// in the cache, each once, and must not read or write them afterwards; they may be moved at once. `false` if it did not call
    /// `ready`.
    ///
    /// # Errors
    /// As `run`.
    fn run_streaming(
        &mut self,
        w: &mut World,
        t: &Tick,
        _ready: &mut dyn FnMut(&mut World, Range<usize>),
    ) -> Result<bool> {
        self.run(w, t).map(|()| false)
    }
    /// How it acts at this tick. With [`Way::Blocks`] it puts its action on blocks of particles into the room.
    fn way(&mut self, _w: &mut World, _t: &Tick, _room: &mut Room) -> Way {
        Way::Alone
    }
    /// The rows whose values it needs at this tick, where particles are distributed over ranks; all rows where its sums may be
    /// read, see [`About::collective`].
    fn span(&mut self, _w: &mut World, _t: &Tick) -> Span {
        Span::All
    }
    /// Takes what came of all blocks.
    fn fused(&mut self, _w: &mut World, _t: &Tick, _sums: BlockSums) {}
    /// What the run's end should do (close files, print a fact).
    ///
    /// # Errors
    /// As `run`.
    fn finish(&mut self, _w: &mut World) -> Result<()> {
        Ok(())
    }
    /// Bytes of memory the op has touched per call, for `plan --measure`; 0 when unknown.
    fn bytes(&self, _w: &World) -> u64 {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_step_is_the_first_that_fires() {
        let every = When::Every(7);
        let samples = When::Samples { every: 3, repeat: 4, freq: 20 };
        let long = When::Samples { every: 5, repeat: 4, freq: 20 };
        let at = When::At([-4, 0, 3, 90].into());
        let any = When::Any(vec![every.clone(), When::First, at.clone(), When::Last]);
        let last = 83;
        let tick = |step: i64| Tick { step, last, ..Tick::between_runs(&perigrain_world::Clock::default()) };
        for w in [
            When::Always,
            When::Every(0),
            When::Never,
            When::First,
            When::Last,
            every,
            samples,
            long,
            at,
            any,
        ] {
            for from in -30..100 {
                // Beyond what is looked through here nothing but what comes again and again fires, and that has come before.
                let found = (from..200).find(|&step| w.fires(&tick(step))).unwrap_or(i64::MAX);
                assert_eq!(w.next(from, last), found, "{w:?} from {from}");
            }
        }
    }
}
