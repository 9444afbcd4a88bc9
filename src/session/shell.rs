//! `shell`: folders, files, environment, and commands for the system's shell.

use super::Session;
use crate::processes;
use perigrain_base::comm::{self, broadcast};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::{gate, stop};
use perigrain_lang::{Args, Command, Word};
use std::path::Path;
use std::process::{Child, ExitStatus};
use std::time::Duration;

impl Session {
    /// The `shell` command. A failure there is a warning, as in LAMMPS: the deck continues.
    ///
    /// # Errors
    /// Missing words.
    pub(super) fn shell(&mut self, cmd: &Command) -> Result<()> {
        if let Some(d) = perigrain_base::gate::forbids("a deck may not use `shell`") {
            return Err(d.at(cmd.span).into());
        }
        let mut args = Args::new(cmd);
        let what = args.expect("cd, mkdir, mv, rm, rmdir, putenv or a command")?;
        let words = match what.text.as_str() {
            "cd" => {
                let folder = args.expect("a folder")?;
                args.finish()?;
                std::slice::from_ref(folder)
            }
            "mv" => {
                args.clone().expect("the present name")?;
                let words = args.clone().rest();
                args.next();
                args.expect("the new name")?;
                args.finish()?;
                words
            }
            "mkdir" | "rm" | "rmdir" | "putenv" => {
                args.clone().expect("at least one name")?;
                args.rest()
            }
            _ => args.rest(),
        };
        if what.text == "putenv" {
            return self.putenv(words);
        }
        // a deck that is only looked at changes nothing
        if self.looking() {
            self.world.promised.anything = true;
            return Ok(());
        }
        self.options.log.flush()?;
        match what.text.as_str() {
            "cd" => self.change_folder(&words[0]),
            "mv" => self.tried(cmd.span, gate::once(|| std::fs::rename(&words[0].text, &words[1].text))),
            "mkdir" => {
                words.iter().for_each(|w| self.tried(w.span, gate::once(|| std::fs::create_dir(&w.text))));
            }
            "rmdir" => {
                words.iter().for_each(|w| self.tried(w.span, gate::once(|| std::fs::remove_dir(&w.text))));
            }
            "rm" => {
                let silent = words[0].text == "-f";
                for w in &words[usize::from(silent)..] {
                    let outcome = gate::once(|| std::fs::remove_file(&w.text));
                    if !silent {
                        self.tried(w.span, outcome);
                    }
                }
            }
            _ => self.system(what, words, cmd.span),
        }
        Ok(())
    }

    /// `VAR=VALUE …`; a word without `=` sets an empty value.
    fn putenv(&mut self, words: &[Word]) -> Result<()> {
        for w in words {
            let (key, value) = w.text.split_once('=').unwrap_or((&w.text, ""));
            if key.is_empty() || w.text.contains('\0') {
                return fail(Code::BAD_VALUE, w.span, format!("`{}` is not of the form NAME=value", w.text));
            }
            self.vars.set_environment(key, value);
        }
        Ok(())
    }

    /// Changes the working folder; the deck's own folder stays where it is.
    fn change_folder(&mut self, folder: &Word) {
        for own in [&mut self.options.folder, &mut self.world.folder] {
            let from = if own.as_os_str().is_empty() { Path::new(".") } else { own.as_path() };
            if let Ok(whole) = std::path::absolute(from) {
                *own = whole;
            }
        }
        self.tried(folder.span, gate::once(|| std::env::set_current_dir(&folder.text)));
    }

    /// A line for the system's shell, with the deck's environment.
    fn system(&mut self, what: &Word, words: &[Word], span: Span) {
        let line: Vec<&str> = std::iter::once(what).chain(words).map(|w| w.text.as_str()).collect();
        let line = line.join(" ");
        // Of several ranks the first one does it.
        let trouble = broadcast::text(|| {
            let mut shell = std::process::Command::new("sh");
            comm::set_apart(&mut shell);
            let child = shell.arg("-c").arg(&line).envs(self.vars.environment()).spawn();
            match child.and_then(waited) {
                Ok(s) if s.success() => None,
                Ok(s) => Some(format!("`{line}` ended with {s}")),
                Err(e) => Some(format!("`{line}` could not be started: {e}")),
            }
        });
        if let Some(trouble) = trouble {
            self.warn(span, trouble);
        }
    }

    fn tried(&mut self, span: Span, outcome: std::io::Result<()>) {
        if let Err(e) = outcome {
            self.warn(span, format!("this did not work: {e}"));
        }
    }

    fn warn(&mut self, span: Span, text: String) {
        self.notes.push(Diagnostic::warning(Code::SUSPICIOUS, span, text));
    }
}

/// Waits for a command, and ends it when a signal requests the end of the deck.
fn waited(mut child: Child) -> std::io::Result<ExitStatus> {
    let mut pause = Duration::from_micros(200);
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if stop::cuts() {
            let below = processes::descendants(child.id());
            child.kill()?;
            processes::signal(&below, "KILL");
            return child.wait();
        }
        std::thread::sleep(pause);
        pause = (2 * pause).min(Duration::from_millis(20));
    }
}
