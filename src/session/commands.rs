//! Commands about the session itself: print, log, echo, clear, compat.

use super::{Session, refuse};
use crate::graph::Role;
use crate::graph::build::bring;
use crate::graph::env::DeckEnv;
use perigrain_base::diag::{Code, Result};
use perigrain_lang::{Args, Command, Kind, RefKind, Substituted, ValueRef, Vars, substitute_known};
use perigrain_output::log::Echo;
use perigrain_styles::{Shape, Use, UseKind};
use perigrain_world::{Compat, GroupId, Promise};
use std::collections::BTreeMap;
use std::path::Path;

/// The session's own commands and those of the cursor, for "did you mean".
pub use crate::graph::catalogue::SESSION_COMMANDS as OWN;

/// What each variable offers, by name.
pub fn variable_kinds(vars: &Vars) -> BTreeMap<String, Shape> {
    let shape = |n: &str| match vars.kind(n) {
        Some(k) if k.per_particle() => Shape { atom: Some(1), ..Shape::default() },
        Some(Kind::Internal) => Shape { scalar: true, settable: true, ..Shape::default() },
        Some(Kind::Vector) => Shape { vector: Shape::OPEN, ..Shape::default() },
        _ => Shape { scalar: true, ..Shape::default() },
    };
    vars.names().map(|n| (n.to_string(), shape(n))).collect()
}

/// The computes, fixes and variables that the words of a line refer to.
pub fn variable_uses(cmd: &Command) -> Vec<Use> {
    let mut uses = vec![];
    for word in cmd.args.iter().filter(|w| w.text.contains('_')) {
        for part in word.text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')) {
            let Ok(Some(r)) = ValueRef::parse(part, word.span) else { continue };
            let kind = match r.kind {
                RefKind::Variable => UseKind::Variable,
                RefKind::Compute | RefKind::ComputeAtom => UseKind::Compute,
                RefKind::Fix | RefKind::FixAtom => UseKind::Fix,
            };
            uses.push(Use { kind, name: r.name });
        }
    }
    uses
}

/// What an act's line provides by name.
pub fn provided(cmd: &Command) -> Option<Use> {
    let (kind, at) = match cmd.name.text.as_str() {
        "group" => (UseKind::Group, 0),
        "region" => (UseKind::Region, 0),
        "material" => (UseKind::Material, 0),
        "calibrate" => (UseKind::Compute, 1),
        _ => return None,
    };
    cmd.args.get(at).map(|w| Use { kind, name: w.text.clone() })
}

/// What an act's line deletes by name.
pub fn deleted(cmd: &Command) -> Option<Use> {
    let deletes = matches!(cmd.name.text.as_str(), "group" | "region");
    let deletes = deletes && cmd.args.get(1).is_some_and(|w| w.text == "delete");
    provided(cmd).filter(|_| deletes)
}

impl Session {
    /// LAMMPS defines three computes by itself; they appear with the box.
    pub(super) fn thermo_computes(&mut self) {
        if self.world.domain.is_none() || self.graph.find_compute("thermo_temp").is_some() {
            return;
        }
        for (id, style, rest) in [
            ("thermo_temp", "temp", ""),
            ("thermo_press", "pressure", "thermo_temp"),
            ("thermo_pe", "pe", ""),
        ] {
            let span = perigrain_base::diag::Span::default();
            // All three are there, and take the new settings.
            let _ = bring(&mut self.graph, &mut self.world, (id, style, rest), GroupId::ALL, span);
        }
    }

    /// Handles a command about the session; `false` if it is none.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub(super) fn own_command(&mut self, cmd: &Command) -> Result<bool> {
        let mut args = Args::new(cmd);
        match cmd.name.text.as_str() {
            "print" => self.print(&mut args)?,
            "log" => self.log(&mut args)?,
            "echo" => {
                let word = args.expect("none, screen, log or both")?;
                let Some(echo) = Echo::parse(&word.text) else {
                    return refuse(Code::BAD_VALUE, word.span, "echo takes none, screen, log or both");
                };
                args.finish()?;
                self.options.log.set_echo(echo);
            }
            "clear" => {
                args.finish()?;
                self.vars.clear_atomfiles();
                self.reset_world();
            }
            "compat" => {
                let mode = args.choice("mode", &Compat::NAMES.map(|n| n.0))?;
                args.finish()?;
                let compat = Compat::from_name(mode).unwrap_or_default();
                self.options.compat = compat;
                self.world.settings.compat = compat;
                let lammps = self.world.settings.lammps();
                self.world.regions.values_mut().for_each(|region| region.open_holds_all(lammps));
                self.world.touch();
            }
            "python" => self.python(&mut args, cmd.span)?,
            "shell" => self.shell(cmd)?,
            "info" => self.info(&mut args)?,
            "timer" => self.timer(&mut args)?,
            "sweep" => self.sweep(&mut args, cmd.span)?,
            _ if self.inert(cmd)? => {}
            _ => return Ok(false),
        }
        self.record_once(cmd, Role::Act, None);
        Ok(true)
    }

    fn print(&mut self, args: &mut Args) -> Result<()> {
        let word = args.expect("a text")?;
        let (mut file, mut append, mut screen, mut universe) = (None, false, true, true);
        while let Some(key) = args.next() {
            match key.text.as_str() {
                "file" | "append" => {
                    append = key.text == "append";
                    file = Some(args.expect("a file name")?);
                }
                "screen" => screen = args.flag("screen")?,
                "universe" => universe = args.flag("universe")?,
                _ => return Err(args.unknown(key, &["file", "append", "screen", "universe"])),
            }
        }
        let _ = universe;
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        let Substituted { text, unknown } = substitute_known(&word.text, word.span, &self.vars, &mut env)?;
        if self.looking() {
            if let Some(name) = file {
                let text = (!unknown && !word.unknown).then_some(text);
                self.world.promised.print(&name.text, text, append);
            }
            return Ok(());
        }
        match screen {
            true => self.options.log.line(&text)?,
            false => self.options.log.to_log(&text)?,
        }
        if let Some(name) = file {
            use std::io::Write;
            let path = Path::new(&name.text);
            let mut out = perigrain_output::file::open(path, append).map_err(|e| e.at(name.span))?;
            let failed = writeln!(out, "{text}").and_then(|()| out.flush());
            failed.map_err(|e| perigrain_output::file::trouble("write", path, &e).at(name.span))?;
        }
        Ok(())
    }

    fn log(&mut self, args: &mut Args) -> Result<()> {
        let word = args.expect("a file name or `none`")?;
        let append = args.eat("append");
        args.finish()?;
        if self.looking() {
            self.world.promised.keep(&word.text, Promise::Unseen);
            return Ok(());
        }
        match word.text.as_str() {
            "none" => self.options.log.close(),
            name => self.options.log.open(Path::new(name), append).map_err(|e| e.at(word.span)),
        }
    }
}
