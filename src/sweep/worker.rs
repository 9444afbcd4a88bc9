//! One run of a sweep in a process of its own: the task comes on standard input, the result is a file.

use super::outcome::sealed;
use super::record::{digest, join, open, seal, split};
use super::{Outcome, Settings, series};
use crate::session::{self, Made, Mode, Session, Watch};
use perigrain_base::diag::{Diagnostic, Diagnostics, Severity, Sources, render};
use perigrain_output::file::replace;
use perigrain_output::log::Log;
use perigrain_output::thermo::wall_time;
use perigrain_world::Compat;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The word that makes the program a worker.
pub const WORD: &str = "sweep-worker";

/// The output of the run's process and its shell commands, beside the log.
pub(super) const OUTPUT: &str = "output";
/// The result, once there is one.
pub(super) const RESULT: &str = ".result";
/// How far the run is.
pub(super) const PROGRESS: &str = ".progress";

/// How often a run reports its progress.
const PAUSE: Duration = Duration::from_millis(500);
/// How often it looks whether the sweep is still there.
#[cfg(unix)]
const LOOK: Duration = Duration::from_millis(50);

/// What a worker has to know.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Task {
    /// Which run of which sweep this is.
    pub print: String,
    pub name: String,
    /// The file with the deck's text.
    pub deck: PathBuf,
    /// The deck's own folder.
    pub folder: PathBuf,
    pub settings: Settings,
    pub report: Vec<String>,
    pub threads: usize,
    /// The process that waits for the run.
    pub parent: u32,
    /// Held during the run.
    pub lock: PathBuf,
    pub reports_progress: bool,
}

impl Task {
    /// As a line.
    pub fn text(&self) -> String {
        let s = &self.settings;
        let path = |p: &Path| p.display().to_string();
        let on = |b: bool| u8::from(b).to_string();
        let vars =
            s.vars.iter().map(|(n, v)| join(&[vec![n.clone()], v.clone()].concat())).collect::<Vec<_>>();
        seal(&[
            self.print.clone(),
            self.name.clone(),
            path(&self.deck),
            path(&self.folder),
            join(&vars),
            s.compat.name().into(),
            join(&[
                on(s.force_list),
                on(s.no_skipping),
                on(s.portable),
                on(s.series),
                on(self.reports_progress),
            ]),
            join(&self.report),
            self.threads.to_string(),
            self.parent.to_string(),
            path(&self.lock),
        ])
    }

    pub fn read(text: &str) -> Option<Self> {
        let [print, name, deck, folder, vars, compat, on, report, threads, parent, lock] = &open(text)?[..]
        else {
            return None;
        };
        let vars = split(vars).into_iter().map(|v| {
            let mut words = split(&v);
            let name = (!words.is_empty()).then(|| words.remove(0))?;
            Some((name, if words.is_empty() { vec![String::new()] } else { words }))
        });
        let on: Vec<bool> = split(on).iter().map(|w| w == "1").collect();
        let [force_list, no_skipping, portable, series, reports_progress] = on[..] else { return None };
        let compat = Compat::from_name(compat)?;
        // A worker makes no runs of other programs.
        let lammps = None;
        let vars = vars.collect::<Option<_>>()?;
        Some(Self {
            print: print.clone(),
            name: name.clone(),
            deck: deck.into(),
            folder: folder.into(),
            settings: Settings { vars, compat, force_list, no_skipping, portable, series, lammps },
            report: split(report),
            threads: threads.parse().ok()?,
            parent: parent.parse().ok()?,
            lock: lock.into(),
            reports_progress,
        })
    }
}

/// Makes the run described on standard input, in the working folder; whether it went well.
pub fn main() -> bool {
    let mut text = String::new();
    let task = std::io::stdin().read_to_string(&mut text).ok().and_then(|_| Task::read(&text));
    let Some(task) = task else {
        eprintln!("error: `{WORD}` is for `perigrain sweep`, which sends it the run to make");
        return false;
    };
    let lock = File::open(&task.lock);
    if let Ok(lock) = &lock {
        // Where a system knows no locks the run is made without.
        let _ = lock.lock_shared();
    }
    live_with(task.parent);
    let outcome = run(&task);
    let ok = outcome.is_ok();
    let line = sealed(&task.print, &outcome);
    match replace(Path::new(RESULT), |w| w.write_all(line.as_bytes())) {
        Ok(()) => {
            tidy();
            ok
        }
        Err(e) => {
            eprintln!("error: {e}");
            false
        }
    }
}

/// Removes what is of no use when the run is over.
fn tidy() {
    // Missing files and files that cannot be removed do no harm.
    let _ = std::fs::remove_file(PROGRESS);
    if std::fs::metadata(OUTPUT).is_ok_and(|m| m.len() == 0) {
        let _ = std::fs::remove_file(OUTPUT);
    }
}

/// Ends this process when the one that waits for it is no longer there.
#[cfg(unix)]
pub(crate) fn live_with(parent: u32) {
    let gone = move || std::os::unix::process::parent_id() != parent;
    let end = || std::process::exit(1);
    if gone() {
        end();
    }
    std::thread::spawn(move || {
        while !gone() {
            std::thread::sleep(LOOK);
        }
        end();
    });
}

/// Where processes do not know their parents a run ends by itself.
#[cfg(not(unix))]
pub(crate) fn live_with(_parent: u32) {}

/// The digest of a file, if it can be read.
pub(super) fn digest_of(path: &Path) -> Option<String> {
    std::fs::read(path).ok().map(|bytes| digest(&bytes))
}

fn run(task: &Task) -> Outcome {
    let begin = Instant::now();
    let threads = session::set_threads(task.threads.max(1));
    let log = Log::silent();
    match task.settings.series {
        true => log.keep_rows(),
        false => log.keep_last_row(),
    }
    let mut outcome = Outcome { threads, ..Outcome::default() };
    let mut sources = Sources::default();
    if let Err(problems) = attempt(task, &log, &mut outcome, &mut sources) {
        // When the log cannot be written the table has it all the same.
        let _ = log.to_log(render::plain(&problems, &sources).trim_end());
        outcome.problem = Some(in_one_line(&problems, &sources));
    }
    outcome.seconds = begin.elapsed().as_secs_f64();
    if let Err(full) = log.line(&wall_time(outcome.seconds)).and_then(|()| log.close()) {
        outcome.problem.get_or_insert(in_one_line(&full, &sources));
    }
    outcome
}

fn attempt(task: &Task, log: &Log, outcome: &mut Outcome, sources: &mut Sources) -> Result<(), Diagnostics> {
    log.open(Path::new("log.lammps"), false)?;
    let text = std::fs::read_to_string(&task.deck)
        .map_err(|e| perigrain_output::file::trouble("read the deck", &task.deck, &e))?;
    let s = &task.settings;
    let with = s.compat.describe();
    let version = env!("CARGO_PKG_VERSION");
    log.line(&format!("perigrain {version} ({} thread(s){with})", outcome.threads))?;
    let mut session = Session::new(session::Options {
        mode: Mode::Run,
        log: log.clone(),
        compat: s.compat,
        force_list: s.force_list,
        no_skipping: s.no_skipping,
        portable: s.portable,
        vars: s.vars.clone(),
        folder: task.folder.clone(),
        ..session::Options::default()
    })?;
    if s.series {
        session.add_columns(task.report.clone());
    }
    if task.reports_progress {
        session.set_watch(Box::new(ProgressReport::default()));
    }
    let ended = session.run_text(&task.name, &text);
    let worked = session.worked();
    (outcome.steps, outcome.loop_seconds) = (worked.steps, worked.seconds);
    outcome.atoms = session.world.n();
    if let Some((columns, row)) = session.last_row() {
        outcome.row = columns.into_iter().zip(row.values).collect();
    }
    outcome.read = read_files(&session, &task.deck);
    let reported = match &ended {
        Ok(ending) if ending.status != 0 => {
            outcome.problem = Some(format!("`quit {}`", ending.status));
            Ok(())
        }
        Ok(_) => report(&mut session, &task.report, outcome).and_then(|()| match s.series {
            true => log.tables(|tables| series::write(Path::new(series::FILE), tables, &task.report)),
            false => Ok(()),
        }),
        Err(_) => Ok(()),
    };
    sources.clone_from(&session.sources);
    ended?;
    reported
}

/// Evaluates the words to be reported; all that can be, and the first reason why one cannot.
fn report(session: &mut Session, words: &[String], outcome: &mut Outcome) -> Result<(), Diagnostics> {
    let mut trouble = Ok(());
    for word in words {
        match session.measure(word) {
            Ok(value) => outcome.measures.push((word.clone(), value)),
            Err(e) => trouble = trouble.and(Err(e)),
        }
    }
    trouble
}

/// What a run has read with the digests, without what it has written itself.
fn read_files(session: &Session, deck: &Path) -> Vec<(PathBuf, String)> {
    let own = std::env::current_dir().unwrap_or_default();
    let others = session.world.read_files.all().into_iter().filter(|p| !p.starts_with(&own) && p != deck);
    others.filter_map(|path| digest_of(&path).map(|digest| (path, digest))).collect()
}

/// The first error as `in.deck:3: error[PG0102]: unknown command …`.
fn in_one_line(problems: &Diagnostics, sources: &Sources) -> String {
    let first = problems.0.iter().find(|d| d.severity == Severity::Error).or(problems.0.first());
    let Some(d) = first else { return "failed".into() };
    let place = |d: &Diagnostic| {
        let span = d.span?;
        let source = sources.get(span.file)?;
        Some(format!("{}:{}: ", source.name, sources.place(span).0))
    };
    format!("{}error[{}]: {}", place(d).unwrap_or_default(), d.code, d.message)
}

/// Reports the run's progress to the sweep.
#[derive(Default)]
struct ProgressReport {
    last: Option<Instant>,
}

impl Watch for ProgressReport {
    fn step(&mut self, made: &Made) {
        if made.done % 16 != 0 || self.last.is_some_and(|t| t.elapsed() < PAUSE) {
            return;
        }
        self.last = Some(Instant::now());
        // Nothing depends on it.
        let _ = std::fs::write(PROGRESS, format!("{} {}", made.done, made.total));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_comes_through_the_pipe_as_it_was() {
        let vars = vec![("v".into(), vec!["1".into(), "-a\tb".into()]), ("w".into(), vec![String::new()])];
        let task = Task {
            print: "p".into(),
            name: "in.x".into(),
            deck: "/d/deck".into(),
            folder: "/e".into(),
            settings: Settings { vars, compat: Compat::Lammps2026, portable: true, ..Settings::default() },
            report: vec!["c_1".into()],
            threads: 3,
            parent: 7,
            lock: "/d/.workers".into(),
            reports_progress: true,
        };
        assert_eq!(Task::read(&task.text()), Some(task.clone()));
        let bare = Task { report: vec![], settings: Settings::default(), ..task };
        assert_eq!(Task::read(&bare.text()), Some(bare));
        assert_eq!(Task::read("nonsense"), None);
    }
}
