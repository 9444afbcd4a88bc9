//! A session that is typed: one text after the other, looked at and taken back in between.

use super::Session;
use crate::graph::env::DeckEnv;
use crate::graph::{Graph, NodeId, Role};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Command, Expr, Script, Vars};
use perigrain_plan::explain;
use perigrain_world::{Compat, World};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// What became of a text that was typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heard {
    /// The status of `quit`.
    pub quit: Option<i32>,
    /// Ended from outside: a run at a whole step, anything else between two lines.
    pub interrupted: bool,
}

/// Names that exist at the moment, in the order a list shows them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// Groups.
    pub groups: Vec<String>,
    /// Regions.
    pub regions: Vec<String>,
    /// Fixes.
    pub fixes: Vec<String>,
    /// Computes.
    pub computes: Vec<String>,
    /// Dumps.
    pub dumps: Vec<String>,
    /// Variables.
    pub variables: Vec<String>,
    /// Materials.
    pub materials: Vec<String>,
    /// Labels.
    pub labels: Vec<String>,
    /// The pair style.
    pub pair: Option<String>,
}

/// A session's state at some moment.
pub struct Snapshot {
    vars: Vars,
    graph: Graph,
    world: Arc<World>,
    compat: Compat,
    dialect: super::dialect::Dialect,
    ran: bool,
    typed: Option<Script>,
    timer: super::timer::Timer,
    /// Bytes of the world; 0 where it is shared with an earlier snapshot.
    pub bytes: u64,
}

impl Session {
    /// Executes a text that was typed; `name` stands in messages about it.
    ///
    /// # Errors
    /// The first line that is refused or fails. The effects of it and of the lines before it stay; [`Session::restore`] takes
    /// them back.
    pub fn eval(&mut self, name: &str, text: &str) -> Result<Heard> {
        self.hear(name, text, true)
    }

    /// Executes a deck from a file in between; `jump SELF` works there, and files named in it are looked for beside it.
    ///
    /// # Errors
    /// As [`Session::eval`], and a file that cannot be read.
    pub fn eval_file(&mut self, path: &Path) -> Result<Heard> {
        let bytes = perigrain_base::gate::read(path)
            .map_err(|e| perigrain_output::file::trouble("read the deck", path, &e))?;
        let folder = super::folder_of(path);
        let before = std::mem::replace(&mut self.options.folder, folder.clone());
        self.world.folder = folder;
        let heard = self.hear(&path.display().to_string(), &String::from_utf8_lossy(&bytes), false);
        self.world.folder.clone_from(&before);
        self.options.folder = before;
        heard
    }

    fn hear(&mut self, name: &str, text: &str, typed: bool) -> Result<Heard> {
        (self.interrupted, self.quit) = (false, None);
        self.stop_flag().store(false, Ordering::Relaxed);
        let file = self.sources.add(name, text);
        self.note_letters(file.0 as usize);
        let mut script = self.typed.take().map_or_else(|| Script::new(file), |before| before.then(file));
        self.prompt = typed.then_some(file);
        let outcome = self.execute(&mut script);
        self.prompt = None;
        self.typed = Some(script);
        let flushed = self.options.log.flush();
        outcome?;
        flushed?;
        Ok(Heard { quit: self.quit, interrupted: self.interrupted })
    }

    /// A `jump` within what is typed has nowhere to go.
    ///
    /// # Errors
    /// `jump SELF` in a typed line.
    pub(super) fn refuse_jump(&self, cmd: &Command) -> Result<()> {
        let to_self = cmd.name.text == "jump" && cmd.args.first().is_some_and(|w| w.text == "SELF");
        if !to_self || self.prompt != Some(cmd.span.file) {
            return Ok(());
        }
        Err(Diagnostic::error(Code::WRONG_ORDER, cmd.span, "there is no file here to jump in")
            .help("put the loop into a file and `include` it: `jump SELF` works there")
            .into())
    }

    /// The state now. A snapshot of an earlier moment lends its world if no line since has changed particles.
    pub fn snapshot(&self, earlier: Option<&Snapshot>) -> Snapshot {
        // Every field is named, so that a new one finds its place here or is left out knowingly.
        let Self {
            vars,
            graph,
            world,
            options,
            dialect,
            ran,
            typed,
            timer,
            // Texts read and printed so far, and fields that the next line sets anew.
            sources: _,
            notes: _,
            shown: _,
            plan: _,
            watch: _,
            worked: _,
            spent: _,
            foreseen: _,
            spoken: _,
            swept: _,
            interrupted: _,
            quit: _,
            prompt: _,
            noted: _,
            blind: _,
            born: _,
            pairless: _,
            fixless: _,
            later: _,
            seen_names: _,
            plans: _,
            plan_log: _,
            turns: _,
            behind: _,
            read_from: _,
            made: _,
            scenes: _,
            requests: _,
            checked_step: _,
            warned_of_few: _,
            columns: _,
        } = self;
        let shared = earlier.filter(|e| self.same_particles(e)).map(|e| e.world.clone());
        let bytes = if shared.is_some() { 0 } else { self.bytes() };
        Snapshot {
            vars: vars.detached(),
            graph: graph.clone(),
            world: shared.unwrap_or_else(|| Arc::new(world.clone())),
            compat: options.compat,
            dialect: dialect.clone(),
            ran: *ran,
            typed: typed.clone(),
            timer: *timer,
            bytes,
        }
    }

    fn same_particles(&self, e: &Snapshot) -> bool {
        e.graph.lines.changed() == self.graph.lines.changed()
    }

    /// Goes back to a snapshot. Files that were written stay, and so do the settings of the log.
    pub fn restore(&mut self, s: &Snapshot) {
        self.vars = s.vars.detached();
        self.graph = s.graph.clone();
        self.seen_names = self.vars.names_version();
        self.world = World::clone(&s.world);
        self.options.compat = s.compat;
        self.dialect = s.dialect.clone();
        self.ran = s.ran;
        self.checked_step = None;
        self.typed.clone_from(&s.typed);
        self.timer = s.timer;
        self.plan = None;
        self.scenes += 1;
    }

    /// The folder that files are named from beside the working folder: the deck's own.
    pub fn folder(&self) -> std::path::PathBuf {
        self.options.folder.clone()
    }

    /// Bytes the scene takes.
    pub fn bytes(&self) -> u64 {
        perigrain_world::memory::bytes(&self.world)
    }

    /// The names that exist.
    pub fn known(&self) -> Known {
        Known {
            groups: self.world.groups.names().map(String::from).collect(),
            regions: self.world.regions.keys().map(|key| key.to_string()).collect(),
            fixes: self.graph.fixes.iter().map(|f| f.id.clone()).collect(),
            computes: self.graph.computes.iter().map(|c| c.id.clone()).collect(),
            dumps: self.graph.dumps.iter().map(|d| d.id.clone()).collect(),
            variables: self.vars.names().map(String::from).collect(),
            materials: self.world.materials.keys().cloned().collect(),
            // A prompt has no file to jump in.
            labels: vec![],
            pair: self.graph.pair.as_ref().map(|p| p.pair.facts().name.to_string()),
        }
    }

    /// The plan that a `run` now would make steps with.
    ///
    /// # Errors
    /// What a run would be refused for.
    pub fn plan_text(&mut self) -> Result<String> {
        if self.world.domain.is_none() {
            return fail(Code::WRONG_ORDER, None, "there is nothing to plan: no box has been defined");
        }
        let span = self.graph.lines.nodes().last().map_or(Span::default(), |n| n.span);
        self.thermo_computes();
        Ok(explain::text(&self.seal(span)?, false))
    }

    /// The lines executed so far: number, kind, text, numbers of the lines whose names it uses.
    pub fn lines(&self) -> Vec<(usize, &'static str, &str, Vec<usize>)> {
        let (nodes, edges) = (self.graph.lines.nodes(), self.graph.lines.edges());
        let kind = |role| match role {
            Role::Declare => "declare",
            Role::Act => "act",
            Role::Run => "run",
        };
        let numbers = |from: Vec<NodeId>| from.iter().map(|n| n.0 + 1).collect();
        let lines = nodes.iter().zip(edges).enumerate();
        lines.map(|(k, (n, from))| (k + 1, kind(n.role), n.text.as_str(), numbers(from))).collect()
    }

    /// The value of a formula for every particle, as an atom-style variable would have it.
    ///
    /// # Errors
    /// A formula that cannot be read or evaluated now.
    pub fn per_particle(&mut self, formula: &str) -> Result<Vec<f64>> {
        let (formula, _) = perigrain_lang::plain_value(formula);
        let file = self.sources.add("formula", formula.as_str());
        let expr = Expr::parse(&formula, Span::new(file, 0, formula.len()))?;
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        Ok(expr.per_particle(&self.vars, &mut env)?.unwrap_or_default())
    }

    /// How wide each particle is: its diameter, else the edge of its volume, else of its share of the box.
    pub fn widths(&self) -> Vec<f64> {
        let p = &self.world.particles;
        let room: f64 =
            self.world.domain.as_ref().map_or(1.0, |d| (0..3).map(|k| d.hi[k] - d.lo[k]).product());
        let spacing = (room / p.len().max(1) as f64).cbrt();
        let of = |i: usize| match (p.radius.get(i), p.volume.get(i)) {
            (Some(r), _) if *r > 0.0 => 2.0 * r,
            (_, Some(v)) if *v > 0.0 => v.cbrt(),
            _ => spacing,
        };
        (0..p.len()).map(of).collect()
    }
}
