//! The text of a run on a terminal in place of LAMMPS' blocks: its expected cost, and three lines at its end.

use super::Session;
use crate::human::{about, bytes, count, duration};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_base::stop::Stop;
use perigrain_base::{comm, par};
use perigrain_lang::{Line, Script};
use perigrain_output::log::Log;
use perigrain_plan::run::verlet::Outcome;
use perigrain_plan::{OpClass, StepPlan};
use perigrain_world::{Halt, memory};
use std::time::Duration;

/// Files that are named one by one; of more the number is printed.
const NAMED: usize = 6;

/// A share of the time from which on it is mentioned.
const MUCH: f64 = 0.25;

/// How much longer than `-timeout` a line may take: a tenth of the limit within these bounds.
const LEAST_GRACE: Duration = Duration::from_secs(2);
const MOST_GRACE: Duration = Duration::from_secs(60);

/// Exit code of what a signal has ended.
const INTERRUPTED: i32 = 130;

/// Particles for which several threads pay.
const MANY: usize = 2000;

/// The last text, so that a loop around `run` does not repeat it.
#[derive(Clone, Debug, Default)]
pub(super) struct Spoken {
    /// The scene whose memory was printed, and its particles then.
    scene: u64,
    particles: usize,
    results: String,
    faster: String,
}

impl Session {
    /// Prints on a terminal, before a run, how much memory the scene will take.
    pub(super) fn foretell(&mut self) {
        let n = self.world.n();
        let (problems, log) = (&mut self.spoken, &self.options.log);
        let same = problems.scene == self.scenes && 10 * n.abs_diff(problems.particles) <= problems.particles;
        if same || log.brief().is_none() {
            return;
        }
        (problems.scene, problems.particles) = (self.scenes, n);
        let memory = bytes(memory::expected(&self.world));
        let s = if n == 1 { "" } else { "s" };
        log.to_screen(&format!("{} particle{s}, about {memory} of memory", count(n as f64)));
    }

    /// The three lines: time and speed; where results are; what would make the run faster. The last two only where they are
    /// news, and where `all` are wanted.
    pub(super) fn in_three_lines(
        &mut self,
        plan: &StepPlan,
        o: &Outcome,
        minimized: Option<&str>,
        all: bool,
    ) -> String {
        let mut lines = vec![speed(o, self.world.n(), minimized)];
        if all {
            let (results, hints) = (self.results(), self.hints(plan, o));
            if self.spoken.results != results {
                self.spoken.results.clone_from(&results);
                lines.push(results);
            }
            // Shares of the time differ a little from run to run.
            let digits = |c: char| c.is_ascii_digit() || c == '.';
            let gist = format!("faster: {}", hints.join("; ").replace(digits, ""));
            if self.spoken.faster != gist {
                self.spoken.faster = gist;
                lines.extend(faster(&hints, plan, o));
            }
        }
        lines.join("\n")
    }

    /// Reports on a terminal a file that a line has written; `*` in its name stands for the step.
    pub(super) fn report_file(&self, file: &str) {
        if self.options.log.brief().is_some() {
            self.options
                .log
                .to_screen(&format!("wrote {}", file.replace('*', &self.world.clock.step.to_string())));
        }
    }

    /// What ends a line before it is done: a signal, or the limit of `-timeout` where that is past for a while.
    pub(super) fn heeded(&self) -> Stop {
        let limit = self.options.limit.as_ref();
        if !comm::is_first() {
            // The first rank gives up work for all.
            return Stop::default();
        }
        // A `timer timeout` in the deck has the last word.
        let given = limit.zip(self.world.settings.deadline).filter(|(l, end)| self.born + l.time == *end);
        let deadline = given.map(|(l, end)| end + (l.time / 10).clamp(LEAST_GRACE, MOST_GRACE));
        Stop::new(self.stop_flag(), deadline)
    }

    /// Whether a signal requests the end after a line. Several ranks agree about that; after lines that a loop repeats a million
    /// times, now and then.
    pub(super) fn has_end_request(&mut self, line: &Line) -> bool {
        if comm::several() {
            let light = line.command.as_ref().is_none_or(|cmd| {
                let name = cmd.name.text.as_str();
                super::flow::LIGHT.contains(&name) || Script::FLOW.contains(&name)
            });
            self.behind += 1;
            if !light || self.behind.is_multiple_of(256) {
                self.world.settings.agree(None);
            }
        }
        self.world.settings.stops()
    }

    /// What becomes of a line that was given up.
    ///
    /// # Errors
    /// At the prompt, where the line is taken back; and at the limit of time, as the deck is not done.
    pub(super) fn cut_short(
        &mut self,
        stop: &Stop,
        line: &Line,
        span: Span,
        problems: &Diagnostics,
    ) -> Result<()> {
        let problems: Vec<&Diagnostic> = problems.0.iter().filter(|d| d.code == Code::INTERRUPTED).collect();
        if stop.is_late() {
            let text = "the limit of `-timeout` has passed, and this line is not done";
            let text = problems.iter().fold(text.to_string(), |text, d| format!("{text}: {}", d.message));
            return fail(Code::INTERRUPTED, span, text);
        }
        if self.prompt == Some(span.file) {
            return fail(Code::INTERRUPTED, span, "interrupted: this line was not done");
        }
        self.interrupted = true;
        let place = self.place_of(line).unwrap_or_default();
        self.options.log.line(&format!("Interrupted in {place}: this line is not done, and none follows"))?;
        if comm::several() {
            // The other ranks are in the midst of it.
            self.options.log.flush()?;
            comm::present().abort(INTERRUPTED);
        }
        let mut details = problems.iter().filter(|d| !d.help.is_empty());
        details.try_for_each(|d| self.options.log.line(&format!("  {}; {}", d.message, d.help.join("; "))))
    }

    /// The file and row of a line that was not typed.
    fn place_of(&self, line: &Line) -> Option<String> {
        let span = line.command.as_ref().map(|cmd| cmd.span).filter(|span| self.prompt != Some(span.file))?;
        let name = self.sources.get(span.file).map_or("", |source| &source.name);
        Some(format!("{name}:{}", self.sources.place(span).0))
    }

    /// Whether a limit of time has ended the last run.
    pub(super) fn is_out_of_time(&self) -> bool {
        self.world.clock.halt == Halt::All && self.world.settings.timed_out()
    }

    /// Leaves restart files of a run that ended early. What ops hold of the scene is given back to the world first, and particles
    /// stand in the order of their creation, as behind a run.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub(super) fn save_early(&mut self, plan: &mut StepPlan) -> Result<()> {
        plan.release(&mut self.world)?;
        self.world.fall_back();
        plan.part(&mut self.world)?;
        let limit = self.options.limit.as_ref().filter(|_| self.is_out_of_time());
        match limit.filter(|_| self.graph.restarts.names().is_empty()).cloned() {
            Some(limit) => self.save_restart(&limit.restart),
            None => Ok(()),
        }
    }

    /// Reports that a line was the last one because of a signal; a run reports that itself. The state after the last run is saved
    /// if the scene has not changed since.
    pub(super) fn report_interrupt(&mut self, line: &Line) -> Result<()> {
        if let Some(plan) = self.plan.as_mut().filter(|_| self.ran && !*self.world.changed) {
            plan.part(&mut self.world)?;
        }
        let text = self.place_of(line).map_or("Interrupted".into(), |place| {
            format!("Interrupted behind {place}: no further line runs")
        });
        self.options.log.line(&text)
    }

    /// Where results are.
    fn results(&self) -> String {
        let mut files: Vec<String> = log_file(&self.options.log).into_iter().collect();
        files.extend(self.graph.dumps.iter().map(|d| d.file.clone()));
        let written = self.graph.fixes.iter().filter_map(|f| f.fix.facts(&self.world).file);
        files.extend(written.map(|path| path.display().to_string()));
        files.extend(self.graph.restarts.names());
        let mut seen = std::collections::BTreeSet::new();
        files.retain(|f| seen.insert(f.clone()));
        if files.is_empty() {
            return "results: on this screen alone; `log FILE` and `dump` keep some".into();
        }
        let more = files.len().saturating_sub(NAMED);
        files.truncate(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("results: {}{more}", files.join(", "))
    }

    /// What would make such a run faster, the likeliest first.
    fn hints(&self, plan: &StepPlan, o: &Outcome) -> Vec<String> {
        let seconds = o.time.as_secs_f64();
        let mut hints: Vec<String> = vec![];
        if cfg!(debug_assertions) {
            hints.push("a release build (this one is for looking for mistakes)".into());
        }
        if let Some(times) = self.room_for_step().filter(|times| *times >= 1.5) {
            let dt = self.world.clock.dt;
            hints.push(format!("a longer time step: {:.1e} in place of {dt:.1e}", times * dt));
        }
        if seconds > 0.0 {
            let times = plan.time_by_class();
            let of = |class| times.iter().find(|(c, _)| *c == class).map_or(0.0, |t| t.1.as_secs_f64());
            let share = |class| (of(class) / seconds).min(1.0);
            let (output, neigh) = (share(OpClass::Output), share(OpClass::Neigh));
            if output > MUCH {
                hints.push(format!("rarer `thermo` and dumps, which take {:.0} %", 100.0 * output));
            }
            if neigh > MUCH {
                hints.push(format!("a longer skin (`neighbor`): lists take {:.0} %", 100.0 * neigh));
            }
        }
        let (used, cores) =
            (par::most_threads(), std::thread::available_parallelism().map_or(1, usize::from));
        if used < cores && self.world.n() >= MANY {
            hints.push(format!("more threads: {used} of {cores} cores are used"));
        }
        hints
    }
}

/// The line that names what would make a run faster, and where its time went.
fn faster(hints: &[String], plan: &StepPlan, o: &Outcome) -> Option<String> {
    let longest = plan.ops.iter().max_by_key(|p| p.meter.time);
    let part = longest.map(|p| (p.about.name.as_str(), p.meter.time.as_secs_f64() / o.time.as_secs_f64()));
    let part = part.filter(|(_, part)| part.is_finite() && *part > 0.0);
    let goes = part.map(|(name, part)| format!("{:.0} % goes into {name}", 100.0 * part.min(1.0)));
    match (hints.is_empty(), goes) {
        (true, goes) => goes.map(|goes| format!("faster: {goes}, and nothing simple is left to win")),
        (false, goes) => {
            Some(format!("faster: {}", hints.iter().cloned().chain(goes).collect::<Vec<_>>().join("; ")))
        }
    }
}

/// Time and speed of a run, or how a minimization went.
fn speed(o: &Outcome, particles: usize, minimized: Option<&str>) -> String {
    let seconds = o.time.as_secs_f64();
    let what = if minimized.is_some() { "iteration" } else { "step" };
    let several = if o.steps == 1 { "" } else { "s" };
    let mut line = format!("{} {what}{several} in {}", count(o.steps as f64), duration(seconds));
    if let Some(stop) = minimized.and_then(|text| text.split_once("Stopping criterion = ")) {
        line += &format!(", ended by: {}", stop.1.lines().next().unwrap_or_default());
    } else if o.steps > 0 && seconds > 0.0 {
        let rate = o.steps as f64 / seconds;
        line += &format!(": {} steps/s, {} particle steps/s", count(rate), about(rate * particles as f64));
    }
    line
}

/// The name of the log file, if there is one.
fn log_file(log: &Log) -> Option<String> {
    log.path().map(|path| path.display().to_string())
}
