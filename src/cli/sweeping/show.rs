//! What a sweep shows while it runs: a line per run that has ended, and on a terminal one line for all.

use crate::cli::deck;
use crate::cli::progress::Tally;
use crate::human::duration;
use crate::sweep::{Job, Outcome, State, Watch};
use perigrain_base::diag::{Diagnostics, Sources};
use std::io::Write;

/// Shows what happens, unless it is to be quiet.
pub struct Show<'a> {
    /// The runs.
    pub jobs: &'a [Job],
    /// Print nothing.
    pub quiet: bool,
    /// The line for all.
    pub tally: Tally,
}

impl Show<'_> {
    pub(super) fn print(&self, text: &str) {
        if !self.quiet {
            // A reader that closes early is no failure.
            let _ = writeln!(self.tally.around(std::io::stdout()), "{text}");
        }
    }
}

impl Watch for Show<'_> {
    fn resumed(&mut self, done: usize, state: &State) {
        self.print(&format!("continuing: {done} of {} runs are done", state.jobs));
    }

    fn note(&mut self, note: &Diagnostics) {
        self.tally.suspend(|| deck::print(note, &Sources::default()));
    }

    fn ended(&mut self, job: usize, outcome: &Outcome, state: &State) {
        let width = state.jobs.to_string().len();
        let title = self.jobs.get(job).map(Job::title).unwrap_or_default();
        let mut text = format!("{:>width$}/{}  {title}  {}", job + 1, state.jobs, outcome.status());
        match &outcome.problem {
            Some(problem) => text += &format!("  {problem}"),
            None => text += &format!("  {}", duration(outcome.seconds)),
        }
        self.print(&text);
        self.waited(state);
    }

    fn waited(&mut self, state: &State) {
        if !self.quiet {
            self.tally.show(state.ok + state.failed, state.jobs, &summary(state));
        }
    }
}

/// `2 running (run 5 at 40 %), 1 failed, 3 min left`.
pub fn summary(state: &State) -> String {
    let share = |(done, total): (i64, i64)| (100.0 * done as f64 / total.max(1) as f64).round();
    let one = |r: &crate::sweep::Running| match r.steps {
        Some(steps) => format!("{} at {} %", r.job + 1, share(steps)),
        None => format!("{}", r.job + 1),
    };
    let running: Vec<String> = state.running.iter().map(one).collect();
    let mut parts = vec![];
    if !running.is_empty() {
        parts.push(format!("running: {}", running.join(", ")));
    }
    if state.failed > 0 {
        parts.push(format!("{} failed", state.failed));
    }
    if let Some(left) = state.left.filter(|_| state.ok + state.failed < state.jobs) {
        parts.push(format!("{} left", duration(left.as_secs_f64())));
    }
    parts.join("  ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Running;
    use std::time::Duration;

    #[test]
    fn states_are_short() {
        let running = vec![Running { job: 4, since: Duration::ZERO, steps: Some((40, 100)) }];
        let state = State { jobs: 9, ok: 3, failed: 1, running, left: Some(Duration::from_secs(180)) };
        assert_eq!(summary(&state), "running: 5 at 40 %  1 failed  3 min 0 s left");
    }
}
