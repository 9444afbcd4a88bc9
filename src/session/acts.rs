//! Declarations, and lines that change the scene, done at once; where a deck is only looked at, only as far as the scene is known.

use super::planning::depends_on_a_run;
use super::{Mode, Session, brief, commands, later};
use crate::graph::Role;
use crate::graph::build::declare;
use crate::graph::declaration::Context;
use crate::graph::env::DeckValues;
use crate::graph::regions::place_following;
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Command};
use perigrain_styles::{ActCx, CommandStyle};
use perigrain_world::{GroupId, Promise, World};
use std::cell::RefCell;
use std::sync::Arc;

impl Session {
    /// Puts a declaration into the graph.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub(super) fn declare(&mut self, cmd: &Command) -> Result<()> {
        self.thermo_computes();
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: cmd.span, checking: self.unsure(), notes: &notes, uses: &uses };
        if cmd.name.text == "fix" {
            self.graph.later = later::defined(&self.sources, &mut self.later);
        }
        let outcome = declare(&mut self.graph, &mut self.world, cmd, &cx);
        self.graph.later = Default::default();
        self.notes.append(notes.into_inner());
        if cmd.name.text == "pair_style" {
            self.pairless = outcome.is_err();
        }
        let declared = outcome?;
        if let Some(name) = &declared.deletes {
            self.graph.lines.delete(name);
        }
        self.record(cmd, Role::Declare, declared.provides, uses.into_inner(), vec![]);
        Ok(())
    }

    /// Carries out a line that changes the scene.
    ///
    /// # Errors
    /// Every mistake in the line, and what can only be known with the particles at hand.
    pub(super) fn act(&mut self, cmd: &Command, style: &'static dyn CommandStyle) -> Result<()> {
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: cmd.span, checking: self.checking(), notes: &notes, uses: &uses };
        let (mut lines, mut then, mut left) = (vec![], vec![], None);
        let outcome: Result<Vec<&'static str>> = (|| {
            let vars = Arc::new(self.vars.clone());
            let named = |name: &str| cmd.args.iter().any(|w| w.text == name);
            place_following(&mut self.world, &self.graph, &vars, named)?;
            let mut args = Args::new(cmd);
            let act = style.parse(&mut args, &cx.build(&self.graph, &self.world, "", GroupId::ALL))?;
            args.finish()?;
            self.world.unseen.vague |= self.planning() && depends_on_a_run(cmd);
            let settles = act.settles().to_vec();
            left = act.leaves();
            if act.needs_particles() && self.passes(left.is_some()) {
                act.makes_group().map(|name| self.world.groups.find_or_add(name));
                return Ok(settles);
            }
            let mut values = DeckValues { graph: &self.graph, vars };
            self.world.spread_type_masses();
            let forgiving = self.planning() && self.unsure() && act.needs_particles();
            let group = act.makes_group().map(str::to_owned).filter(|_| forgiving);
            let world = &mut self.world;
            let leaves = act.leaves_forces();
            let outcome = act.apply(&mut ActCx {
                world,
                values: &mut values,
                span: cmd.span,
                lines: &mut lines,
                then: &mut then,
                notes: &notes,
            });
            if !leaves || outcome.is_err() {
                self.world.touch();
            }
            match outcome {
                Err(e) if forgiving => {
                    group.map(|name| self.world.groups.find_or_add(&name));
                    let why = e.0.first().map_or("", |d| d.message.as_str());
                    self.plans.leave_open(cmd.span, format!("left out: {why}"));
                }
                outcome => outcome?,
            }
            self.inherit_sight(cmd);
            Ok(settles)
        })();
        let notes = self.sources.adopt(notes.into_inner());
        self.notes.append(notes);
        self.print_summary(cmd, &lines)?;
        let settles = outcome?;
        if let Some((id, compute)) = left {
            self.graph.leave(id, style.name(), compute, cmd.span);
        }
        let deleted = commands::deleted(cmd);
        if let Some(name) = &deleted {
            self.graph.lines.delete(name);
        }
        let provides = commands::provided(cmd).filter(|_| deleted.is_none());
        self.record(cmd, Role::Act, provides, uses.into_inner(), settles);
        for (line, text) in then {
            let outcome = match self.graph.tables.command(&line.name.text) {
                Some(style) => self.act(&line, style),
                None => self.declare(&line),
            };
            outcome.map_err(|e| e.at(line.span).within(&text))?;
        }
        Ok(())
    }

    /// Prints what a command has made: its lines in the log, and one line on a terminal, unless they are results as those of
    /// `calibrate`.
    fn print_summary(&self, cmd: &Command, lines: &[String]) -> Result<()> {
        let log = &self.options.log;
        if log.brief().is_none() || cmd.name.text == "calibrate" {
            return lines.iter().try_for_each(|line| log.line(line));
        }
        if let Some(line) = brief::one_line(lines) {
            log.to_screen(&line);
        }
        lines.iter().try_for_each(|line| log.to_log(line))
    }

    /// A scene read from a file that the deck would have written is known as far as the scene was that went into it; what
    /// other commands read from such a file is not.
    fn inherit_sight(&mut self, cmd: &Command) {
        let World { promised, unseen, .. } = &mut self.world;
        for word in &cmd.args {
            let (particles, vague) = match promised.get(&word.text) {
                Some(Promise::Scene(stored, _)) => (stored.unseen.particles, stored.unseen.vague),
                Some(Promise::Text(_)) if cmd.name.text == "read_data" => continue,
                Some(_) if !cmd.name.text.starts_with("write_") => (true, true),
                _ => continue,
            };
            unseen.particles |= particles;
            unseen.vague |= vague;
        }
    }

    /// Whether an act on particles is passed over: in a check, and in a plan where its effect depends on a run.
    fn passes(&self, leaves: bool) -> bool {
        let unseen = *self.world.unseen;
        // A result of what the particles are by then is not known.
        if self.options.mode == Mode::Check || (unseen.particles && leaves) {
            return true;
        }
        self.options.mode == Mode::Plan && unseen.vague
    }
}
