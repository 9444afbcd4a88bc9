//! Commands about the session itself: print, log, echo, clear, compat.

use super::{Session, refuse};
use crate::graph::build::bring;
use crate::graph::env::DeckEnv;
use perigrain_base::diag::{Code, Result};
use perigrain_lang::{Args, Command, Kind, RefKind, Substituted, ValueRef, Vars, Word, substitute_known};
use perigrain_output::log::Echo;
use perigrain_styles::words::{self, Idle, Or, Words, alternatives, one_in};
use perigrain_styles::{BuildCx, Shape, Use, UseKind};
use perigrain_world::{Compat, GroupId, Promise};
use std::collections::BTreeMap;
use std::path::Path;

/// The session's own commands and those of the cursor, for "did you mean".
pub use crate::graph::catalogue::SESSION_COMMANDS as OWN;

/// The words of a `print` line.
#[derive(Words)]
pub struct Print {
    #[word(name = "\"text\"", what = "a text")]
    text: Word,
    /// The file that gets the line, written anew.
    #[word(keyword, name = "NAME", what = "a file name", kind = words::Kind::File)]
    file: Option<Word>,
    /// The file to which the line is added.
    #[word(keyword, name = "NAME", what = "a file name", kind = words::Kind::File)]
    append: Option<Word>,
    /// Whether the screen shows the line; the log has it anyway.
    #[word(keyword, default = true)]
    screen: bool,
    /// Read for LAMMPS' decks, without effect.
    #[word(keyword, name = "yes|no", what = "universe")]
    universe: Option<Idle<bool>>,
}

/// The words of a `log` line.
#[derive(Words)]
pub struct Logging {
    #[word(name = "FILE", what = "a file name or `none`", kind = words::Kind::Or(&NoLog::KIND, &words::Kind::File))]
    file: Or<NoLog, Word>,
    /// The file keeps what it holds.
    #[word(flag)]
    append: bool,
}

/// No log file.
#[derive(Words)]
#[word(what = "log file")]
enum NoLog {
    /// Ends logging.
    None,
}

/// The word of an `echo` line.
#[derive(Words)]
pub struct Echoing {
    #[word(name = "where", with = echo, kind = words::Kind::Choice(&alternatives(&Echo::NAMES)))]
    pub(super) echo: Echo,
}

fn echo(args: &mut Args, _: &BuildCx) -> Result<Echo> {
    let word = args.expect("none, screen, log or both")?;
    match Echo::parse(&word.text) {
        Some(echo) => Ok(echo),
        None => refuse(Code::BAD_VALUE, word.span, "echo takes none, screen, log or both"),
    }
}

/// The word of a `compat` line.
#[derive(Words)]
pub struct Compatibility {
    #[word(name = "mode", with = mode, kind = words::Kind::Choice(&alternatives(&Compat::NAMES)))]
    pub(super) mode: Compat,
}

fn mode(args: &mut Args, _: &BuildCx) -> Result<Compat> {
    one_in("mode", args, &Compat::NAMES)
}

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

    /// Begins with an empty scene.
    pub(super) fn clear(&mut self) {
        self.vars.clear_atomfiles();
        self.reset_world();
    }

    /// Chooses whether results follow LAMMPS where it is wrong.
    pub(super) fn set_compat(&mut self, compat: Compat) {
        self.options.compat = compat;
        self.world.settings.compat = compat;
        self.dialect.choose(compat, true);
        let lammps = self.world.settings.lammps();
        self.world.regions.values_mut().for_each(|region| region.open_holds_all(lammps));
        self.world.touch();
    }

    pub(super) fn print(&mut self, line: Print) -> Result<()> {
        let (word, appended) = (line.text, line.append.is_some());
        let file = match (&line.file, &line.append) {
            (Some(_), Some(second)) => {
                let text = "a line is written to one file: `file` or `append`";
                return refuse(Code::CONFLICT, second.span, text);
            }
            (file, append) => file.as_ref().or(append.as_ref()),
        };
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        let Substituted { text, unknown } = substitute_known(&word.text, word.span, &self.vars, &mut env)?;
        if self.looking() {
            if let Some(name) = file {
                let text = (!unknown && !word.unknown).then_some(text);
                self.world.promised.print(&name.text, text, appended);
            }
            return Ok(());
        }
        match line.screen {
            true => self.options.log.line(&text)?,
            false => self.options.log.to_log(&text)?,
        }
        if let Some(name) = file {
            use std::io::Write;
            let path = Path::new(&name.text);
            let mut out = perigrain_output::file::open(path, appended).map_err(|e| e.at(name.span))?;
            let failed = writeln!(out, "{text}").and_then(|()| out.flush());
            failed.map_err(|e| perigrain_output::file::trouble("write", path, &e).at(name.span))?;
        }
        Ok(())
    }

    pub(super) fn log(&mut self, Logging { file, append }: Logging) -> Result<()> {
        match file {
            Or::Word(NoLog::None) if self.looking() => Ok(()),
            Or::Word(NoLog::None) => self.options.log.close(),
            Or::Else(word) if self.looking() => {
                self.world.promised.keep(&word.text, Promise::Unseen);
                Ok(())
            }
            Or::Else(word) => {
                self.options.log.open(Path::new(&word.text), append).map_err(|e| e.at(word.span))
            }
        }
    }
}
