//! The command `python`: functions of a program that hosts the session.

use super::Session;
use crate::graph::env::DeckEnv;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_fixes::python_invoke::HOST;
use perigrain_lang::python::{Functions, PythonCommand, Source, read_command};
use perigrain_lang::{Args, Word};
use perigrain_world::outside::Host;
use std::sync::Arc;

impl Session {
    /// Has this program's functions serve variables and the command `python` from now on.
    pub fn set_functions(&mut self, program: Arc<dyn Functions>) {
        self.vars.set_functions(program);
    }

    /// Has this program's functions be called within steps (`fix python/invoke`) from now on.
    pub fn set_host(&mut self, program: Arc<dyn Host>) {
        self.world.facts.insert(*HOST, program);
    }

    /// The command `python`.
    pub(super) fn python(&mut self, args: &mut Args, span: Span) -> Result<()> {
        let Some(program) = self.vars.functions().cloned() else {
            let text =
                "perigrain has no Python inside: the command `python` works where Python hosts the run";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            return Err(d.help("run the deck from Python, with `perigrain.lammps().file(…)`").into());
        };
        if let Some(d) = perigrain_base::gate::forbids("a deck may not execute Python code") {
            return Err(d.at(span).into());
        }
        match read_command(args)? {
            PythonCommand::Source(code) => self.teach(&*program, code),
            PythonCommand::Invoked(name) => {
                let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
                self.vars.invoke(&name, span, &mut env).map(drop)
            }
            PythonCommand::Known(name, function, code) => {
                if let Some(code) = code {
                    self.teach(&*program, code)?;
                }
                if !self.looking() && !program.has(&name) {
                    return fail(Code::UNKNOWN_NAME, span, format!("the program has no function `{name}`"));
                }
                self.vars.know(name, function);
                Ok(())
            }
        }
    }

    fn teach(&self, program: &dyn Functions, code: Source) -> Result<()> {
        let (text, name, word): (String, String, &Word) = match code {
            Source::Here(word) => (word.text.clone(), "deck".into(), word),
            Source::File(word) => {
                let path = perigrain_world::reading::place(&word.text, &self.options.folder);
                if self.looking() && !perigrain_base::gate::exists(&path) {
                    return Ok(());
                }
                let bytes = perigrain_base::gate::read(&path)
                    .map_err(|e| perigrain_output::file::trouble("read the code", &path, &e).at(word.span))?;
                (String::from_utf8_lossy(&bytes).into_owned(), path.display().to_string(), word)
            }
        };
        if self.looking() {
            return Ok(());
        }
        let failed = |words: String| fail(Code::OUTSIDE, word.span, format!("the code failed: {words}"));
        program.execute(&text, &name).or_else(failed)
    }
}
