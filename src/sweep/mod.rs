//! Many runs of one deck side by side: a table of jobs in, worker processes, a journal, a table of results out.
//!
//! [`Job::all`] makes the jobs, [`execute`] has them run, [`Results`] holds their results; this module is independent of the
//! command line.

mod ahead;
mod crew;
mod folder;
mod hands;
mod journal;
pub mod lammps;
mod outcome;
pub mod ranks;
mod record;
pub mod series;
pub mod starter;
pub mod table;
pub mod worker;

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_world::Compat;
use starter::Starter;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::session::axes::{Axis, combined};
pub use ahead::{Ahead, look_ahead};
use crew::Crew;
use folder::Folder;
use hands::Order;
use journal::Journal;
pub use outcome::Outcome;
use ranks::Ranks;

/// How often running processes are looked at.
const PAUSE: Duration = Duration::from_millis(4);

/// How often the table is written anew during runs.
const TABLE: Duration = Duration::from_secs(1);

/// One run: index variables with one value each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Job {
    /// Name and value, in the order of the lists.
    pub vars: Vec<(String, String)>,
}

impl Job {
    /// One for each combination of values, the last list fastest.
    ///
    /// # Errors
    /// A variable in two lists, an implausible number of runs.
    pub fn all(axes: &[Axis]) -> Result<Vec<Self>> {
        Ok(combined(axes)?.into_iter().map(|vars| Self { vars }).collect())
    }

    /// The variables as `v=20 seed=3`.
    pub fn title(&self) -> String {
        let name = |n: &String| n.trim_start_matches('-').to_owned();
        self.vars.iter().map(|(n, v)| format!("{}={v}", name(n))).collect::<Vec<_>>().join(" ")
    }

    /// What the deck sees of it: names that begin with a dash are switches of the program, which no deck can have as variables.
    pub fn variables(&self) -> impl Iterator<Item = &(String, String)> {
        self.vars.iter().filter(|(name, _)| !name.starts_with('-'))
    }

    /// The value of a switch, as `-threads`, that this run has for itself.
    pub fn switch(&self, name: &str) -> Option<&str> {
        self.vars.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }
}

/// The deck, as it was when the sweep began.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Deck {
    /// What it is called in messages.
    pub name: String,
    /// All of it.
    pub text: String,
    /// Its folder, where files that it reads are looked for.
    pub folder: PathBuf,
}

/// How every run is executed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Index variables that all runs share.
    pub vars: Vec<(String, Vec<String>)>,
    /// LAMMPS' artefacts too.
    pub compat: Compat,
    /// The list layout for every peridynamic body.
    pub force_list: bool,
    /// Work also where everything is at rest.
    pub no_skipping: bool,
    /// The portable kernels only.
    pub portable: bool,
    /// What is reported stands in the step table too, and each run leaves its rows in [`series::FILE`].
    pub series: bool,
    /// The LAMMPS that makes the runs whose `-program` is [`lammps::PROGRAM`].
    pub lammps: Option<PathBuf>,
}

/// Runs of one deck, and how they are to be made.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The deck.
    pub deck: Deck,
    /// One run each; their numbers count from 1.
    pub jobs: Vec<Job>,
    /// What each run reports at its end: words or formulas.
    pub report: Vec<String>,
    /// What all runs share.
    pub settings: Settings,
    /// Where journal, table and the runs' own folders are.
    pub folder: PathBuf,
    /// How many run at once, on ranks on each of them; 0 for as many as there are cores.
    pub at_once: usize,
    /// Threads of each run; 0 shares the cores out. Numbers do not depend on it.
    pub threads: usize,
    /// How often a run that has failed is tried again.
    pub retry: usize,
    /// The program that executes a run when called with [`worker::WORD`]: this one, as a rule.
    pub program: Starter,
    /// Whether runs report their progress.
    pub reports_progress: bool,
    /// The ranks that make the runs; without them this process has them made.
    pub ranks: Option<Ranks>,
}

/// Where a sweep stands.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Runs in all.
    pub jobs: usize,
    /// Runs that are done and went well.
    pub ok: usize,
    /// Runs that have failed.
    pub failed: usize,
    /// Those under way.
    pub running: Vec<Running>,
    /// Time left, from the median of what is done; `None` as long as nothing is.
    pub left: Option<Duration>,
}

/// A run under way.
#[derive(Clone, Debug)]
pub struct Running {
    /// Its place among the jobs, from 0.
    pub job: usize,
    /// Since when.
    pub since: Duration,
    /// Steps made and steps of the present `run`, if it has reported them.
    pub steps: Option<(i64, i64)>,
}

/// Observes a sweep.
pub trait Watch {
    /// The sweep continues where an earlier one ended; `done` runs are left alone.
    fn resumed(&mut self, _done: usize, _state: &State) {}
    /// Something worth knowing about the journal or the table.
    fn note(&mut self, _note: &Diagnostics) {}
    /// A run has ended.
    fn ended(&mut self, _job: usize, _outcome: &Outcome, _state: &State) {}
    /// Time has passed.
    fn waited(&mut self, _state: &State) {}
}

/// No observer.
impl Watch for () {}

/// The results of all runs.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// What became of each job, in their order; `None` where it has not been run.
    pub outcomes: Vec<Option<Outcome>>,
    /// Ended from outside.
    pub interrupted: bool,
    /// The table could not be written.
    pub tableless: bool,
}

impl Results {
    /// Whether every run went well.
    pub fn all_ok(&self) -> bool {
        !self.tableless && self.outcomes.iter().all(|o| o.as_ref().is_some_and(Outcome::is_ok))
    }
}

/// The state of a sweep's folder.
#[derive(Clone, Debug, Default)]
pub struct Standing {
    /// The deck's name.
    pub deck: String,
    /// The jobs.
    pub jobs: Vec<Job>,
    /// What they report.
    pub report: Vec<String>,
    /// What became of them so far.
    pub results: Results,
    /// Runs under way, if a sweep is at work there.
    pub running: Option<usize>,
    /// Time left then, from the median of what is done.
    pub left: Option<Duration>,
}

/// The folder of a run of a sweep.
pub fn home_of(sweep: &Sweep, job: usize) -> PathBuf {
    sweep.folder.join(folder::name(sweep.jobs.len(), job, &sweep.jobs[job].title()))
}

/// Reads the folder of a sweep.
///
/// # Errors
/// A folder without a journal, and one that cannot be read.
pub fn look(folder: &std::path::Path) -> Result<Standing> {
    let (head, begun, outcomes) = journal::look(folder)?;
    let under_way =
        begun.iter().zip(&outcomes).filter(|(begun, outcome)| **begun && outcome.is_none()).count();
    let running = folder::at_work(folder).then_some(under_way);
    let left = running.and_then(|n| time_left(&outcomes, 0.0, n));
    let results = Results { outcomes, ..Results::default() };
    Ok(Standing { deck: head.deck, jobs: head.jobs, report: head.report, results, running, left })
}

/// The time that the missing runs take, so many at once: the median of those that went well for each, less the seconds `spent`.
fn time_left(outcomes: &[Option<Outcome>], spent: f64, at_once: usize) -> Option<Duration> {
    let mut times: Vec<f64> = outcomes.iter().flatten().filter(|o| o.is_ok()).map(|o| o.seconds).collect();
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2)?;
    let missing = outcomes.iter().filter(|o| o.is_none()).count() as f64;
    Duration::try_from_secs_f64((missing * median - spent).max(0.0) / at_once.max(1) as f64).ok()
}

/// Makes all runs that are not done yet. With `anew` an earlier sweep in the folder is discarded.
///
/// # Errors
/// A folder that holds another sweep or is in use, a journal that cannot be written. A failed run is none: it stands in the
/// results.
pub fn execute(sweep: &Sweep, anew: bool, watch: &mut dyn Watch, stop: &AtomicBool) -> Result<Results> {
    let folder = Folder::open(sweep)?;
    let mut journal = Journal::open(sweep, &folder, anew)?;
    if !journal.notes.is_empty() {
        watch.note(&journal.notes);
    }
    let mut work = Work::new(sweep, &folder, &mut journal)?;
    work.adopt()?;
    if let Some(note) = work.left_at_ranks() {
        watch.note(&note.into());
    }
    let done = work.done();
    if done > 0 || !work.journal.is_new {
        watch.resumed(done, &work.state());
    }
    let outcome = work.all(watch, stop);
    work.crew.stop();
    outcome?;
    work.write_table(watch);
    let outcomes = work.outcomes;
    Ok(Results { outcomes, interrupted: stop.load(Ordering::Relaxed), tableless: work.tableless })
}

/// A sweep at work.
struct Work<'a> {
    sweep: &'a Sweep,
    folder: &'a Folder,
    journal: &'a mut Journal,
    crew: Crew,
    outcomes: Vec<Option<Outcome>>,
    /// How often each run was tried, this time.
    tries: Vec<usize>,
    /// Digests of the files that runs have read, and which run was the first.
    read: BTreeMap<PathBuf, (String, usize)>,
    tableless: bool,
}

impl<'a> Work<'a> {
    fn new(sweep: &'a Sweep, folder: &'a Folder, journal: &'a mut Journal) -> Result<Self> {
        let outcomes = std::mem::take(&mut journal.outcomes);
        let left = outcomes.iter().filter(|o| !o.as_ref().is_some_and(Outcome::is_ok)).count();
        let crew = Crew::new(sweep, left);
        let tries = vec![0; outcomes.len()];
        let mut work =
            Self { sweep, folder, journal, crew, outcomes, tries, read: BTreeMap::new(), tableless: false };
        work.check_read_files()?;
        Ok(work)
    }

    /// Refuses a sweep whose runs have read files that are others now.
    fn check_read_files(&mut self) -> Result<()> {
        let done: Vec<Outcome> = self.outcomes.iter().flatten().filter(|o| o.is_ok()).cloned().collect();
        for (k, outcome) in done.iter().enumerate() {
            if let Some(changed) = self.changed(k, outcome) {
                return Err(other(self.sweep, changed));
            }
        }
        for (path, (digest, run)) in &self.read {
            if worker::digest_of(path).as_ref() != Some(digest) {
                let text = format!("`{}` has changed since run {} read it", path.display(), run + 1);
                return Err(other(self.sweep, text));
            }
        }
        Ok(())
    }

    /// Notes what a run has read; a sentence if an earlier one found something else there.
    fn changed(&mut self, job: usize, outcome: &Outcome) -> Option<String> {
        for (path, digest) in &outcome.read {
            let (first, run) = self.read.entry(path.clone()).or_insert_with(|| (digest.clone(), job));
            if first != digest {
                return Some(format!("`{}` has changed since run {} read it", path.display(), *run + 1));
            }
        }
        None
    }

    /// Takes in runs that ended before a killed sweep could note it.
    fn adopt(&mut self) -> Result<()> {
        for job in 0..self.outcomes.len() {
            if self.outcomes[job].is_some() || !self.journal.begun[job] {
                continue;
            }
            let left = self.folder.left_by(self.sweep, job, &self.journal.print(job));
            if let Some(outcome) = left.filter(Outcome::is_ok) {
                self.end(job, outcome)?;
            }
        }
        Ok(())
    }

    /// Reports which runs ranks had under way when an earlier sweep ended.
    fn left_at_ranks(&self) -> Option<Diagnostic> {
        let jobs = 0..self.outcomes.len();
        let left = jobs.filter(|job| self.outcomes[*job].is_none() && self.journal.begun[*job]);
        let one = |job: usize| Some(format!("run {} at {}", job + 1, self.journal.at[job].as_ref()?));
        let all: Vec<String> = left.filter_map(one).collect();
        let text = format!("under way when the sweep ended, and begun anew: {}", all.join(", "));
        (!all.is_empty()).then(|| Diagnostic::note(Code::OTHER_SWEEP, None, text))
    }

    fn done(&self) -> usize {
        self.outcomes.iter().flatten().filter(|o| o.is_ok()).count()
    }

    fn all(&mut self, watch: &mut dyn Watch, stop: &AtomicBool) -> Result<()> {
        // What has failed before is tried again.
        let mut waiting: Vec<usize> = (0..self.outcomes.len())
            .rev()
            .filter(|k| !self.outcomes[*k].as_ref().is_some_and(Outcome::is_ok))
            .collect();
        waiting.iter().for_each(|k| self.outcomes[*k] = None);
        let mut written = Instant::now();
        let mut shown = Instant::now();
        self.write_table(watch);
        while !stop.load(Ordering::Relaxed) {
            while let Some(rank) = self.crew.room()
                && let Some(job) = waiting.pop()
            {
                self.begin(job, rank)?;
            }
            if self.crew.is_idle() {
                break;
            }
            let mut notes = Diagnostics::default();
            let ended = self.crew.ended(self.sweep, &mut notes)?;
            if !notes.is_empty() {
                watch.note(&notes);
            }
            if std::mem::take(&mut self.crew.end_requested) {
                stop.store(true, Ordering::Relaxed);
            }
            if ended.is_empty() {
                std::thread::sleep(PAUSE);
            }
            for (job, mut outcome) in ended {
                if outcome.is_ok() {
                    outcome.problem = self.changed(job, &outcome);
                }
                self.take(job, outcome, &mut waiting, watch)?;
            }
            if written.elapsed() > TABLE {
                self.write_table(watch);
                written = Instant::now();
            }
            if shown.elapsed() > Duration::from_millis(200) {
                watch.waited(&self.state());
                shown = Instant::now();
            }
        }
        Ok(())
    }

    fn begin(&mut self, job: usize, rank: usize) -> Result<()> {
        self.tries[job] += 1;
        let home = self.folder.of(self.sweep, job);
        if !self.journal.begun[job] && home.exists() {
            let text = format!("`{}` is in the way, and no run of this sweep has made it", home.display());
            self.crew.failed(job, text);
            return Ok(());
        }
        self.journal.begin(job, self.crew.name(rank))?;
        let task = self.folder.task(self.sweep, job, self.crew.threads(rank), self.journal.print(job));
        self.crew.begin(rank, self.sweep, Order { job, home, task });
        Ok(())
    }

    fn take(
        &mut self,
        job: usize,
        outcome: Outcome,
        waiting: &mut Vec<usize>,
        watch: &mut dyn Watch,
    ) -> Result<()> {
        if !outcome.is_ok() && self.tries[job] <= self.sweep.retry {
            waiting.push(job);
            return Ok(());
        }
        self.end(job, outcome)?;
        if let Some(outcome) = &self.outcomes[job] {
            watch.ended(job, outcome, &self.state());
        }
        Ok(())
    }

    fn end(&mut self, job: usize, outcome: Outcome) -> Result<()> {
        self.journal.end(job, &outcome)?;
        self.outcomes[job] = Some(outcome);
        Ok(())
    }

    fn write_table(&mut self, watch: &mut dyn Watch) {
        let written = table::write(&self.sweep.folder, &self.sweep.jobs, &self.sweep.report, &self.outcomes);
        if let Err(e) = &written
            && !self.tableless
        {
            watch.note(e);
        }
        self.tableless = written.is_err();
    }

    fn state(&self) -> State {
        let (ended, ok) = (self.outcomes.iter().flatten().count(), self.done());
        let running = self.crew.running();
        // A run that takes longer than all others is as good as done.
        let longest = self.outcomes.iter().flatten().map(|o| o.seconds).fold(0.0, f64::max);
        let spent: f64 = running.iter().map(|r| r.since.as_secs_f64().min(longest)).sum();
        let left = time_left(&self.outcomes, spent, self.crew.places());
        State { jobs: self.outcomes.len(), ok, failed: ended - ok, running, left }
    }
}

/// The sweep in the folder is not the requested one.
fn other(sweep: &Sweep, what: String) -> Diagnostics {
    let text = format!("the sweep in `{}` cannot continue: {what}", sweep.folder.display());
    Diagnostic::error(Code::OTHER_SWEEP, None, text)
        .help("`-anew` begins it anew and discards its runs; `-out DIR` puts this one elsewhere")
        .into()
}
