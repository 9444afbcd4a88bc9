//! The folder of a sweep: locks, a copy of the deck, a folder for each run.

use super::outcome::opened;
use super::worker::{PROGRESS, RESULT, Task};
use super::{Deck, Outcome, Sweep, lammps};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_output::file::{replace, trouble};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Held by the process that has the runs made.
const LOCK: &str = ".lock";
/// Held together by the processes that make them: one may outlive a killed sweep by a moment.
const WORKERS: &str = ".workers";
/// The deck as it was when the sweep began.
pub(super) const DECK: &str = "deck";
/// How long an earlier sweep may take to go.
const PATIENCE: Duration = Duration::from_secs(1);
/// A run's folder is not named longer than this.
const LONGEST: usize = 100;

/// The folder, for as long as this process has the runs made.
pub(super) struct Folder {
    path: PathBuf,
    _lock: File,
}

impl Folder {
    /// Makes it if there is none, and waits until no run of an earlier sweep is left.
    ///
    /// # Errors
    /// Another sweep at work there; folders that cannot be made.
    pub fn open(sweep: &Sweep) -> Result<Self> {
        let path = std::path::absolute(&sweep.folder).unwrap_or_else(|_| sweep.folder.clone());
        std::fs::create_dir_all(&path).map_err(|e| trouble("make the folder", &path, &e))?;
        let lock = locked(&path.join(LOCK))?;
        if !held(&lock) {
            let text = format!("another sweep is at work in `{}`", sweep.folder.display());
            let d = Diagnostic::error(Code::OTHER_SWEEP, None, text);
            return Err(d.help("wait for it, or put this one elsewhere with `-out DIR`").into());
        }
        // A system without locks gives no way to wait for other processes.
        let workers = locked(&path.join(WORKERS))?;
        let _ = workers.lock().and_then(|()| workers.unlock());
        Ok(Self { path, _lock: lock })
    }

    /// Keeps a copy of the deck, which all runs read: editing it meanwhile changes none of them.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(&self, deck: &Deck) -> Result<()> {
        replace(&self.path.join(DECK), |w| w.write_all(deck.text.as_bytes()))
    }

    /// The deck as it was, if there is one.
    pub fn kept(&self) -> Option<String> {
        std::fs::read_to_string(self.path.join(DECK)).ok()
    }

    /// The folder of a run.
    pub fn of(&self, sweep: &Sweep, job: usize) -> PathBuf {
        self.path.join(name(sweep.jobs.len(), job, &sweep.jobs[job].title()))
    }

    /// The description of a run for a worker.
    pub fn task(&self, sweep: &Sweep, job: usize, threads: usize, print: String) -> Task {
        let mut settings = sweep.settings.clone();
        let own = &sweep.jobs[job];
        settings.vars.extend(own.variables().map(|(n, v)| (n.clone(), vec![v.clone()])));
        let threads = own.switch("-threads").and_then(|n| n.parse().ok()).unwrap_or(threads);
        if own.switch("-program") != Some(lammps::PROGRAM) {
            settings.lammps = None;
        }
        if let Some(layout) = own.switch("-layout") {
            settings.force_list = layout == "list";
        }
        Task {
            print,
            name: sweep.deck.name.clone(),
            deck: self.path.join(DECK),
            folder: sweep.deck.folder.clone(),
            settings,
            report: sweep.report.clone(),
            threads,
            parent: std::process::id(),
            lock: self.path.join(WORKERS),
            reports_progress: sweep.reports_progress,
        }
    }

    /// The result that a run has left, if it is whole.
    pub fn left_by(&self, sweep: &Sweep, job: usize, print: &str) -> Option<Outcome> {
        let text = std::fs::read_to_string(self.of(sweep, job).join(RESULT)).ok()?;
        opened(print, &text)
    }
}

/// Empties a run's folder, or makes it.
///
/// # Errors
/// Folders that cannot be emptied or made.
pub(super) fn clear(home: &Path) -> Result<()> {
    forget(home)?;
    std::fs::create_dir(home).map_err(|e| trouble("make the folder", home, &e).into())
}

/// Removes a run's folder.
///
/// # Errors
/// What the system refuses.
pub(super) fn forget(home: &Path) -> Result<()> {
    match std::fs::remove_dir_all(home) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(trouble("empty the folder", home, &e).into())
        }
        _ => Ok(()),
    }
}

/// Steps made and steps of the present `run` in a run's folder, if the run has reported them.
pub(super) fn steps(home: &Path) -> Option<(i64, i64)> {
    let text = std::fs::read_to_string(home.join(PROGRESS)).ok()?;
    let (done, total) = text.trim().split_once(' ')?;
    Some((done.parse().ok()?, total.parse().ok()?))
}

/// Takes the lock; false if another process keeps it. A process that a killed sweep was just starting holds it for a moment more.
fn held(lock: &File) -> bool {
    let begin = Instant::now();
    while let Err(TryLockError::WouldBlock) = lock.try_lock() {
        if begin.elapsed() > PATIENCE {
            return false;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    true
}

/// Whether a sweep is at work in a folder.
pub(super) fn at_work(folder: &Path) -> bool {
    let lock = File::open(folder.join(LOCK));
    lock.is_ok_and(|lock| matches!(lock.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// A file to lock.
fn locked(path: &Path) -> Result<File> {
    let file = File::options().create(true).truncate(false).write(true).read(true).open(path);
    file.map_err(|e| trouble("write", path, &e).into())
}

/// `0007-v=20-seed=3`: the number of a run of so many, and its variables as far as they make a name.
pub(super) fn name(of: usize, job: usize, title: &str) -> String {
    let digits = of.to_string().len().max(4);
    let fits = |c: char| if c.is_ascii_alphanumeric() || "._+-=".contains(c) { c } else { '_' };
    let words: String = title.replace(' ', "-").chars().map(fits).collect();
    let mut name = format!("{:0digits$}-{words}", job + 1);
    name.truncate(LONGEST);
    name.trim_end_matches(['-', '.']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_have_names_that_every_system_takes() {
        assert_eq!(name(10, 6, "v=20 seed=3"), "0007-v=20-seed=3");
        assert_eq!(name(123_456, 0, "file=../a b/ü"), "000001-file=.._a-b__");
        assert_eq!(name(1, 0, ""), "0001");
        assert_eq!(name(1, 0, &"x=1 ".repeat(100)).len(), LONGEST);
    }
}
