//! What a sweep shows while it runs: a line per run that has ended, and on a terminal one line for all.

use crate::cli::deck;
use crate::cli::progress::Tally;
use crate::sweep::{Job, Outcome, State, Watch};
use perigrain_base::diag::{Diagnostics, Sources};
use std::io::Write;
use std::time::Duration;

/// Shows what happens, unless it is to be quiet.
pub struct Show<'a> {
    /// The runs.
    pub jobs: &'a [Job],
    /// Say nothing.
    pub quiet: bool,
    /// The line for all.
    pub tally: Tally,
}

impl Show<'_> {
    fn say(&self, text: &str) {
        if !self.quiet {
            // A reader that closes early is no failure.
            let _ = writeln!(self.tally.around(std::io::stdout()), "{text}");
        }
    }
}

impl Watch for Show<'_> {
    fn resumed(&mut self, done: usize, state: &State) {
        self.say(&format!("going on: {done} of {} runs are done", state.jobs));
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
            None => text += &format!("  {}", short(Duration::from_secs_f64(outcome.seconds))),
        }
        self.say(&text);
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
        parts.push(format!("{} left", short(left)));
    }
    parts.join("  ")
}

/// A time in its two largest units.
pub fn short(t: Duration) -> String {
    let s = t.as_secs();
    match s {
        0..10 => format!("{:.2} s", t.as_secs_f64()),
        10..60 => format!("{s} s"),
        60..3600 => format!("{} min {} s", s / 60, s % 60),
        3600..86400 => format!("{} h {} min", s / 3600, s % 3600 / 60),
        _ => format!("{} d {} h", s / 86400, s % 86400 / 3600),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Running;

    #[test]
    fn times_and_states_are_short() {
        let said = [0.5, 30.0, 90.0, 7260.0, 90000.0].map(|s| short(Duration::from_secs_f64(s)));
        assert_eq!(said, ["0.50 s", "30 s", "1 min 30 s", "2 h 1 min", "1 d 1 h"]);
        let running = vec![Running { job: 4, since: Duration::ZERO, steps: Some((40, 100)) }];
        let state = State { jobs: 9, ok: 3, failed: 1, running, left: Some(Duration::from_secs(180)) };
        assert_eq!(summary(&state), "running: 5 at 40 %  1 failed  3 min 0 s left");
    }
}
