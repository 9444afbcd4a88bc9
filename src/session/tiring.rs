//! `fatigue`: the words of its line, what lets cycles pass, its table and its file.

use super::balancing::{body, ratio, springs};
use super::running::Pass;
use super::{Mode, Session};
use crate::graph::Role;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Command, Word};
use perigrain_output::file;
use perigrain_peri::criteria::fatigue::Fatigue;
use perigrain_plan::explain;
use perigrain_plan::run::fatigue::{self, End, Row, Tired};
use perigrain_plan::run::statics::{Breaking, Control, Goal, Ledger, Scene, Solver};
use perigrain_styles::peri_view::view;
use perigrain_styles::words::{self, At, Fraction, Words};
use perigrain_world::{Halt, Promise, World};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// The words of a `fatigue` line.
#[derive(Words)]
pub struct Tiring {
    /// How bonds tire away from cracks: a cycle takes A1 (ε − E1)^m1 of their life, where ε is beyond E1.
    #[word(keyword, name = "A1 m1 E1", what = "init {}", non_negative, shown = "required")]
    init: Option<[f64; 3]>,
    /// How they tire near a crack, where one of their ends or a partner of it has lost a part `cracked` of its family: A2 ε^m2.
    #[word(keyword, name = "A2 m2", what = "grow {}", non_negative, shown = "required")]
    grow: Option<[f64; 2]>,
    /// The number of cycles.
    #[word(keyword, name = "N", what = "the number of cycles", positive, shown = "required")]
    cycles: Option<f64>,
    /// The lower load of a cycle over the upper one: ε is 1 − R times the stretch of a bond.
    #[word(keyword, name = "R", what = "the ratio of loads", shown = "0")]
    ratio: Option<At<f64>>,
    /// Bonds with no more than this part of their life left break together with one whose life ends.
    #[word(keyword, name = "F", what = "the part of a life", shown = "0.02")]
    batch: Option<Fraction>,
    /// The part of its bonds without which a particle is at a crack: 0.35 to 0.43 are cut by one between two layers.
    #[word(keyword, name = "D", what = "the part of a family", shown = "0.5")]
    cracked: Option<Fraction>,
    /// The unbalanced force at an equilibrium, over the larger one of reactions and loads.
    #[word(keyword, name = "E", what = "the tolerance", positive, default = 1e-6)]
    tol: f64,
    /// How many equilibria are found at most, each a step of the clock that takes no time; cycles pass between two.
    #[word(keyword, name = "M", what = "the most equilibria", from = 2, default = 10_000)]
    most: i64,
    /// A file with a row of numbers for each equilibrium.
    #[word(keyword, name = "NAME", what = "a file name", kind = words::Kind::File)]
    file: Option<Word>,
}

/// What a line requests, once its words are complete.
struct Goals {
    rules: Fatigue,
    cycles: f64,
    batch: f64,
    statics: Goal,
    file: Option<Word>,
}

impl Tiring {
    fn goals(self, span: Span) -> Result<Goals> {
        let missing = |word: &str| {
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, span, format!("`fatigue` needs `{word}`"));
            d.help("fatigue init A1 m1 E1 grow A2 m2 cycles N")
        };
        let init = self.init.ok_or_else(|| missing("init A1 m1 E1"))?;
        let grow = self.grow.ok_or_else(|| missing("grow A2 m2"))?;
        let cycles = self.cycles.ok_or_else(|| missing("cycles N"))?;
        let ratio = match self.ratio {
            Some(at) if !at.unknown && (at.value.is_nan() || at.value >= 1.0 || at.value.is_infinite()) => {
                let text = "the ratio of loads must be below 1: the lower load over the upper one";
                return Err(Diagnostic::error(Code::BAD_VALUE, at.span, text).into());
            }
            at => at.map_or(0.0, |at| at.value),
        };
        let statics = Goal {
            steps: self.most,
            tol: self.tol,
            breaking: Breaking::One,
            most: ROUNDS,
            control: Control::Load,
            until: None,
            adapt: true,
            solver: Solver::Newton,
        };
        let cracked = self.cracked.map_or(0.5, |part| part.0);
        let batch = self.batch.map_or(0.02, |batch| batch.0);
        Ok(Goals { rules: Fatigue { init, grow, ratio, cracked }, cycles, batch, statics, file: self.file })
    }
}

/// How often a body is balanced at one number of cycles at most, each time with other bonds.
const ROUNDS: usize = 10_000;

impl Session {
    pub(super) fn fatigue(&mut self, cmd: &Command) -> Result<()> {
        let goals = self.read_line::<Tiring>(cmd)?.goals(cmd.span)?;
        self.steps_left(goals.statics.steps, 1, cmd.span)?;
        self.thermo_computes();
        self.record(cmd, Role::Run, None, vec![], vec![]);
        self.ready(cmd.span)?;
        self.check_run(cmd.span, false)?;
        self.check_statics(cmd.span)?;
        if let Some(word) = goals.file.as_ref().filter(|_| self.looking()) {
            self.world.promised.keep(&word.text, Promise::Unseen);
        }
        if self.checking() {
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        self.print_notes()?;
        if self.world.clock.halt == Halt::All || self.world.settings.timed_out() {
            return Ok(());
        }
        let dt = self.world.clock.dt;
        // The loads stand.
        self.world.clock.set_dt(0.0);
        let outcome = self.tire(&goals, cmd.span, dt);
        self.world.clock.set_dt(dt);
        outcome
    }

    fn tire(&mut self, goals: &Goals, span: Span, dt: f64) -> Result<()> {
        let c = &mut self.world.clock;
        (c.first, c.last, c.halt) = (c.step, c.step.saturating_add(goals.statics.steps), Halt::No);
        (c.start, c.stop) = (c.first, c.last);
        c.began = Some(Instant::now());
        c.begin_moving();
        self.settle_resume(span)?;
        if self.planning() {
            self.plan_of(span, Pass::Statics)?;
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        let mut plan = self.sealed(span, Pass::Statics)?.0;
        self.world.slots.invalidate();
        let (held, led) = self.held();
        (self.world.clock.running, self.world.clock.named_dt) = (true, Some(dt));
        let mut sheet = Sheet::open(goals.file.as_ref())?;
        let (w, watch) = (&mut self.world, self.watch.as_mut());
        let body = move |w: &World| body(w, (held, led), true, span);
        let mut tire = |w: &mut World, left: f64| tired(w, goals, left, span);
        let mut note = |row: &Row| sheet.write(row);
        let outcome = fatigue::fatigue(
            &mut plan,
            w,
            watch,
            (body, Scene { springs, ratio }),
            (goals.statics, goals.cycles),
            (&mut tire, &mut note),
        );
        (self.world.clock.running, self.world.clock.named_dt) = (false, None);
        *self.world.changed &= outcome.is_err();
        self.ran = false;
        let early = outcome.as_ref().is_ok_and(|(outcome, ..)| outcome.interrupted);
        let saved = if early { self.save_early(&mut plan) } else { Ok(()) };
        let finished = plan.finish(&mut self.world);
        self.notes.append(std::mem::take(&mut self.world.notes));
        let (outcome, end, all, ledger) = outcome.map_err(|e| e.at(span))?;
        saved.and(finished)?;
        self.made = self.made.saturating_add(outcome.steps);
        self.interrupted |= outcome.interrupted;
        self.print_notes()?;
        let text = format!("{}\n{}", sheet.table, block(end, &all, &ledger));
        self.log_end(&plan, &outcome, Some(&text), self.timer.tables())?;
        if self.options.mode == Mode::Measure {
            self.options.log.line(explain::text(&plan, true).trim_end())?;
        }
        self.plan = Some(plan);
        Ok(())
    }
}

/// Lets cycles pass, no more than are left.
fn tired(w: &mut World, goals: &Goals, left: f64, span: Span) -> Result<Tired> {
    let Some(mut families) = w.families.take() else {
        let d = Diagnostic::error(Code::INCOMPLETE, span, "no peridynamic bonds that could tire");
        return Err(d.help("declare a `pair_style peri/…` and its coefficients before `fatigue`").into());
    };
    let made = view(w).map(|view| families.tire(&view, &goals.rules, left, goals.batch));
    w.families = Some(families).into();
    let made = made?;
    Ok(Tired { cycles: made.cycles, broken: made.broken, stretch: made.stretch })
}

/// The table of the log, which follows the steps, and the file.
struct Sheet {
    table: String,
    file: Option<(std::io::BufWriter<std::fs::File>, Word)>,
}

impl Sheet {
    fn open(word: Option<&Word>) -> Result<Self> {
        let mut sheet = Self { table: HEAD.to_string(), file: None };
        if let Some(word) = word {
            let out = file::open(Path::new(&word.text), false).map_err(|e| e.at(word.span))?;
            sheet.file = Some((out, word.clone()));
            sheet.put("# cycles beyond_limit life_ended broken_in_all largest_stretch")?;
        }
        Ok(sheet)
    }

    fn put(&mut self, line: &str) -> Result<()> {
        let Some((out, word)) = &mut self.file else { return Ok(()) };
        let written = writeln!(out, "{line}").and_then(|()| out.flush());
        written.map_err(|e| file::trouble("write", Path::new(&word.text), &e).at(word.span).into())
    }

    fn write(&mut self, row: &Row) -> Result<()> {
        self.table.push('\n');
        self.table += &format!(
            "{:<14} {:<13} {:<11} {:<14} {:<12} {:<7} {:<9} {}",
            general(row.cycles, 8),
            row.torn,
            row.tired,
            row.broken,
            general(row.stretch, 6),
            row.newton,
            row.products,
            general(row.seconds, 3)
        );
        let Row { cycles, torn, tired, broken, stretch, .. } = row;
        let numbers = [*cycles, *stretch].map(|a| general(a, 17));
        self.put(&format!("{} {torn} {tired} {broken} {}", numbers[0], numbers[1]))
    }
}

/// The head of the table of cycles.
const HEAD: &str =
    "cycles         beyond limit  life ended  broken in all  stretch      Newton  products  seconds";

/// The results.
fn block(end: End, all: &Row, ledger: &Ledger) -> String {
    let short = |x: f64| general(x, 8);
    let why = match end {
        End::Cycles => "all cycles have passed",
        End::Equilibria => "as many equilibria as `most` allows",
        End::RunsAway => "bonds break without further cycles",
        End::Halted => "a fix has halted it",
        End::Ended => "ended early",
    };
    format!(
        "Fatigue:\n  Cycles = {} ({why})\n  Bonds broken = {}\n  Newton's steps, products with the stiffness = {} {}\n  \
         Released by bonds, relaxed = {} {}",
        short(all.cycles),
        all.broken,
        all.newton,
        all.products,
        short(ledger.released),
        short(ledger.relaxed)
    )
}
