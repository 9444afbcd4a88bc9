//! Lines that steer the cursor, and the nodes that all lines leave in the graph.

use super::files::RealFiles;
use super::{Session, commands};
use crate::graph::env::DeckEnv;
use crate::graph::{Node, Role};
use perigrain_base::diag::{FileId, Result};
use perigrain_base::letters;
use perigrain_lang::{Command, Flow, Script, odd_letters};
use perigrain_styles::{Use, UseKind};

/// Commands after which particles and everything that goes with them are as before.
pub(super) const LIGHT: [&str; 10] =
    ["variable", "next", "print", "info", "echo", "log", "label", "thermo", "thermo_style", "thermo_modify"];

impl Session {
    pub(super) fn flow(&mut self, script: &mut Script, cmd: &Command) -> Result<Flow> {
        self.refuse_jump(cmd)?;
        // a copy: the world is borrowed for the formulas in the line
        let promised = self.world.promised.past().clone();
        let (folder, read) = (&self.options.folder, self.world.read_files.clone());
        let overlay = &self.options.overlay;
        // A plan makes the particles of the first run, which may take long by itself.
        let since = if self.checking() { self.born } else { std::time::Instant::now() };
        let looked = (self.turns, since);
        let files = RealFiles { promised, folder, overlay, read, looking: self.looking(), looked };
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        let known = self.sources.count();
        let flow = script.flow(cmd, &mut self.sources, &mut self.vars, &mut env, &files)?;
        self.note_letters(known);
        if flow == Flow::NotMine {
            return Ok(flow);
        }
        let moved: &[perigrain_lang::Word] = match cmd.name.text.as_str() {
            "variable" => &cmd.args[..1],
            "next" => &cmd.args,
            _ => &[],
        };
        if moved.iter().any(|w| self.graph.lines.forces_use_variable(&w.text)) {
            self.world.touch();
        }
        if self.seen_names != self.vars.names_version() {
            self.seen_names = self.vars.names_version();
            self.graph.variables = commands::variable_kinds(&self.vars);
        }
        let defines = cmd.name.text == "variable";
        let named = cmd.args.first().filter(|_| defines);
        let named = named.map(|w| Use { kind: UseKind::Variable, name: w.text.clone() });
        let deleted = defines && cmd.args.get(1).is_some_and(|w| w.text == "delete");
        if let Some(name) = named.as_ref().filter(|_| deleted) {
            self.graph.lines.delete(name);
            self.world.slots.forget(&format!("v_{}", name.name));
        }
        let provides = named.filter(|_| !deleted);
        self.record_once(cmd, if defines { Role::Declare } else { Role::Act }, provides);
        Ok(flow)
    }

    /// Notes what characters of texts taken in since there were `known` of them are read as others.
    pub(super) fn note_letters(&mut self, known: usize) {
        for k in known..self.sources.count() {
            let file = FileId(k as u32);
            let text = self.sources.get(file).map_or("", |source| &source.text);
            self.notes.0.extend(letters::note(&odd_letters(text, file)));
        }
    }

    /// Records a line that loops may repeat a million times: what it names is found from its words, if they have changed.
    pub(super) fn record_once(&mut self, cmd: &Command, role: Role, provides: Option<Use>) {
        let turn = self.turn(cmd);
        if self.graph.lines.again(cmd.span, &provides, cmd.text.trim(), turn) {
            return;
        }
        self.record(cmd, role, provides, commands::variable_uses(cmd), vec![]);
    }

    pub(super) fn record(
        &mut self,
        cmd: &Command,
        role: Role,
        provides: Option<Use>,
        mut uses: Vec<Use>,
        settles: Vec<&'static str>,
    ) {
        uses.sort();
        uses.dedup();
        let turn = self.turn(cmd);
        let mut node = Node::new(role, provides, cmd.text.trim().to_string(), cmd.span);
        (node.uses, node.settles) = (uses, settles);
        self.graph.lines.add(node, turn);
    }

    /// The number of this turn of a line; no two in a session are the same.
    fn turn(&mut self, cmd: &Command) -> u64 {
        self.turns += 1;
        if !LIGHT.contains(&cmd.name.text.as_str()) {
            self.graph.lines.change(self.turns);
        }
        self.turns
    }
}

#[cfg(test)]
mod tests {
    use crate::session::{Options, Session};

    /// How many nodes, slots and variables are left by cycles of all that can be declared and deleted.
    fn left(cycles: usize, id: &str) -> (usize, usize, usize) {
        let turn = "region r# block 0 1 0 1 0 1\ngroup g# empty\nvariable v# equal $i\ncompute c# all ke\n\
                    fix f# all ave/time 1 1 1 c_c#\nfix k# g# setforce v_v# 0 0\ndump d# g# custom 100 none.txt id x\n\
                    run 0\nundump d#\nunfix f#\nunfix k#\nuncompute c#\nvariable v# delete\ngroup g# delete\n\
                    region r# delete\nnext i\njump SELF a\n";
        let file = std::env::temp_dir().join(format!("perigrain-cycles-{}", std::process::id()));
        let turn = turn.replace("none.txt", &file.to_string_lossy());
        let deck = format!(
            "units lj\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\n\
             variable i loop {cycles}\nlabel a\n{}",
            turn.replace('#', id)
        );
        let mut s = Session::new(Options::default()).unwrap();
        s.run_text("in.cycles", &deck).unwrap();
        std::fs::remove_file(file).unwrap();
        (s.graph.lines.nodes().len(), s.world.slots.len(), s.graph.variables.len())
    }

    #[test]
    fn what_cycles_have_deleted_leaves_nothing() {
        for id in ["", "$i"] {
            assert_eq!(left(2, id), left(40, id), "names with `{id}`");
        }
    }
}
