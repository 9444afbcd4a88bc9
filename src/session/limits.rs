//! What a deck may use under `-safe`: lines, steps, memory.

use super::Session;
use perigrain_base::diag::{Diagnostic, Result, Span};
use perigrain_base::gate;
use perigrain_lang::{Command, Script};
use perigrain_plan::run::{Made, Watch};
use perigrain_world::World;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// How many lines of flow control may pass between two checks of the memory.
const PASSED: u64 = 64;

/// The same for steps.
const STEPS: i64 = 100;

impl Session {
    /// Refuses a line where the deck has used up its lines or memory.
    ///
    /// # Errors
    /// It has.
    pub(super) fn within_limits(&self, cmd: &Command) -> Result<()> {
        if gate::limits().is_none() {
            return Ok(());
        }
        let lines = self.turns as f64 + 1.0;
        let mut problem = gate::beyond(lines, |l| l.lines, "lines", "one line more");
        let steers = Script::FLOW.contains(&cmd.name.text.as_str());
        if problem.is_none() && (!steers || self.turns.is_multiple_of(PASSED)) {
            problem = gate::too_much_memory();
        }
        problem.map_or(Ok(()), |d| Err(d.at(cmd.span).into()))
    }

    /// Refuses a run that makes more steps, each of `short` short ones, than the deck may make in all.
    ///
    /// # Errors
    /// It does.
    pub(super) fn steps_left(&self, steps: i64, short: i64, span: Span) -> Result<()> {
        let all = self.made as f64 + steps as f64 * short as f64;
        let of = if short > 1 { format!(" of {short} short ones each") } else { String::new() };
        let what = format!("{steps} steps{of} after {}", self.made);
        gate::beyond(all, |l| l.steps, "steps", &what).map_or(Ok(()), |d| Err(d.at(span).into()))
    }
}

/// Ends a run at a whole step where memory is used up.
pub(super) struct Warden<'a> {
    /// An additional observer of steps.
    pub watch: &'a mut dyn Watch,
    /// Ends the run.
    pub stop: Arc<AtomicBool>,
    /// Why it was ended.
    pub problem: Option<Diagnostic>,
}

impl Watch for Warden<'_> {
    fn requested(&mut self, steps: i64) {
        self.watch.requested(steps);
    }

    fn begins(&mut self, w: &World) {
        self.watch.begins(w);
    }

    fn looks(&mut self, w: &World) -> bool {
        self.watch.looks(w)
    }

    fn scene(&mut self, w: &World) {
        self.watch.scene(w);
    }

    fn step(&mut self, made: &Made) {
        self.watch.step(made);
        if made.done % STEPS == 0 && self.problem.is_none() {
            self.problem = gate::too_much_memory();
            if self.problem.is_some() {
                self.stop.store(true, Ordering::Relaxed);
            }
        }
    }
}
