//! The processes that make runs, a few at a time.

use super::worker::{OUTPUT, Task, WORD};
use super::{Outcome, Running, Sweep};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::time::Instant;

/// Those at work.
pub(super) struct Crew {
    pub at_once: usize,
    pub threads: usize,
    hands: Vec<Hand>,
    /// Runs that could not even be begun.
    stillborn: Vec<(usize, Outcome)>,
    /// How the process that was looked at last ended, and after how many seconds.
    pub last: (String, f64),
}

struct Hand {
    job: usize,
    child: Child,
    since: Instant,
}

impl Crew {
    pub fn new(at_once: usize, threads: usize) -> Self {
        Self { at_once, threads, hands: vec![], stillborn: vec![], last: Default::default() }
    }

    pub fn has_room(&self) -> bool {
        self.hands.len() < self.at_once
    }

    pub fn is_idle(&self) -> bool {
        self.hands.is_empty() && self.stillborn.is_empty()
    }

    /// A run could not be begun.
    pub fn failed(&mut self, job: usize, outcome: Outcome) {
        self.stillborn.push((job, outcome));
    }

    /// Starts a process for a run, in the run's folder: a worker of this program, or the LAMMPS that the task names.
    pub fn start(&mut self, job: usize, sweep: &Sweep, home: &Path, task: &Task) -> std::io::Result<()> {
        let output = File::create(home.join(OUTPUT))?;
        let mut command = match &task.settings.lammps {
            Some(lammps) => super::lammps::command(lammps, &task.deck, &task.settings.vars, task.threads),
            None => {
                let mut command = sweep.program.command();
                command.arg(WORD).stdin(Stdio::piped());
                command
            }
        };
        command.current_dir(home).stdout(output.try_clone()?).stderr(output);
        // Ctrl-C is for the sweep, which ends its runs.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        let told = child.stdin.take().map_or(Ok(()), |mut pipe| pipe.write_all(task.text().as_bytes()));
        // A process that does not listen has ended, which is seen later.
        drop(told);
        self.hands.push(Hand { job, child, since: Instant::now() });
        Ok(())
    }

    /// Runs that have ended since the last look; an outcome only where no process was started.
    pub fn ended(&mut self) -> Vec<(usize, Option<Outcome>)> {
        if let Some((job, outcome)) = self.stillborn.pop() {
            return vec![(job, Some(outcome))];
        }
        // One at a time, so that `last` is about it.
        for k in 0..self.hands.len() {
            let hand = &mut self.hands[k];
            let how = match hand.child.try_wait() {
                Ok(None) => continue,
                Ok(Some(status)) => said(status),
                Err(e) => e.to_string(),
            };
            let hand = self.hands.remove(k);
            self.last = (how, hand.since.elapsed().as_secs_f64());
            return vec![(hand.job, None)];
        }
        vec![]
    }

    /// The runs under way.
    pub fn running(&self, steps: impl Fn(usize) -> Option<(i64, i64)>) -> Vec<Running> {
        let look = |h: &Hand| Running { job: h.job, since: h.since.elapsed(), steps: steps(h.job) };
        self.hands.iter().map(look).collect()
    }

    /// Ends all of them at once.
    pub fn stop(&mut self) {
        for mut hand in self.hands.drain(..) {
            // One that has ended by itself is no failure.
            let _ = hand.child.kill().and_then(|()| hand.child.wait());
        }
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.stop();
    }
}

/// How a process ended, in a few words.
fn said(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("signal {signal}");
    }
    status.code().map_or_else(|| status.to_string(), |code| format!("exit code {code}"))
}
