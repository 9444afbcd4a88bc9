//! Lines that steer the cursor, and the nodes that all lines leave in the graph.

use super::files::RealFiles;
use super::{Session, commands};
use crate::graph::env::DeckEnv;
use crate::graph::{Node, Role};
use perigrain_base::diag::Result;
use perigrain_lang::{Command, Flow, Script};
use perigrain_styles::{Use, UseKind};

impl Session {
    pub(super) fn flow(&mut self, script: &mut Script, cmd: &Command) -> Result<Flow> {
        self.refuse_jump(cmd)?;
        let checking = self.checking();
        // taken out for the moment: the world is borrowed for the formulas in the line
        let promised = std::mem::take(&mut self.world.parts.promised);
        let (folder, read) = (&self.options.folder, self.world.read_files.clone());
        let files = RealFiles { promised: &promised, folder, read, checking };
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph, checking };
        let flow = script.flow(cmd, &mut self.sources, &mut self.vars, &mut env, &files);
        self.world.parts.promised = promised;
        let flow = flow?;
        if flow == Flow::NotMine {
            return Ok(flow);
        }
        let moved: &[perigrain_lang::Word] = match cmd.name.text.as_str() {
            "variable" => &cmd.args[..1],
            "next" => &cmd.args,
            _ => &[],
        };
        if moved.iter().any(|w| self.graph.forces_use_variable(&w.text)) {
            self.world.touch();
        }
        if self.seen_names != self.vars.names_version() {
            self.seen_names = self.vars.names_version();
            self.graph.variables = commands::variable_kinds(&self.vars);
        }
        let defines = cmd.name.text == "variable";
        let provides = cmd.args.first().filter(|_| defines);
        let provides = provides.map(|w| Use { kind: UseKind::Variable, name: w.text.clone() });
        self.record_once(cmd, if defines { Role::Declare } else { Role::Act }, provides);
        Ok(flow)
    }

    /// Records a line that loops may repeat a million times: one node for all its turns.
    pub(super) fn record_once(&mut self, cmd: &Command, role: Role, provides: Option<Use>) {
        let text = cmd.text.trim();
        if let Some(node) = self.graph.repeated(cmd.span, &provides) {
            if node.text != text {
                node.text = text.to_owned();
                node.uses = commands::variable_uses(cmd);
            }
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
        let text = cmd.text.trim().to_string();
        self.graph.add(Node { role, provides, text, span: cmd.span, uses, settles });
    }
}
