//! The processes that make runs on this machine, a few at a time.

use super::outcome::opened;
use super::starter::Starter;
use super::worker::{OUTPUT, RESULT, Task, WORD};
use super::{Outcome, Running, folder, lammps};
use perigrain_base::comm;
use perigrain_base::diag::Result;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus, Stdio};
use std::time::Instant;

/// One run that is to be made.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Order {
    /// Its place among the jobs, from 0.
    pub job: usize,
    /// Its folder, which is emptied first.
    pub home: PathBuf,
    /// What the process has to know; a LAMMPS among its settings makes the run instead of a worker.
    pub task: Task,
}

/// Those at work.
#[derive(Default)]
pub(super) struct Hands {
    hands: Vec<Hand>,
    /// Runs that could not even be begun.
    stillborn: Vec<(usize, Outcome)>,
}

struct Hand {
    order: Order,
    child: Child,
    since: Instant,
}

impl Hands {
    /// Runs under way, those that could not be begun among them until [`Hands::ended`] has reported them.
    pub fn count(&self) -> usize {
        self.hands.len() + self.stillborn.len()
    }

    /// Starts a process for a run, in the run's folder. That it cannot be started is the run's outcome.
    pub fn begin(&mut self, program: &Starter, order: Order) {
        let job = order.job;
        let started = folder::clear(&order.home).and_then(|()| started(program, &order));
        match started {
            Ok(child) => self.hands.push(Hand { order, child, since: Instant::now() }),
            Err(e) => {
                let text = e.0.first().map_or(String::new(), |d| format!("error[{}]: {}", d.code, d.message));
                self.failed(job, text);
            }
        }
    }

    /// A run cannot be begun.
    pub fn failed(&mut self, job: usize, why: String) {
        self.stillborn.push((job, Outcome::failed(why, 0.0)));
    }

    /// Runs that have ended since the last look, and what became of them.
    pub fn ended(&mut self) -> Vec<(usize, Outcome)> {
        let mut ended = std::mem::take(&mut self.stillborn);
        for k in (0..self.hands.len()).rev() {
            let how = match self.hands[k].child.try_wait() {
                Ok(None) => continue,
                Ok(Some(status)) => describe(status),
                Err(e) => e.to_string(),
            };
            let hand = self.hands.remove(k);
            ended.push((hand.order.job, left_by(&hand.order, &how, hand.since.elapsed().as_secs_f64())));
        }
        ended
    }

    /// The runs under way.
    pub fn running(&self) -> Vec<Running> {
        let look = |h: &Hand| Running {
            job: h.order.job,
            since: h.since.elapsed(),
            steps: folder::steps(&h.order.home),
        };
        self.hands.iter().map(look).collect()
    }

    /// Ends all of them at once.
    pub fn stop(&mut self) {
        self.stillborn.clear();
        for mut hand in self.hands.drain(..) {
            // One that has ended by itself is no failure.
            let _ = hand.child.kill().and_then(|()| hand.child.wait());
        }
    }
}

impl Drop for Hands {
    fn drop(&mut self) {
        self.stop();
    }
}

/// A process for a run: a worker of this program, or the LAMMPS that the task names.
fn started(program: &Starter, order: &Order) -> Result<Child> {
    let task = &order.task;
    let output = File::create(order.home.join(OUTPUT))
        .map_err(|e| perigrain_output::file::trouble("write", &order.home.join(OUTPUT), &e))?;
    let mut command = match &task.settings.lammps {
        Some(lammps) => lammps::command(lammps, &task.deck, &task.settings.vars, task.threads),
        None => {
            let mut command = program.command();
            command.arg(WORD).stdin(Stdio::piped());
            command
        }
    };
    comm::set_apart(&mut command);
    let both = output.try_clone().map(|copy| command.current_dir(&order.home).stdout(copy).stderr(output));
    // Ctrl-C is for the sweep, which ends its runs.
    #[cfg(unix)]
    let both = both.map(|command| std::os::unix::process::CommandExt::process_group(command, 0));
    let mut child = both.and_then(std::process::Command::spawn).map_err(|e| {
        use perigrain_base::diag::{Code, Diagnostic};
        let program = task.settings.lammps.as_ref().map_or(program.display(), |path| path.display());
        Diagnostic::error(Code::NO_FILE, None, format!("`{program}` cannot be started: {e}"))
    })?;
    let sent = child.stdin.take().map_or(Ok(()), |mut pipe| pipe.write_all(task.text().as_bytes()));
    // A process that does not listen has ended, which is seen later.
    drop(sent);
    Ok(child)
}

/// What a run has left whose process has ended: by itself, or because it crashed.
fn left_by(order: &Order, how: &str, seconds: f64) -> Outcome {
    let Order { home, task, .. } = order;
    if task.settings.lammps.is_some() {
        return lammps::outcome(home, &task.report, seconds, task.threads);
    }
    let text = std::fs::read_to_string(home.join(RESULT)).ok();
    text.and_then(|text| opened(&task.print, &text)).unwrap_or_else(|| crashed(home, how, seconds))
}

/// A run whose process ended without a result.
fn crashed(home: &Path, how: &str, seconds: f64) -> Outcome {
    let output = std::fs::read(home.join(OUTPUT)).unwrap_or_default();
    let output = String::from_utf8_lossy(&output);
    let word = output.lines().map(str::trim).find(|l| l.contains("panicked") || l.contains("error"));
    let last = word.or_else(|| output.lines().rev().map(str::trim).find(|l| !l.is_empty()));
    let text = match last {
        Some(last) => format!("the process crashed ({how}): {last}"),
        None => format!("the process crashed ({how})"),
    };
    Outcome::failed(text, seconds)
}

/// How a process ended, in a few words.
fn describe(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("signal {signal}");
    }
    status.code().map_or_else(|| status.to_string(), |code| format!("exit code {code}"))
}
