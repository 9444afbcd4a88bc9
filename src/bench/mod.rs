//! Time against error: a deck run over its knobs, each run measured against a reference.
//!
//! A [`Bench`] is a sweep with measures; [`Bench::found`] gives the time, the error and the order of each setting.

pub mod front;
pub mod norm;
pub mod order;
pub mod page;
pub mod picture;
pub mod reference;
pub mod scaling;
pub mod suite;
pub mod table;

use crate::session::axes::Axis;
use crate::sweep::{self, Job, Outcome, Sweep, lammps, series};
use norm::Norm;
use order::Order;
use perigrain_base::diag::{Code, Diagnostics, Result, fail};
use reference::Against;

/// The knob that makes every run several times.
pub const REPEAT: &str = "-repeat";
/// The least total time of a setting's runs where the number of runs is not given [s]: shorter times measure the clock and the
/// other load of the machine.
pub const LEAST: f64 = 0.05;
/// The largest number of runs of a setting where the number is not given.
const MOST: f64 = 100.0;
/// The folder of runs that are made again, in that of the others.
const AGAIN: &str = "again";

/// The knob of threads.
pub const THREADS: &str = "-threads";
/// The knob of the layout of bodies.
pub const LAYOUT: &str = "-layout";
/// The knob of what runs the deck.
pub const PROGRAM: &str = "-program";

/// One thing that is measured, and against what.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// A word or a formula.
    pub word: String,
    /// What it is compared with.
    pub against: Against,
    /// How series are compared.
    pub norm: Norm,
    /// What it is called in tables and pictures.
    pub name: String,
}

/// Runs of a deck over its knobs, and what is measured.
#[derive(Clone, Debug)]
pub struct Bench {
    /// The runs; each setting of the knobs as often as it is repeated.
    pub sweep: Sweep,
    /// The knobs, repeats not among them; the last one fastest.
    pub axes: Vec<Axis>,
    /// How often each setting is run; `None` for as often as [`Bench::again`] says.
    pub repeats: Option<usize>,
    /// What is measured.
    pub measures: Vec<Measure>,
}

/// How far one measure of one setting is off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Error {
    /// Its value at the end.
    pub value: Option<f64>,
    /// Its error; none of the reference, and where something is missing.
    pub error: Option<f64>,
    /// The observed order over three settings up to this one, along each knob.
    pub orders: Vec<Option<Order>>,
    /// No setting is both faster and nearer.
    pub in_front: bool,
    /// It is what others are compared with.
    pub is_reference: bool,
    /// It is the reference with other switches of the program: its error is independent of the knobs, and is left out of orders,
    /// front and pictures.
    pub is_twin: bool,
}

impl Error {
    /// The error, where it depends on the knobs.
    pub fn counted(&self) -> Option<f64> {
        self.error.filter(|_| !self.is_twin)
    }
}

/// One setting of the knobs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// The knobs.
    pub vars: Vec<(String, String)>,
    /// The least wall time of the steps [s].
    pub seconds: Option<f64>,
    /// How many runs that is the least of.
    pub runs: usize,
    /// Steps, particles and threads.
    pub steps: i64,
    /// Particles at the end.
    pub atoms: usize,
    /// Threads it had.
    pub threads: usize,
    /// Why there are no numbers.
    pub problem: Option<String>,
    /// One for each measure.
    pub errors: Vec<Error>,
}

/// What a bench has found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The settings, the last knob fastest.
    pub points: Vec<Point>,
    /// What is missing, and why.
    pub problems: Diagnostics,
    /// Settings whose runs have failed, and why: places and codes are in the words.
    pub failures: Vec<String>,
}

impl Found {
    /// Whether nothing is missing.
    pub fn is_whole(&self) -> bool {
        self.problems.is_empty() && self.failures.is_empty()
    }
}

impl Bench {
    /// A bench of these runs: `axes` without repeats.
    ///
    /// # Errors
    /// A knob with two lists, too many runs.
    pub fn new(
        sweep: Sweep,
        axes: Vec<Axis>,
        repeats: Option<usize>,
        measures: Vec<Measure>,
    ) -> Result<Self> {
        let mut bench = Self { sweep, axes, repeats, measures };
        bench.settle()?;
        Ok(bench)
    }

    /// Makes the list of runs anew from knobs and measures.
    ///
    /// # Errors
    /// As [`Bench::new`].
    pub fn settle(&mut self) -> Result<()> {
        let mut axes = self.axes.clone();
        if self.turns() > 1 {
            // All settings once, then all of them again: what disturbs the machine for a while disturbs them alike.
            let turns = (1..=self.turns()).map(|k| vec![k.to_string()]).collect();
            axes.insert(0, Axis { names: vec![REPEAT.into()], rows: turns });
        }
        self.sweep.jobs = Job::all(&axes)?;
        let mut words: Vec<String> = vec![];
        for m in &self.measures {
            let form = match &m.against {
                Against::Form(form) => Some(form),
                _ => None,
            };
            words.extend([&m.word].into_iter().chain(form).cloned());
        }
        self.sweep.report.clear();
        for word in words {
            if !self.sweep.report.contains(&word) {
                self.sweep.report.push(word);
            }
        }
        self.sweep.settings.series = true;
        Ok(())
    }

    /// How often each setting is run at first.
    fn turns(&self) -> usize {
        self.repeats.unwrap_or(1).max(1)
    }

    /// The number of settings.
    pub fn settings(&self) -> usize {
        self.sweep.jobs.len() / self.turns()
    }

    /// Short runs once more, until those of a setting have taken [`LEAST`] together; nothing where repeats are given, or none is short.
    ///
    /// Turn by turn, as all repeats are. They lie in a folder of their own beside the first runs.
    pub fn again(&self, outcomes: &[Option<Outcome>]) -> Option<Sweep> {
        if self.repeats.is_some() {
            return None;
        }
        let wanted = |o: &Option<Outcome>| match o {
            Some(o) if o.is_ok() && o.loop_seconds > 0.0 => {
                (LEAST / o.loop_seconds).ceil().min(MOST) as usize
            }
            _ => 1,
        };
        let wanted: Vec<usize> = outcomes.iter().map(wanted).collect();
        let job = |turn: usize, k: usize| {
            let turn = (REPEAT.to_owned(), turn.to_string());
            Job { vars: std::iter::once(turn).chain(self.sweep.jobs[k].vars.iter().cloned()).collect() }
        };
        let turns = 2..=wanted.iter().copied().max().unwrap_or(1);
        let jobs = turns.flat_map(|turn| {
            let short = wanted.iter().enumerate().filter(move |(_, n)| **n >= turn);
            short.map(move |(k, _)| job(turn, k))
        });
        let sweep =
            Sweep { jobs: jobs.collect(), folder: self.sweep.folder.join(AGAIN), ..self.sweep.clone() };
        (!sweep.jobs.is_empty()).then_some(sweep)
    }

    /// The place of a setting on each axis.
    pub fn places(&self, point: usize) -> Vec<usize> {
        let mut rest = point;
        let mut places: Vec<usize> = self.axes.iter().rev().map(|axis| remainder(&mut rest, axis)).collect();
        places.reverse();
        places
    }

    /// The setting at these places.
    pub fn at(&self, places: &[usize]) -> usize {
        self.axes.iter().zip(places).fold(0, |k, (axis, place)| k * axis.rows.len() + place)
    }

    /// The numbers on an axis, by its first name; `None` if they are none or not above zero.
    pub fn numbers(&self, axis: usize) -> Option<Vec<f64>> {
        let axis = &self.axes[axis];
        if axis.is_switch() || axis.rows.len() < 2 {
            return None;
        }
        let number = |row: &Vec<String>| row[0].parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite());
        axis.rows.iter().map(number).collect()
    }

    /// The results of the runs, and of those of [`Bench::again`] with their jobs.
    pub fn found(&self, outcomes: &[Option<Outcome>], again: &[(Job, Outcome)]) -> Found {
        let mut found = Found::default();
        let runs: Vec<Run> = (0..self.settings()).map(|k| self.run(k, outcomes, again, &mut found)).collect();
        found.failures = failures(&found.points);
        for (which, measure) in self.measures.iter().enumerate() {
            let errors = reference::errors(self, measure, &runs, &mut found.problems);
            let orders = order::all(self, measure, &errors);
            let costs: Vec<Option<(f64, f64)>> = found
                .points
                .iter()
                .zip(&errors)
                .map(|(p, e)| Some((p.seconds?, e.counted()?)).filter(|(s, e)| *s > 0.0 && *e > 0.0))
                .collect();
            let front = front::of(&costs);
            for (k, mut error) in errors.into_iter().enumerate() {
                error.orders.clone_from(&orders[k]);
                error.in_front = front[k];
                found.points[k].errors.push(error);
            }
            debug_assert!(found.points.iter().all(|p| p.errors.len() == which + 1));
        }
        found
    }

    /// One setting: the least of its times, and the numbers of the first of its runs that went well.
    fn run(
        &self,
        point: usize,
        outcomes: &[Option<Outcome>],
        again: &[(Job, Outcome)],
        found: &mut Found,
    ) -> Run {
        let n = self.settings();
        let job = |turn: usize| turn * n + point;
        let ended = || (0..self.turns()).filter_map(|t| Some((job(t), outcomes.get(job(t))?.as_ref()?)));
        let fine: Vec<(usize, &Outcome)> = ended().filter(|(_, o)| o.is_ok()).collect();
        let own = self.sweep.jobs[point].vars.iter().filter(|(name, _)| name != REPEAT);
        let mut out = Point { vars: own.cloned().collect(), ..Point::default() };
        let mut run = Run::default();
        if let Some((first, o)) = fine.first() {
            (out.steps, out.atoms, out.threads) = (o.steps, o.atoms, o.threads);
            // Behind the number of the repeat stand the knobs.
            let same = |job: &Job| job.vars[1..] == out.vars[..];
            let more = again.iter().filter(|(job, o)| o.is_ok() && same(job)).map(|(_, o)| o);
            let all: Vec<&Outcome> = fine.iter().map(|(_, o)| *o).chain(more).collect();
            out.runs = all.len();
            out.seconds = all.iter().map(|o| o.loop_seconds).reduce(f64::min);
            if let Some(other) = all.iter().position(|other| other.measures != o.measures) {
                let text = format!("run {} and its repeat {} gave other numbers", first + 1, other + 1);
                found.problems.append(fault(Code::SUSPICIOUS, text));
            }
            let file = sweep::home_of(&self.sweep, *first).join(series::FILE);
            match series::read(&file, self.sweep.report.len()) {
                Ok(series) => run = Run { outcome: Some((*o).clone()), series },
                Err(e) => out.problem = e.0.first().map(|d| d.message.clone()),
            }
        } else {
            out.problem = ended().find_map(|(_, o)| o.problem.clone());
        }
        found.points.push(out);
        run
    }

    /// The runs of LAMMPS among these, by their settings.
    pub fn is_lammps(&self, point: usize) -> bool {
        self.sweep.jobs[point].switch(PROGRAM) == Some(lammps::PROGRAM)
    }
}

/// What a setting's run gave.
#[derive(Clone, Debug, Default)]
pub struct Run {
    outcome: Option<Outcome>,
    /// In the order of what is reported; empty for what is no column.
    series: Vec<series::Series>,
}

/// What went wrong, once, with the first of the settings in which it did.
fn failures(points: &[Point]) -> Vec<String> {
    let mut grouped: Vec<(&str, String, usize)> = vec![];
    for point in points {
        let Some(problem) = point.problem.as_deref() else { continue };
        match grouped.iter_mut().find(|(other, ..)| *other == problem) {
            Some((_, _, more)) => *more += 1,
            None => grouped.push((problem, Job { vars: point.vars.clone() }.title(), 0)),
        }
    }
    let sentence = |(problem, title, more): (&str, String, usize)| match more {
        0 => format!("{title}: {problem}"),
        n => format!("{title} and {n} more: {problem}"),
    };
    grouped.into_iter().map(sentence).collect()
}

fn remainder(rest: &mut usize, axis: &Axis) -> usize {
    let n = axis.rows.len();
    let place = *rest % n;
    *rest /= n;
    place
}

fn fault(code: Code, text: String) -> Diagnostics {
    fail::<()>(code, None, text).err().unwrap_or_default()
}
