//! Execution of one deck: text in, diagnostics and results out.

mod acts;
mod ahead;
pub mod axes;
mod balancing;
mod belongs;
mod brief;
mod causes;
mod checking;
mod commands;
mod dialect;
mod embed;
mod ending;
mod files;
mod flow;
mod inert;
mod info;
mod interactive;
mod later;
mod leveling;
mod limits;
pub mod lines;
mod measuring;
mod minimizing;
mod options;
mod orientations;
mod overlaps;
mod overlay;
mod planning;
mod python;
mod ranks;
mod rerunning;
mod resolution;
mod restarting;
mod running;
mod scales;
mod shell;
mod solids;
mod spent;
mod stability;
mod staggering;
mod sweeping;
mod table;
mod timer;
mod tiring;
mod unused;
pub mod whole;

use crate::graph::Graph;
use crate::graph::catalogue::DECLARATIONS;
use crate::graph::env::DeckEnv;
pub use crate::graph::keywords::KEYWORDS as THERMO;
pub use ahead::{Ahead, steps_ahead};
pub use commands::OWN;
pub use embed::{Column, Columns, Global, Newcomers, Order, Rows, VariableValue};
pub use files::folder_of;
pub use interactive::{Heard, Known, Snapshot};
pub use measuring::Worked;
pub use options::{Mode, Options};
pub use overlay::{Overlay, absolute};
use perigrain_base::diag::{Code, Diagnostics, FileId, Result, Sources, Span, fail};
pub use perigrain_base::par::{set_threads, threads};
use perigrain_base::{letters, memory};
use perigrain_fixes::python_invoke::HOST;
use perigrain_lang::{Command, Flow, Line, Script, Vars, plain_value};
use perigrain_output::log::Log;
use perigrain_plan::StepPlan;
pub use perigrain_plan::run::{Made, Watch};
use perigrain_world::{Unseen, World};
pub use spent::{Part, Spent};
use std::sync::Arc;
pub use sweeping::Swept;
pub use timer::{Limit, time};

/// How a deck ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ending {
    /// `quit STATUS`, else 0.
    pub status: i32,
    /// Ended from outside.
    pub interrupted: bool,
}

/// The execution of a deck.
pub struct Session {
    /// All texts read.
    pub sources: Sources,
    /// Variables.
    pub vars: Vars,
    /// Declarations.
    pub graph: Graph,
    /// The scene.
    pub world: World,
    /// Warnings and notes so far.
    pub notes: Diagnostics,
    options: Options,
    /// The last run's plan, with its meters.
    pub plan: Option<StepPlan>,
    watch: Box<dyn Watch>,
    ran: bool,
    /// Whether the warning about few grains for so many ranks has been given.
    warned_of_few: bool,
    /// The step with which the present scene has passed the check of its bonds.
    checked_step: Option<f64>,
    shown: usize,
    interrupted: bool,
    /// The status of `quit`, here or inside `run … every`.
    quit: Option<i32>,
    /// The cursor that read what was typed last.
    typed: Option<Script>,
    /// The present text was typed, and is this one.
    prompt: Option<FileId>,
    /// Commands whose lack of effect has been noted.
    noted: std::collections::BTreeSet<String>,
    /// A file could not be looked into (`check` mode).
    blind: bool,
    timer: timer::Timer,
    worked: Worked,
    spent: Spent,
    /// What a check has seen of runs.
    foreseen: ahead::Foreseen,
    /// What runs have printed on a terminal.
    spoken: ending::Spoken,
    /// What step tables are to show beside the deck's own columns.
    columns: Vec<String>,
    /// The deck's `sweep` line.
    swept: Option<Swept>,
    born: std::time::Instant,
    /// The pair style was refused (`check` mode): that there is none is no news.
    pairless: bool,
    /// A fix was refused (`check` mode): that nothing moves is no news.
    fixless: bool,
    /// Texts looked at for definitions of variables, and the names found.
    later: (usize, Arc<std::collections::BTreeSet<String>>),
    /// The variable table's names as the graph knows them.
    seen_names: u64,
    /// The plans so far, where a deck is planned.
    plans: planning::Plans,
    /// The log that plans are written to.
    plan_log: Log,
    /// The text of the latest line.
    read_from: Option<FileId>,
    /// Lines executed, each turn of a loop counted.
    turns: u64,
    /// Lines behind which several ranks could have agreed about an end.
    behind: u64,
    /// Steps made in all runs.
    made: i64,
    /// How many scenes there have been.
    scenes: u64,
    /// Requests from outside, each text once.
    requests: std::collections::BTreeMap<String, FileId>,
    /// Whose words the deck has.
    dialect: dialect::Dialect,
}

/// No progress shown.
struct Unwatched;

impl Watch for Unwatched {
    fn step(&mut self, _made: &Made) {}
}

impl Session {
    /// A session before its first line.
    ///
    /// # Errors
    /// Variables of the command line that cannot be set.
    pub fn new(mut options: Options) -> Result<Self> {
        let plan_log = options.log.clone();
        if options.mode == Mode::Plan {
            // The text of lines about a run that is not made is no part of a plan.
            options.log = Log::silent();
        }
        let mut s = Self {
            sources: Sources::default(),
            vars: Vars::new(),
            graph: Graph { tables: options.tables.clone(), ..Graph::default() },
            world: World::default(),
            notes: Diagnostics::default(),
            options,
            plan: None,
            watch: Box::new(Unwatched),
            ran: false,
            warned_of_few: false,
            checked_step: None,
            shown: 0,
            interrupted: false,
            quit: None,
            typed: None,
            prompt: None,
            noted: Default::default(),
            blind: false,
            timer: Default::default(),
            worked: Worked::default(),
            spent: Spent::default(),
            foreseen: Default::default(),
            spoken: Default::default(),
            columns: vec![],
            swept: None,
            born: std::time::Instant::now(),
            pairless: false,
            fixless: false,
            later: Default::default(),
            seen_names: 0,
            plans: Default::default(),
            plan_log,
            read_from: None,
            turns: 0,
            behind: 0,
            made: 0,
            scenes: 0,
            requests: Default::default(),
            dialect: Default::default(),
        };
        s.dialect.choose(s.options.compat, false);
        s.vars.set_partition(s.options.partition.clone());
        for (name, values) in s.options.vars.clone() {
            let (values, odd): (Vec<_>, Vec<_>) = values.iter().map(|v| plain_value(v)).unzip();
            s.notes.0.extend(letters::note_of_value(&format!("-var {name}"), &odd.concat()));
            s.vars.set_index(&name, &values)?;
        }
        s.reset_world();
        s.limit_time();
        Ok(s)
    }

    /// Sets the observer of steps.
    pub fn set_watch(&mut self, watch: Box<dyn Watch>) {
        self.watch = watch;
    }

    /// A flag that ends a run at the next whole step when set.
    pub fn stop_flag(&self) -> Arc<std::sync::atomic::AtomicBool> {
        self.world.settings.stop.clone()
    }

    /// The command graph for graphviz' `dot`.
    pub fn dot(&self) -> String {
        crate::graph::show::dot(&self.graph)
    }

    /// An empty world with this session's settings; the computes that thermo output needs are there.
    fn reset_world(&mut self) {
        let old = &self.world.settings;
        let (stop, deadline, limit_every, agreed) =
            (old.stop.clone(), old.deadline, old.limit_every, old.agreed);
        let compat = self.options.compat;
        let promised = std::mem::take(&mut self.world.promised);
        let read_files = std::mem::take(&mut self.world.read_files);
        let host = self.world.facts.remove(*HOST);
        self.world = World::default();
        if let Some(host) = host {
            self.world.facts.insert(*HOST, host);
        }
        self.world.read_files = read_files;
        self.world.promised = promised;
        self.world.promised.instead = self.looking();
        *self.world.unseen = self.sight();
        let s = &mut self.world.settings;
        s.compat = compat;
        (s.stop, s.deadline, s.limit_every, s.agreed) = (stop, deadline, limit_every, agreed);
        s.force_list = self.options.force_list;
        s.no_skipping = self.options.no_skipping;
        s.portable = self.options.portable;
        self.world.folder = self.options.folder.clone();
        self.graph = Graph { tables: self.options.tables.clone(), ..Graph::default() };
        // Variables outlive `clear`.
        self.graph.variables = commands::variable_kinds(&self.vars);
        self.plan = None;
        self.ran = false;
        self.scenes += 1;
    }

    /// What is unknown about a scene at its beginning.
    fn sight(&self) -> Unseen {
        if self.checking() { Unseen::in_a_check() } else { Unseen::default() }
    }

    /// Executes a deck.
    ///
    /// # Errors
    /// The first line that is refused or fails; in check mode all problems of the whole deck.
    pub fn run_text(&mut self, name: &str, text: &str) -> Result<Ending> {
        let file = self.sources.add(name, text);
        self.note_letters(file.0 as usize);
        let script = Script::new(file);
        let mut script = if self.planning() { script.first_branches() } else { script };
        let outcome = self.execute(&mut script);
        self.doubt(&script);
        self.notes.0.extend(files::left_loops(&script));
        if self.planning() {
            let text = self.plans.text(&self.sources);
            self.plan_log.line_or(&text, Some(&text))?;
            self.plan_log.flush()?;
        }
        if self.checking() && !self.blind {
            let given: Vec<String> = self.options.vars.iter().map(|v| v.0.clone()).collect();
            self.notes.append(unused::unused(&self.sources, &given));
            self.notes.append(self.dialect.unused());
        }
        let flushed = self.options.log.flush();
        let ending = outcome?;
        flushed?;
        Ok(ending)
    }

    fn execute(&mut self, script: &mut Script) -> Result<Ending> {
        let mut problems = Diagnostics::default();
        let mut refused = causes::Refused::default();
        loop {
            let line = match self.next_line(script) {
                Ok(None) => break,
                Ok(Some(line)) => line,
                Err(e) if self.forgives(script, None, &e) => {
                    self.read_on(None, script.raw(), e, &mut refused);
                    continue;
                }
                Err(e) if self.checking() => {
                    let hopeless = problems.0.len() > 200;
                    problems.append(refused.causes(script.raw(), e));
                    if hopeless {
                        break;
                    }
                    continue;
                }
                Err(e) => return Err(e),
            };
            if let Some(cmd) = line.command.as_ref().filter(|_| script.is_speculative()) {
                refused.perhaps(cmd);
            }
            match self.line(script, &line) {
                Ok(Some(code)) => self.quit = Some(code),
                Ok(None) => {}
                Err(e) if self.unseen(script, &e) => {
                    if !script.is_speculative() {
                        break;
                    }
                }
                Err(e) if self.forgives(script, Some(&line), &e) => {
                    self.read_on(Some(&line), &line.raw, e, &mut refused);
                }
                Err(e) if self.checking() => problems.append(refused.causes(&line.raw, e)),
                Err(e) if self.planning() => {
                    let causes = refused.causes(&line.raw, e);
                    if !causes.is_empty() {
                        return Err(causes);
                    }
                }
                Err(e) => return Err(e),
            }
            if self.has_end_request(&line) && !self.interrupted {
                self.interrupted = true;
                self.report_interrupt(&line)?;
            }
            if self.interrupted || self.quit.is_some() {
                break;
            }
        }
        let status = self.quit.unwrap_or(0);
        if problems.is_empty() { Ok(Ending { status, interrupted: self.interrupted }) } else { Err(problems) }
    }

    /// Whether a line of a deck that is only checked failed for want of a file that only a run writes; the note is taken.
    fn unseen(&mut self, script: &Script, e: &Diagnostics) -> bool {
        if !self.looking() || e.is_empty() || e.has_errors() {
            return false;
        }
        let help = match script.is_speculative() {
            true => "what it would change is not known in the lines below",
            false => "the check ends here: what follows depends on this file",
        };
        for d in &e.0 {
            let why = if script.is_speculative() { "left out" } else { "the plan ends here" };
            self.plans.leave_open(d.span.unwrap_or_default(), format!("{why}: {}", d.message));
        }
        self.blind = true;
        self.notes.0.extend(e.0.iter().map(|d| d.clone().help(help)));
        true
    }

    fn checking(&self) -> bool {
        self.options.mode == Mode::Check
    }

    /// Whether nothing is written: the deck is checked or planned.
    fn looking(&self) -> bool {
        matches!(self.options.mode, Mode::Check | Mode::Plan)
    }

    fn next_line(&mut self, script: &mut Script) -> Result<Option<Line>> {
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        script.next(&mut self.sources, &self.vars, &mut env)
    }

    /// Executes one line; `Some(status)` when the deck is over.
    fn line(&mut self, script: &mut Script, line: &Line) -> Result<Option<i32>> {
        self.options.log.echo(&line.raw)?;
        for text in &line.echoes {
            self.options.log.echo(text)?;
        }
        let Some(cmd) = &line.command else { return Ok(None) };
        self.mark_line(cmd.span);
        if self.checking() {
            match cmd.name.text.as_str() {
                "if" => self.foresee_loop(&line.raw),
                "jump" if script.is_speculative() => self.foresee_jump(),
                _ => {}
            }
        }
        let stop = self.heeded();
        if stop.is_late() {
            return self.cut_short(&stop, line, cmd.span, &Diagnostics::default()).map(|()| None);
        }
        let outcome = stop.heed(|| self.within_limits(cmd).and_then(|()| self.command(script, cmd)));
        self.fixless |= outcome.is_err() && cmd.name.text == "fix";
        self.print_notes()?;
        if stop.has_cut() {
            let problems = outcome.err().unwrap_or_default();
            return self.cut_short(&stop, line, cmd.span, &problems).map(|()| None);
        }
        outcome.map_err(|e| {
            let e = self.with_dialect(e, cmd);
            let placed = belongs::add_places(self.sources.adopt(e), cmd, &self.graph.tables);
            checking::with_origins(placed.at(cmd.span), cmd)
        })
    }

    /// The line that runs now, which a message on missing memory names.
    fn mark_line(&mut self, line: Span) {
        if self.read_from.replace(line.file) != Some(line.file)
            && let Some(text) = self.sources.keep(line.file)
        {
            memory::reads(text);
        }
        memory::at(line);
    }

    /// Warnings go to screen and log as they come.
    fn print_notes(&mut self) -> Result<()> {
        self.notes.0.extend(self.world.read_files.take_notes());
        if self.checking() {
            return Ok(());
        }
        if let Some(path) = self.options.log.take_shared() {
            self.notes.push(files::shared(&path));
        }
        for d in &self.notes.0[self.shown..] {
            let one = Diagnostics(vec![d.clone()]);
            let text = perigrain_base::diag::render::plain(&one, &self.sources);
            self.options.log.line(text.trim_end())?;
        }
        self.shown = self.notes.0.len();
        Ok(())
    }

    fn command(&mut self, script: &mut Script, cmd: &Command) -> Result<Option<i32>> {
        let native = self.dialect.formula(cmd);
        let cmd = native.as_ref().unwrap_or(cmd);
        match self.flow(script, cmd)? {
            Flow::Quit(status) => {
                self.check_rest(script);
                return Ok(Some(status));
            }
            Flow::Done => return Ok(None),
            Flow::NotMine => {}
        }
        let name = cmd.name.text.as_str();
        // Of branches that only a run can choose, a plan has taken another one; and a scene that may be gone is there.
        if script.is_aside() || (name == "clear" && self.looking() && script.is_speculative()) {
            return Ok(None);
        }
        self.note_open(script, cmd);
        if !["print", "log", "echo", "info"].contains(&name) {
            script.changed();
        }
        match self.translated(cmd)? {
            None => self.carry_out(script, cmd),
            Some(lines) => self.carry_out_all(script, &lines),
        }
    }

    /// Carries out a native line.
    fn carry_out(&mut self, script: &mut Script, cmd: &Command) -> Result<Option<i32>> {
        let name = cmd.name.text.as_str();
        if let Some(carry) = table::own(name) {
            return carry(self, script, cmd);
        }
        if DECLARATIONS.contains(&name) {
            self.declare(cmd)?;
        } else if let Some(style) = self.graph.tables.command(name) {
            self.act(cmd, style)?;
        } else {
            return Err(belongs::unknown_command(cmd, &self.graph.tables));
        }
        Ok(None)
    }
}

fn refuse<T>(code: Code, span: Span, text: impl Into<String>) -> Result<T> {
    fail(code, span, text)
}
