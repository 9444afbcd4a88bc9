//! `run` and `write_dump`: seal the declarations, step, report the outcome.

use super::limits::Warden;
use super::planning::depends_on_a_run;
use super::{Mode, Session, refuse};
use crate::graph::Role;
use crate::graph::declaration::Context;
use crate::graph::dumps::once_dump;
use crate::graph::env::DeckEnv;
use crate::graph::ledger;
use crate::graph::ops::{ClearForces, Reneighbor};
use crate::graph::seal::Sealer;
use crate::graph::spatial;
use perigrain_base::comm;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::gate;
use perigrain_fixes::{AtRest, Minimizing};
use perigrain_lang::{Args, Command, Script, Word};
use perigrain_output::thermo::{Finish, Section};
use perigrain_pairs::{GRANULAR_RULES, PLASTIC_GRAIN, TILES};
use perigrain_plan::run::{Pace, verlet};
use perigrain_plan::{OpClass, Stage, StepPlan, When, explain};
use perigrain_styles::Reading;
use perigrain_styles::words::{At, Words};
use perigrain_world::{Halt, Promise};
use std::cell::RefCell;
use std::sync::Arc;
use std::time::Instant;

/// How many stretches of a `run … every` a plan follows.
const PLANNED_STRETCHES: u32 = 1000;

/// What a plan is sealed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Steps in time; an observer checks whether energy grows from nothing.
    Run,
    /// Snapshots are read.
    Rerun,
    /// A minimization: fixes that do not act in it are left out, and the energy is read.
    Minimization,
    /// Load steps: integrators are left out.
    Statics,
}

/// The words of a `run` line.
#[derive(Words)]
pub struct Run {
    /// The number of steps; 0 computes forces, energies and output of the present state.
    #[word(name = "N")]
    steps: At<i64>,
    /// `N` is the step to arrive at.
    #[word(flag)]
    upto: bool,
    /// The first step of ramps (`ramp()`, `fix setforce` with variables …) that several runs share.
    #[word(keyword, name = "N1", what = "the first step of ramps", shown = "the run's first")]
    start: Option<i64>,
    /// The last step of such ramps.
    #[word(keyword, name = "N2", what = "the last step of ramps", shown = "the run's last")]
    stop: Option<i64>,
    /// Read for LAMMPS' decks.
    #[word(keyword, default = true)]
    pre: bool,
    /// Whether tables of time and neighbours follow the run.
    #[word(keyword, default = true)]
    post: bool,
    /// Stops every `M` steps and carries out the commands, each in quotes; `NULL` stands for none.
    #[word(keyword, name = "commands")]
    every: Option<Every>,
}

/// Commands within a run.
#[derive(Words)]
struct Every {
    #[word(name = "M", what = "the interval of commands", from = 1)]
    interval: i64,
    #[word(name = "\"command\"", what = "a command in quotes, or NULL", least = 1)]
    commands: Vec<Word>,
}

impl Session {
    pub(super) fn run_command(&mut self, cmd: &Command) -> Result<()> {
        let args: Run = self.read_line(cmd)?;
        let steps = self.steps_of(&args, cmd.span)?;
        self.thermo_computes();
        self.complete_table();
        self.record(cmd, Role::Run, None, vec![], vec![]);
        self.ready(cmd.span)?;
        self.check_run(cmd.span, steps > 0)?;
        if self.checking() {
            self.foresee(cmd, steps);
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        if steps > 0 && !self.unsure() {
            self.check_resolution(cmd.span)?;
        }
        self.print_notes()?;
        if self.world.settings.timed_out() {
            let which = if self.options.limit.is_some() { "-timeout" } else { "timer timeout" };
            self.options.log.line(&format!("The limit of `{which}` has passed: no further run"))?;
            return Ok(());
        }
        if self.world.clock.halt == Halt::All {
            return Ok(());
        }
        let c = &mut self.world.clock;
        let last = c.step + steps;
        c.start = args.start.unwrap_or(c.step);
        c.stop = args.stop.unwrap_or(last);
        let known = !depends_on_a_run(cmd);
        if !self.looking() {
            self.foretell();
            self.watch.requested(steps);
        }
        match args.every {
            None => self.leg(steps, args.pre, args.post, cmd.span),
            Some(Every { interval, commands }) => {
                let commands =
                    if commands.len() == 1 && commands[0].text == "NULL" { vec![] } else { commands };
                let mut left = steps;
                let (mut first, mut stretches) = (true, 0);
                // A run of no steps is one stretch, too.
                while left > 0 || first {
                    let n = left.min(interval);
                    left -= n;
                    // Runs of their own: `pre no` and `post no` leave out the setups and summaries in between.
                    self.leg(n, args.pre || first, args.post || left == 0, cmd.span)?;
                    first = false;
                    if self.interrupted || self.world.clock.halt == Halt::All {
                        break;
                    }
                    let script = Script::of_commands(&commands);
                    let mut script = if self.planning() { script.first_branches() } else { script };
                    self.execute(&mut script)?;
                    stretches += 1;
                    if self.quit.is_some() {
                        break;
                    }
                    if self.planning() && stretches == PLANNED_STRETCHES {
                        self.world.clock.step += left;
                        let text = format!("followed for the first {stretches} stretches only");
                        self.plans.leave_open(cmd.span, text);
                        break;
                    }
                }
                Ok(())
            }
        }?;
        if self.planning() {
            self.unsee(known);
        }
        if self.interrupted {
            let step = self.world.clock.step;
            let made = steps - (last - step);
            self.graph
                .lines
                .amend(cmd.span, |text| format!("{text}  # stopped at step {step}, after {made}"));
        }
        Ok(())
    }

    /// How many steps a `run` line makes.
    ///
    /// # Errors
    /// A number of steps that cannot be made, ramps that do not enclose them.
    fn steps_of(&mut self, line: &Run, whole: Span) -> Result<i64> {
        let At { value: mut steps, span, .. } = line.steps;
        let unsure = self.world.unseen.step;
        if line.upto {
            steps = steps.saturating_sub(self.world.clock.step);
            // A run before may have ended earlier than the step counted here.
            steps = if unsure { steps.max(0) } else { steps };
        }
        if steps < 0 {
            return refuse(Code::BAD_VALUE, span, format!("a run cannot make {steps} steps"));
        }
        self.steps_left(steps, self.world.settings.run_style.short_steps(), span)?;
        let first = self.world.clock.step;
        let Some(last) = first.checked_add(steps) else {
            let text =
                format!("step {first} and {steps} more are beyond the last step there is, {}", i64::MAX);
            return refuse(Code::TOO_LARGE, span, text);
        };
        let encloses = line.start.is_none_or(|s| s <= first) && line.stop.is_none_or(|s| s >= last);
        if !encloses && !unsure {
            return refuse(Code::BAD_VALUE, whole, "start and stop must enclose the steps of this run");
        }
        Ok(steps)
    }

    /// Refuses a run without box; fills masses of types in.
    pub(super) fn ready(&mut self, span: Span) -> Result<()> {
        if self.world.domain.is_none() {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                span,
                "there is nothing to run: no box has been defined",
            )
            .help("define a box with `create_box` and particles with `create_atoms` first")
            .into());
        }
        self.world.spread_type_masses();
        self.world.columns.resize(self.world.particles.len());
        Ok(())
    }

    /// Seals the declarations into a plan.
    ///
    /// # Errors
    /// What styles miss in the scene.
    pub fn seal(&mut self, span: Span) -> Result<StepPlan> {
        Ok(self.sealed(span, Pass::Run)?.0)
    }

    /// As `seal`, for a pass of any kind over the scene; with the energy that a minimization reads.
    ///
    /// # Errors
    /// As there.
    pub(super) fn sealed(&mut self, span: Span, pass: Pass) -> Result<(StepPlan, Option<Reading>)> {
        // In both places are tried: nothing is integrated or booked.
        let minimizing = matches!(pass, Pass::Minimization | Pass::Statics);
        let vars = Arc::new(self.vars.clone());
        let respa = self.respa().filter(|_| !minimizing).cloned();
        self.graph.computes.iter().for_each(|c| c.compute.particles_joined(&mut self.world));
        self.world.bonds.lost = self.graph.thermo.lost_bond;
        self.world.facts.remove(*PLASTIC_GRAIN);
        self.world.facts.remove(*GRANULAR_RULES);
        let mut s = Sealer::new(&mut self.world, &self.graph, vars);
        s.log = self.options.log.clone();
        s.at_rest = pass == Pass::Statics;
        s.plan.levels = respa.as_ref().map(|r| r.loops.len() + 1);
        let respa = respa.unwrap_or_default();
        s.at(span);
        s.add(
            vec![
                Box::new(Reneighbor { lost: self.graph.thermo.lost, sort: !minimizing }),
                Box::new(ClearForces),
            ],
            span,
        );
        crate::graph::regions::seal(&mut s)?;
        if let Some(node) = &self.graph.pair {
            s.at(node.span);
            for (k, op) in node.pair.ops(&mut s)? {
                s.add_forces(vec![op], node.span, respa.of_pair(k));
            }
            if s.plan.levels.is_some() && s.grains_are_plastic() {
                let text = "plastic grains (`mdr`) grow once in a step, and under run_style respa it has several lengths";
                return refuse(Code::NOT_SUPPORTED, node.span, text);
            }
        }
        if let Some(node) = &self.graph.bond {
            s.at(node.span);
            let ops = node.force.ops(&mut s)?;
            s.add_forces(ops, node.span, respa.bond);
        }
        s.at(span);
        let booked = !minimizing && ledger::wanted(&s);
        if booked {
            ledger::begin(&mut s);
        }
        crate::graph::dynamic::seal(&mut s)?;
        let all = s.facts().filter(|(_, facts)| match pass {
            Pass::Minimization => facts.minimizing == Minimizing::Acts,
            Pass::Statics => !matches!(facts.at_rest, AtRest::Frees | AtRest::Idle | AtRest::Refused),
            _ => true,
        });
        let mut marks = ledger::Marks::default();
        let mut all: Vec<_> = all.collect();
        all.sort_by_key(|(_, facts)| facts.acts_last);
        for (f, _) in all {
            s.at_fix(f.span, f.level, f.group.bit());
            let ops = f.fix.ops(&mut s)?;
            let changed = if booked { ledger::changes(&ops) } else { [false; 2] };
            marks.before(&mut s, f, changed);
            s.add(ops, f.span);
            marks.after(f, changed);
        }
        marks.set(&mut s);
        s.at(span);
        if booked {
            ledger::end(&mut s)?;
        }
        crate::graph::joined::seal(&mut s);
        s.begin_computes()?;
        // Elsewhere LAMMPS' order: dumps before the row.
        let row_first = self.graph.dumps.iter().any(|d| d.dump.repeats_row());
        if row_first {
            let row = self.graph.thermo.op(&mut s, self.options.log.clone())?;
            s.add(vec![row], span);
        }
        for d in &self.graph.dumps {
            s.at(d.span);
            let op = d.dump.op(&mut s, d.every)?;
            s.add(vec![op], d.span);
        }
        s.at(span);
        let restarts = &self.graph.restarts;
        s.at(restarts.span);
        let ops = restarts.ops(&self.graph, &mut s)?;
        s.add(ops, restarts.span);
        s.at(span);
        let energy = (pass == Pass::Minimization)
            .then(|| s.keyword_total("pe", span, Stage::EndOfStep, &When::Always))
            .transpose()?;
        if !row_first {
            let row = self.graph.thermo.op(&mut s, self.options.log.clone())?;
            s.add(vec![row], span);
        }
        s.at(span);
        if pass != Pass::Minimization {
            s.end_computes()?;
        }
        crate::graph::virials::seal(&mut s)?;
        if !minimizing {
            crate::graph::guard::seal(&mut s)?;
        }
        if pass == Pass::Run {
            // Behind the guard, whose blocks end where others act.
            let rows = self.graph.thermo.when(&mut s)?;
            crate::graph::runaway::seal(&mut s, &rows)?;
            crate::graph::pressed::seal(&mut s)?;
        }
        s.note_left_out();
        s.plan.settle();
        Ok((s.plan, energy))
    }

    /// One uninterrupted stretch of steps.
    fn leg(&mut self, steps: i64, pre: bool, post: bool, span: Span) -> Result<()> {
        let c = &mut self.world.clock;
        (c.first, c.last, c.halt) = (c.step, c.step + steps, Halt::No);
        c.begin_moving();
        c.began = None;
        c.onward = self.ran && !pre;
        self.settle_resume(span)?;
        let unchanged = self.ran && !*self.world.changed && (!self.world.settings.lammps() || !pre);
        if self.planning() {
            self.plan_of(span, Pass::Run)?;
            self.world.clock.step += steps;
            self.promise_outputs();
            self.unsee(true);
            return Ok(());
        }
        let mut plan = self.seal(span)?;
        self.notes.append(std::mem::take(&mut self.world.notes));
        self.print_notes()?;
        if !unchanged {
            self.world.slots.invalidate();
        }
        if self.ran && self.world.settings.lammps() && self.world.families.is_some() {
            self.note_once(
                Diagnostic::note(
                    Code::COMPAT,
                    span,
                    "compat lammps: the setup of this run advances bond breaking",
                )
                .help("LAMMPS 22Jul2025 computes forces once more between runs; perigrain alone does not"),
            );
            self.print_notes()?;
        }
        self.warn_of_few_grains()?;
        self.world.clock.running = true;
        let pace = self.pace(span)?;
        spatial::line_up_again(&mut self.world);
        let outcome = self.steps(&mut plan, unchanged, &pace);
        self.world.clock.running = false;
        for (name, value) in std::mem::take(&mut *self.world.controls).iter() {
            self.vars.set_internal(name.text(), *value);
        }
        // What is put back at the end of a run changes the scene again.
        *self.world.changed &= outcome.is_err();
        self.ran |= outcome.is_ok();
        // Before fixes restore what they have changed for the run: a continued run needs those changes.
        let early = outcome.as_ref().is_ok_and(|(o, _)| o.interrupted || self.is_out_of_time());
        let saved = if early { self.save_early(&mut plan) } else { Ok(()) };
        let finished = plan.finish(&mut self.world);
        self.world.fall_back();
        self.notes.append(std::mem::take(&mut self.world.notes));
        let (outcome, used_up) = outcome.map_err(|e| e.at(span))?;
        saved.and(finished)?;
        let short = self.world.settings.run_style.short_steps();
        self.made = self.made.saturating_add(outcome.steps.saturating_mul(short));
        self.interrupted |= outcome.interrupted;
        if let Some(d) = used_up {
            return Err(d.at(span).into());
        }
        self.print_notes()?;
        self.log_end(&plan, &outcome, None, post && self.timer.tables())?;
        self.warn_of_overlap(span)?;
        if self.is_out_of_time() {
            self.report_timeout()?;
        }
        if self.options.mode == Mode::Measure {
            self.options.log.line(explain::text(&plan, true).trim_end())?;
            let of_bodies = self.world.families.as_ref().map(|families| families.describe_tiles());
            let of_ops = self.world.facts.remove(*TILES).unwrap_or_default().join("\n");
            let tiles = of_bodies.unwrap_or_default() + &of_ops;
            // A rank knows the times of its own tiles.
            if !tiles.is_empty() && !comm::several() {
                self.options.log.line(tiles.trim_end())?;
            }
        }
        self.plan = Some(plan);
        Ok(())
    }

    /// The setup and the steps of a run; also why it ended early, if it used up what a deck may use.
    fn steps(
        &mut self,
        plan: &mut StepPlan,
        unchanged: bool,
        pace: &Pace,
    ) -> Result<(verlet::Outcome, Option<Diagnostic>)> {
        let timed = self.timer.tables() || self.options.mode == Mode::Measure;
        pace.setup(plan, &mut self.world, unchanged)?;
        // Problems known before the first step are reported before it.
        self.notes.append(std::mem::take(&mut self.world.notes));
        self.print_notes()?;
        self.options.log.flush()?;
        if self.options.mode == Mode::Measure {
            self.world.facts.insert(*TILES, vec![]);
            if let Some(families) = &mut *self.world.families {
                families.time_tiles();
            }
        }
        let (w, watch) = (&mut self.world, self.watch.as_mut());
        plan.reset_meters(timed);
        watch.begins(w);
        w.clock.began = Some(Instant::now());
        if gate::limits().is_none() {
            return Ok((pace.run(plan, w, watch)?, None));
        }
        if let Some(d) = gate::too_much_memory() {
            return Err(d.into());
        }
        let mut warden = Warden { watch, stop: w.settings.stop.clone(), problem: None };
        let outcome = pace.run(plan, w, &mut warden)?;
        Ok((outcome, warden.problem))
    }

    /// The text at the end of a run, or of a minimization with its own block of text.
    pub(super) fn log_end(
        &mut self,
        plan: &StepPlan,
        o: &verlet::Outcome,
        minimized: Option<&str>,
        post: bool,
    ) -> Result<()> {
        self.worked.add(o);
        self.spend(plan);
        let few = self.in_three_lines(plan, o, minimized, post);
        let log = &self.options.log;
        let times = plan.time_by_class();
        let section = |name, class| Section {
            name,
            seconds: times.iter().find(|(c, _)| *c == class).map_or(0.0, |(_, t)| t.as_secs_f64()),
        };
        let sections = [
            section("Pair", OpClass::Pair),
            section("Neigh", OpClass::Neigh),
            Section { name: "Comm", seconds: 0.0 },
            section("Output", OpClass::Output),
            section("Modify", OpClass::Modify),
        ];
        let full = perigrain_world::memory::neighbors(&self.world);
        let finish = Finish {
            seconds: o.time.as_secs_f64(),
            cpu: o.cpu,
            steps: o.steps,
            atoms: self.world.n() as u64,
            threads: perigrain_base::par::most_threads(),
            units: self.world.settings.units.name(),
            time: o.steps as f64 * self.world.clock.dt,
            sections: if post { &sections } else { &[] },
            full,
            builds: self.world.rebuild.builds,
            dangerous: self.world.rebuild.dangerous,
            minimized,
        };
        let text = finish.text();
        let shown = if post { text.as_str() } else { text.lines().next().unwrap_or("") };
        log.line_or(shown, Some(&few))?;
        if post {
            let ops: Vec<(&str, f64, u64)> = plan
                .ops
                .iter()
                .map(|p| (&*p.about.name, p.meter.time.as_secs_f64(), p.meter.calls))
                .collect();
            log.line_or(perigrain_output::thermo::ops_table(&ops, finish.seconds).trim_end(), None)?;
        }
        if o.interrupted {
            log.line(&format!("Interrupted at step {}: all files are complete", self.world.clock.step))?;
        }
        log.flush()
    }

    pub(super) fn write_dump(&mut self, cmd: &Command) -> Result<()> {
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: cmd.span, checking: self.checking(), notes: &notes, uses: &uses };
        let dump = once_dump(&self.graph, &self.world, &mut Args::new(cmd), &cx);
        self.notes.append(notes.into_inner());
        let dump = dump?;
        if let Some(doubt) = dump.doubts(&self.world) {
            self.note_once(doubt.at(cmd.span));
        }
        self.record(cmd, Role::Act, None, uses.into_inner(), vec![]);
        if self.looking() {
            let file = cmd.args.get(2).map_or("", |w| &w.text);
            self.world.promised.keep(file, Promise::Unseen);
            return Ok(());
        }
        self.drew(cmd);
        self.world.spread_type_masses();
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        env.once(cmd.span, &self.vars, |s| dump.op(s, 0))?;
        self.report_file(cmd.args.get(2).map_or("", |w| &w.text));
        Ok(())
    }
}
