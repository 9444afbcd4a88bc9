//! Where typed lines come from: a terminal with completion, hints and colours, or a pipe.

use super::hinting::{self, hint};
use super::painting::paint;
use crate::cli::progress::colors_wanted;
use crate::manual::completing::complete;
use crate::session::Known;
use perigrain_lang::is_unfinished;
use rustyline::completion::Completer;
use rustyline::error::ReadlineError;
use rustyline::highlight::{CmdKind, Highlighter};
use rustyline::hint::{Hint, Hinter};
use rustyline::history::FileHistory;
use rustyline::validate::{ValidationContext, ValidationResult, Validator};
use rustyline::{CompletionType, Config, Context, Editor, Helper};
use std::borrow::Cow;
use std::cell::RefCell;
use std::io::{BufRead, IsTerminal, Stdin, stdin};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Lines that a history file keeps.
const REMEMBERED: usize = 2000;

/// What became of a wish for a line.
pub enum Read {
    /// Here it is, with its line breaks if it has several lines.
    Text(String),
    /// Ctrl-C: the line is dropped.
    Again,
    /// Ctrl-D or the end of the pipe.
    End,
}

/// Where lines come from.
pub enum Reader {
    /// A user at a terminal.
    Terminal(Box<Editor<Assistant, FileHistory>>, Option<PathBuf>),
    /// A file or another program.
    Pipe(Stdin),
}

impl Reader {
    /// A reader of standard input that knows the session's names.
    pub fn new(known: Rc<RefCell<Known>>, folder: &Path) -> Self {
        if !stdin().is_terminal() {
            return Self::Pipe(stdin());
        }
        let config = Config::builder().completion_type(CompletionType::List).auto_add_history(false);
        let config = match config.max_history_size(REMEMBERED) {
            Ok(config) => config.build(),
            Err(_) => Config::default(),
        };
        let history = FileHistory::with_config(&config);
        let Ok(mut editor) = Editor::with_history(config, history) else {
            return Self::Pipe(stdin());
        };
        editor.set_helper(Some(Assistant { known, folder: folder.to_path_buf(), colours: colors_wanted() }));
        let history = history_file();
        if let Some(path) = &history {
            // The first session has no history yet.
            let _ = editor.load_history(path);
        }
        Self::Terminal(Box::new(editor), history)
    }

    /// Whether the input is a terminal.
    pub fn is_terminal(&self) -> bool {
        matches!(self, Self::Terminal(..))
    }

    /// The next text: as many lines as the lexer joins.
    pub fn read(&mut self) -> Read {
        match self {
            Self::Terminal(editor, history) => match editor.readline("perigrain> ") {
                Ok(text) => {
                    // A history that cannot be written is no reason to stop.
                    let _ = editor.add_history_entry(text.as_str());
                    let _ = history.as_ref().map(|path| editor.save_history(path));
                    Read::Text(text)
                }
                Err(ReadlineError::Interrupted) => Read::Again,
                Err(_) => Read::End,
            },
            Self::Pipe(input) => {
                let mut text = String::new();
                loop {
                    let mut bytes = vec![];
                    match input.lock().read_until(b'\n', &mut bytes) {
                        Ok(n) if n > 0 => text += &String::from_utf8_lossy(&bytes),
                        _ if text.is_empty() => return Read::End,
                        _ => return Read::Text(text),
                    }
                    if !is_unfinished(text.strip_suffix('\n').unwrap_or(&text)) {
                        return Read::Text(text);
                    }
                }
            }
        }
    }
}

/// `$XDG_STATE_HOME/perigrain/history`, its folder made; `None` without a home.
fn history_file() -> Option<PathBuf> {
    let set = |key| std::env::var_os(key).filter(|v| !v.is_empty()).map(PathBuf::from);
    let state = set("XDG_STATE_HOME").or_else(|| Some(set("HOME")?.join(".local/state")))?;
    let folder = state.join("perigrain");
    std::fs::create_dir_all(&folder).ok()?;
    Some(folder.join("history"))
}

/// Completion, hints and colours while a line is typed.
pub struct Assistant {
    known: Rc<RefCell<Known>>,
    folder: PathBuf,
    colours: bool,
}

impl Helper for Assistant {}

impl Completer for Assistant {
    type Candidate = String;

    fn complete(&self, line: &str, pos: usize, _: &Context<'_>) -> rustyline::Result<(usize, Vec<String>)> {
        Ok(complete(&line[..pos], &self.known.borrow(), &self.folder))
    }
}

impl Hint for hinting::Hint {
    fn display(&self) -> &str {
        &self.text
    }

    fn completion(&self) -> Option<&str> {
        self.to_take.then_some(&self.text)
    }
}

impl Hinter for Assistant {
    type Hint = hinting::Hint;

    fn hint(&self, line: &str, pos: usize, _: &Context<'_>) -> Option<hinting::Hint> {
        if pos < line.len() { None } else { hint(line, &self.known.borrow(), &self.folder) }
    }
}

impl Highlighter for Assistant {
    fn highlight<'l>(&self, line: &'l str, _: usize) -> Cow<'l, str> {
        if self.colours { Cow::Owned(paint(line)) } else { Cow::Borrowed(line) }
    }

    fn highlight_prompt<'b, 's: 'b, 'p: 'b>(&'s self, prompt: &'p str, _: bool) -> Cow<'b, str> {
        if self.colours { Cow::Owned(format!("\x1b[1m{prompt}\x1b[0m")) } else { Cow::Borrowed(prompt) }
    }

    fn highlight_hint<'h>(&self, hint: &'h str) -> Cow<'h, str> {
        if self.colours { Cow::Owned(format!("\x1b[2m{hint}\x1b[0m")) } else { Cow::Borrowed(hint) }
    }

    fn highlight_char(&self, _: &str, _: usize, _: CmdKind) -> bool {
        self.colours
    }
}

impl Validator for Assistant {
    fn validate(&self, ctx: &mut ValidationContext) -> rustyline::Result<ValidationResult> {
        Ok(match is_unfinished(ctx.input()) {
            true => ValidationResult::Incomplete,
            false => ValidationResult::Valid(None),
        })
    }
}
