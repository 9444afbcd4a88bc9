//! Global choices of a deck.

use perigrain_base::comm;
use perigrain_base::units::UnitSystem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whose numbers are wanted where LAMMPS is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Compat {
    /// The right ones.
    #[default]
    Perigrain,
    /// Those of LAMMPS 22Jul2025, for comparison.
    Lammps2025,
    /// The same with what the LAMMPS of 2026 has mended, as far as it is known well enough.
    Lammps2026,
    /// The right ones, with the words of LIGGGHTS.
    Liggghts,
}

impl Compat {
    /// The words of decks and command lines with their meaning; the first one of each is printed. `lammps` is the newest version.
    pub const NAMES: [(&'static str, Compat); 5] = [
        ("none", Compat::Perigrain),
        ("lammps/2025", Compat::Lammps2025),
        ("lammps/2026", Compat::Lammps2026),
        ("lammps", Compat::Lammps2026),
        ("liggghts", Compat::Liggghts),
    ];

    /// The meaning of a word.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|n| n.0 == name).map(|n| n.1)
    }

    /// Its word.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|n| n.1 == self).map_or("", |n| n.0)
    }

    /// Whether LAMMPS' artefacts are wanted, of whichever version.
    pub fn lammps(self) -> bool {
        matches!(self, Self::Lammps2025 | Self::Lammps2026)
    }

    /// Whether it is another one than a deck has by itself.
    pub fn is_chosen(self) -> bool {
        self != Self::Perigrain
    }

    /// The words of a log's first line about it, after the number of threads.
    pub fn describe(self) -> String {
        if self.is_chosen() { format!(", compat {}", self.name()) } else { String::new() }
    }
}

/// The setting of `newton`; it changes nothing but the answers to formulas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Newton {
    /// For pairs.
    pub pair: bool,
    /// For bonds.
    pub bond: bool,
}

impl Default for Newton {
    fn default() -> Self {
        Self { pair: true, bond: true }
    }
}

/// When neighbour lists are rebuilt (`neighbor`, `neigh_modify`).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NeighborSettings {
    /// Extra reach of the lists [length].
    pub skin: f64,
    /// The deck has set that distance.
    #[serde(rename = "said")]
    pub skin_set: bool,
    /// The deck has chosen `multi`, which changes nothing but which words may follow.
    #[serde(skip)]
    pub multi: bool,
    /// Earliest rebuild after the last one [steps].
    pub delay: i64,
    /// Consider a rebuild every so many steps.
    pub every: i64,
    /// Rebuild only if some particle moved more than half the skin.
    pub check: bool,
    /// Build at the first run's setup only.
    pub once: bool,
    /// Pairs of groups that never interact: `exclude group a b`.
    pub exclude_groups: Vec<(u32, u32)>,
    /// Pairs of types that never interact: `exclude type a b`.
    pub exclude_types: Vec<(u16, u16)>,
    /// Groups whose members do not interact within a molecule (`true`) or across molecules (`false`).
    pub exclude_molecules: Vec<(u32, bool)>,
}

impl Default for NeighborSettings {
    fn default() -> Self {
        Self {
            skin: 0.3,
            skin_set: false,
            multi: false,
            delay: 0,
            every: 1,
            check: true,
            once: false,
            exclude_groups: vec![],
            exclude_types: vec![],
            exclude_molecules: vec![],
        }
    }
}

/// Levels of steps within each other and the forces in each (`run_style respa`); levels count from 0, the shortest steps.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Respa {
    /// How many steps of a level one of the next holds.
    pub loops: Vec<i64>,
    /// The level of bonds' forces.
    pub bond: usize,
    /// The level of pairs' forces.
    pub pair: usize,
    /// Instead of that one the level of each sub-style of pair_style hybrid.
    pub subs: Option<Vec<usize>>,
}

/// The most short steps that may fill a long one.
pub const MOST_SHORT: i64 = 1_000_000;

impl Respa {
    /// How many steps of a level the longest step holds.
    pub fn steps(&self, level: usize) -> i64 {
        self.loops.iter().skip(level).product()
    }

    /// The level of sub-style `k`, or of the pair style.
    pub fn of_pair(&self, k: usize) -> usize {
        self.subs.as_ref().and_then(|s| s.get(k).copied()).unwrap_or(self.pair)
    }
}

/// How steps are made (`run_style`).
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum RunStyle {
    /// Velocity Verlet, one length of steps.
    #[default]
    Verlet,
    /// Short steps for peridynamic solids, or rare ones where grains are the faster.
    Staggered {
        /// Short steps per long one; `None`: as many as the solids' stability requires.
        ratio: Option<i64>,
        /// Grains are the faster ones: bonds act at each `ratio`-th step.
        rare: bool,
        /// Whose particles drift in the long step as well (the scheme as printed by Hartmann et al.).
        twice: Option<super::GroupId>,
    },
    /// Levels of steps within each other.
    Respa(Respa),
}

impl RunStyle {
    /// How many short steps fill a long one; 1 where the scene decides.
    pub fn short_steps(&self) -> i64 {
        match self {
            RunStyle::Verlet | RunStyle::Staggered { rare: true, .. } => 1,
            RunStyle::Staggered { ratio, .. } => ratio.unwrap_or(1),
            RunStyle::Respa(r) => r.steps(0),
        }
    }

    /// The name in a deck.
    pub fn name(&self) -> &'static str {
        match self {
            RunStyle::Verlet => "verlet",
            RunStyle::Staggered { .. } => "staggered",
            RunStyle::Respa(_) => "respa",
        }
    }
}

/// Global choices of a deck.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Settings {
    /// The deck's units.
    pub units: UnitSystem,
    /// Whose numbers.
    pub compat: Compat,
    /// Space dimension minus three is never printed; 3 or 2.
    pub two_dimensional: bool,
    /// Faces of the box to come.
    pub boundary: super::Boundary,
    /// Neighbour-list policy.
    pub neighbor: NeighborSettings,
    /// How steps are made.
    pub run_style: RunStyle,
    /// The list layout for every peridynamic body (`-layout list`).
    #[serde(skip)]
    pub force_list: bool,
    /// Work also where everything is at rest (`-rest full`).
    #[serde(skip)]
    pub no_skipping: bool,
    /// The portable kernels even where faster ones would run.
    #[serde(skip)]
    pub portable: bool,
    /// `newton` of pairs and bonds, as formulas read it.
    #[serde(skip)]
    pub newton: Newton,
    /// `comm_style tiled`, as formulas read it.
    #[serde(skip)]
    pub tiled: bool,
    /// What `min_style` and `min_modify` have chosen.
    #[serde(skip)]
    pub minimizer: super::Minimizer,
    /// Set from outside (Ctrl-C): end the run at the next whole step.
    #[serde(skip)]
    pub stop: Arc<AtomicBool>,
    /// When runs have to end (`timer timeout`).
    #[serde(skip)]
    pub deadline: Option<Instant>,
    /// Steps between two readings of the clock for that; 0 stands for 10, LAMMPS' own.
    #[serde(skip)]
    pub limit_every: i64,
    /// What several ranks have agreed upon of both.
    #[serde(skip)]
    pub agreed: Agreed,
}

/// What all ranks have agreed about an end that one of them requests.
#[derive(Clone, Copy, Debug, Default)]
pub struct Agreed {
    stop: bool,
    late: bool,
    /// The step of the latest agreement, and when that was.
    last: Option<(i64, Instant)>,
    /// The first step before which there is to be another one.
    next: i64,
}

/// Time between two agreements in a run [s]; each takes some microseconds.
const PAUSE: f64 = 0.02;

/// Most steps between two agreements.
const MOST_STEPS: f64 = 4096.0;

impl Agreed {
    fn due(&self, step: i64) -> bool {
        // A new run may count from the beginning.
        step >= self.next || self.last.is_none_or(|(last, _)| step < last)
    }

    /// Seconds per step since the latest agreement; a step of an unknown length counts as a long one.
    fn pace(&self, step: Option<i64>) -> f64 {
        match (step, self.last) {
            (Some(step), Some((last, since))) if step > last => {
                since.elapsed().as_secs_f64() / (step - last) as f64
            }
            _ => PAUSE,
        }
    }

    /// Takes in what is largest of all ranks: a request, a limit that has passed, the time of a step.
    fn take(&mut self, step: Option<i64>, [stop, late, pace]: [f64; 3]) {
        (self.stop, self.late) = (self.stop || stop > 0.0, late > 0.0);
        self.last = step.map(|step| (step, Instant::now()));
        self.next = step.map_or(0, |step| step + (PAUSE / pace).clamp(1.0, MOST_STEPS) as i64);
    }
}

impl Settings {
    /// Seconds left until the limit of `timer timeout`: negative behind it, 0 without one.
    pub fn time_left(&self) -> f64 {
        let Some(end) = self.deadline else { return 0.0 };
        comm::broadcast::number(|| {
            let now = Instant::now();
            match end.checked_duration_since(now) {
                Some(left) => left.as_secs_f64(),
                None => -now.duration_since(end).as_secs_f64(),
            }
        })
    }

    /// Whether the limit of `timer timeout` has passed.
    pub fn timed_out(&self) -> bool {
        self.deadline.is_some() && comm::broadcast::truth(|| self.is_late())
    }

    /// As [`Settings::timed_out`], by this rank's own clock.
    fn is_late(&self) -> bool {
        self.deadline.is_some_and(|end| Instant::now() >= end)
    }

    /// Whether a run has to end before the step after `step`. Of several ranks: as they have agreed.
    pub fn ends_at(&self, step: i64) -> bool {
        let every = if self.limit_every > 0 { self.limit_every } else { 10 };
        let late = || if comm::several() { self.agreed.late } else { self.is_late() };
        self.deadline.is_some() && step % every == 0 && late()
    }

    /// Whether something outside requests an end (Ctrl-C). With several ranks: as they have agreed.
    pub fn stops(&self) -> bool {
        if comm::several() { self.agreed.stop } else { self.stop.load(Ordering::Relaxed) }
    }

    /// Several ranks agree about an end, before the step after `step`: all of them call this. Steps that take no time are made
    /// without.
    pub fn agree_at(&mut self, step: i64) {
        if comm::several() && self.agreed.due(step) {
            self.agree(Some(step));
        }
    }

    /// Several ranks agree about an end between two lines.
    pub fn agree(&mut self, step: Option<i64>) {
        if !comm::several() {
            return;
        }
        let asked = self.stop.load(Ordering::Relaxed);
        let flag = |yes: bool| f64::from(u8::from(yes));
        let mut all = [flag(asked), flag(self.is_late()), self.agreed.pace(step)];
        comm::present().most(&mut all);
        self.agreed.take(step, all);
    }

    /// Whether LAMMPS' artefacts are wanted.
    pub fn lammps(&self) -> bool {
        self.compat.lammps()
    }

    /// Whether they are those of LAMMPS 22Jul2025, with all that has been mended since.
    pub fn lammps_of_2025(&self) -> bool {
        self.compat == Compat::Lammps2025
    }

    /// Whether they are those of the LAMMPS of 2026.
    pub fn lammps_of_2026(&self) -> bool {
        self.compat == Compat::Lammps2026
    }
}
