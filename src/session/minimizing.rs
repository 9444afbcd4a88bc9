//! `minimize`: the declarations sealed for a minimization, and the text of its log.

use super::running::Pass;
use super::{Mode, Session};
use crate::graph::Role;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::{Format, Value, general};
use perigrain_fixes::Minimizing;
use perigrain_lang::Command;
use perigrain_plan::explain;
use perigrain_plan::run::minimize::{self, Goal, Stats, Stop};
use perigrain_styles::matter::check_masses;
use perigrain_styles::words::Words;
use perigrain_world::minimizer::MinStyle;
use perigrain_world::{Halt, NeighborSettings};
use std::time::Instant;

/// The words of a `minimize` line.
#[derive(Words)]
pub struct Minimize {
    /// The part of the energy by which an iteration changes it at the end.
    #[word(name = "ETOL", what = "the energy tolerance", non_negative)]
    etol: f64,
    /// The length of all forces together at the end [force; force density for peridynamic particles in LAMMPS' convention].
    #[word(name = "FTOL", what = "the force tolerance", non_negative)]
    ftol: f64,
    /// How many iterations are made at most.
    #[word(name = "MAXITER", what = "the most iterations", from = 0)]
    iterations: i64,
    /// How often forces are evaluated at most (`cg` and `sd` only, as in LAMMPS).
    #[word(name = "MAXEVAL", what = "the most evaluations of forces", from = 0)]
    evaluations: i64,
}

impl Session {
    pub(super) fn minimize(&mut self, cmd: &Command) -> Result<()> {
        let Minimize { etol, ftol, iterations, evaluations } = self.read_line(cmd)?;
        let goal = Goal { etol, ftol, iterations, evaluations };
        self.steps_left(goal.iterations, 1, cmd.span)?;
        self.made = self.made.saturating_add(goal.iterations);
        self.thermo_computes();
        self.record(cmd, Role::Run, None, vec![], vec![]);
        self.ready(cmd.span)?;
        self.check_run(cmd.span, false)?;
        if matches!(self.world.settings.minimizer.style, MinStyle::Fire | MinStyle::Quickmin) {
            check_masses(&self.world, cmd.span)?;
        }
        self.note_absent();
        if self.checking() {
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        self.print_notes()?;
        if self.world.clock.halt == Halt::All || self.world.settings.timed_out() {
            return Ok(());
        }
        let neighbor = self.world.settings.neighbor.clone();
        let outcome = self.eager_lists().and_then(|()| self.search(goal, cmd.span));
        self.world.settings.neighbor = neighbor;
        outcome
    }

    /// Fixes that push particles in runs but not here.
    fn note_absent(&mut self) {
        let absent = |f: &&crate::graph::FixNode| f.fix.facts(&self.world).minimizing == Minimizing::Absent;
        let notes: Vec<Diagnostic> = (self.graph.fixes.iter().filter(absent))
            .map(|f| {
                let text = format!("fix {} does not act while `minimize` moves particles", f.style);
                Diagnostic::warning(Code::NO_EFFECT, f.span, text)
            })
            .collect();
        notes.into_iter().for_each(|n| self.note_once(n));
    }

    /// Lists are looked at before every evaluation: steps may be long.
    fn eager_lists(&mut self) -> Result<()> {
        let s = &mut self.world.settings.neighbor;
        if (s.every, s.delay) == (1, 0) {
            return Ok(());
        }
        *s = NeighborSettings { every: 1, delay: 0, check: true, ..s.clone() };
        let text = "Switching to 'neigh_modify every 1 delay 0 check yes' setting during minimization";
        self.options.log.line(text)
    }

    fn search(&mut self, goal: Goal, span: Span) -> Result<()> {
        let c = &mut self.world.clock;
        (c.first, c.last, c.halt) = (c.step, c.step.saturating_add(goal.iterations), Halt::No);
        (c.start, c.stop) = (c.first, c.last);
        c.began = Some(Instant::now());
        c.begin_minimizing();
        self.settle_resume(span)?;
        if self.planning() {
            self.plan_of(span, Pass::Minimization)?;
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        let (mut plan, energy) = self.sealed(span, Pass::Minimization)?;
        self.world.slots.invalidate();
        let normalized = self.graph.thermo.normalized(&self.world);
        let read = |w: &perigrain_world::World| {
            let total = energy.map_or(0.0, |e| e.get(w));
            if normalized { total / w.n().max(1) as f64 } else { total }
        };
        (self.world.clock.running, self.world.clock.named_dt) = (true, Some(self.world.clock.dt));
        let watch = self.watch.as_mut();
        let outcome = minimize::minimize(&mut plan, &mut self.world, watch, (&read, normalized), goal);
        (self.world.clock.running, self.world.clock.named_dt) = (false, None);
        // Energies belong to the scene now; the next run computes forces anew, as velocities may have changed since.
        *self.world.changed &= outcome.is_err();
        self.ran = false;
        let saved = match &outcome {
            Ok((_, stats)) if stats.stop != Stop::Iterations => self.save_early(&mut plan),
            _ => Ok(()),
        };
        let finished = plan.finish(&mut self.world);
        let (outcome, stats) = outcome.map_err(|e| e.at(span))?;
        saved.and(finished)?;
        self.interrupted |= outcome.interrupted;
        self.log_end(&plan, &outcome, Some(&block(&stats)), self.timer.tables())?;
        if self.options.mode == Mode::Measure {
            self.options.log.line(explain::text(&plan, true).trim_end())?;
        }
        self.plan = Some(plan);
        Ok(())
    }
}

/// LAMMPS' block of results.
fn block(s: &Stats) -> String {
    let wide =
        |x: f64| Format::parse("%18.15g").map_or_else(|_| general(x, 15), |f| f.text(&[Value::Float(x)]));
    let short = |x: f64| general(x, 8);
    format!(
        "Minimization stats:\n  \
         Stopping criterion = {}\n  \
         Energy initial, next-to-last, final = \n    {} {} {}\n  \
         Force two-norm initial, final = {} {}\n  \
         Force max component initial, final = {} {}\n  \
         Final line search alpha, max atom move = {} {}\n  \
         Iterations, force evaluations = {} {}",
        s.stop.text(),
        wide(s.energy[0]),
        wide(s.energy[1]),
        wide(s.energy[2]),
        short(s.two_norm[0]),
        short(s.two_norm[1]),
        short(s.largest[0]),
        short(s.largest[1]),
        short(s.alpha),
        short(s.alpha * s.largest[1]),
        s.iterations,
        s.evaluations
    )
}
