//! Decks of LIGGGHTS: recognised by their first word that nothing else has, and read as native lines from there on.

use super::Session;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, nearest};
use perigrain_lang::{Command, Script};
use perigrain_liggghts::{Outcome, Translator, known, mark};
use perigrain_world::Compat;

/// Whose words a deck has.
#[derive(Clone, Default)]
pub(super) struct Dialect {
    /// What makes native lines of those of LIGGGHTS.
    translator: Option<Box<Translator>>,
    /// The deck has chosen another one, so that none is recognised.
    settled: bool,
    /// A `pair_coeff` line made from properties was refused: that pairs have none is no news.
    pub(super) lawless: bool,
}

impl Dialect {
    /// Follows `-compat` or, where `by_line`, a `compat` line.
    pub(super) fn choose(&mut self, compat: Compat, by_line: bool) {
        self.settled |= by_line || compat.lammps();
        match compat {
            Compat::Liggghts => drop(self.translator.get_or_insert_default()),
            _ => self.translator = None,
        }
    }

    /// A `variable` line with native references, where it has others: the language reads it, not a style.
    pub(super) fn formula(&self, cmd: &Command) -> Option<Command> {
        let translator = self.translator.as_ref().filter(|_| cmd.name.text == "variable")?;
        translator.referring(cmd)
    }
}

impl Dialect {
    /// Warnings about what the deck defines and never uses.
    pub(super) fn unused(&self) -> Diagnostics {
        self.translator.as_ref().map_or_else(Diagnostics::default, |translator| translator.unused())
    }
}

impl Session {
    /// The native lines of a line of LIGGGHTS; `None` where the line is native itself.
    ///
    /// # Errors
    /// What is wrong with the line, or without counterpart.
    pub(super) fn translated(&mut self, cmd: &Command) -> Result<Option<Vec<Command>>> {
        if self.dialect.translator.is_none() {
            if self.dialect.settled {
                return Ok(None);
            }
            let Some(word) = mark(cmd) else { return Ok(None) };
            self.recognise(cmd, &word);
        }
        let Some(translator) = &mut self.dialect.translator else { return Ok(None) };
        let outcome = translator.line(cmd);
        for note in translator.take_notes().0 {
            self.note_once(note);
        }
        match outcome {
            Ok(Outcome::NotMine) => Ok(None),
            Ok(Outcome::Native(lines)) => Ok(Some(lines)),
            Err(e) => {
                self.pairless |= cmd.name.text == "pair_style";
                self.dialect.lawless |= cmd.name.text == "run";
                Err(e)
            }
        }
    }

    /// The rest of the deck is one of LIGGGHTS.
    fn recognise(&mut self, cmd: &Command, word: &str) {
        self.set_compat(Compat::Liggghts);
        let text = format!("this deck speaks LIGGGHTS ({word}): read as with -compat liggghts");
        let note = Diagnostic::note(Code::DIALECT, cmd.span, text);
        self.note_once(note.help("`perigrain translate DECK` prints its native lines"));
    }

    /// Carries out the native lines of one line, whose messages name the line they are about.
    ///
    /// # Errors
    /// The first of them that is refused or fails.
    pub(super) fn carry_out_all(&mut self, script: &mut Script, lines: &[Command]) -> Result<Option<i32>> {
        for line in lines {
            let outcome = self.carry_out(script, line);
            self.dialect.lawless |= outcome.is_err() && line.name.text == "pair_coeff";
            if let Some(status) = outcome.map_err(|e| read_as(self.sources.adopt(e), line))? {
                return Ok(Some(status));
            }
        }
        Ok(None)
    }

    /// Adds to the problems of a line what its words are in LIGGGHTS.
    pub(super) fn with_dialect(&self, problems: Diagnostics, cmd: &Command) -> Diagnostics {
        let codes = [Code::UNKNOWN_COMMAND, Code::UNKNOWN_STYLE, Code::NOT_SUPPORTED];
        let unknown = |d: &Diagnostic| codes.contains(&d.code);
        if !problems.0.iter().any(unknown) {
            return problems;
        }
        let help = match &self.dialect.translator {
            Some(_) => own_word(cmd),
            None => mark(cmd).map(|word| {
                let now = self.options.compat.name();
                format!("`{word}` is a word of LIGGGHTS, which `compat {now}` does not read: `compat liggghts` does")
            }),
        };
        let Some(help) = help else { return problems };
        Diagnostics(
            problems.0.into_iter().map(|d| if unknown(&d) { d.help(help.clone()) } else { d }).collect(),
        )
    }
}

/// The word of LIGGGHTS that a style is nearest to.
fn own_word(cmd: &Command) -> Option<String> {
    let command = cmd.name.text.as_str();
    let at = if ["fix", "compute", "dump"].contains(&command) { 2 } else { 0 };
    let near = nearest(&cmd.args.get(at)?.text, known(command))?;
    Some(format!("or `{near}`, as LIGGGHTS has it?"))
}

/// The problems of a native line, with that line.
fn read_as(problems: Diagnostics, line: &Command) -> Diagnostics {
    let text = format!("note: read as: {}", line.text);
    Diagnostics(problems.0.into_iter().map(|d| d.help(text.clone())).collect())
}
