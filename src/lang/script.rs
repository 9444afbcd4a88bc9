//! The cursor through a deck: it yields one logical line after the other, through includes, jumps and then-commands.

use super::command::{Line, Word};
use super::lex::{self, Logical};
use super::substitute::expand;
use super::text::Mapped;
use super::value::Env;
use super::vars::Vars;
use crate::diag::{FileId, Result, Sources, Span, fail};
use std::collections::{BTreeSet, VecDeque};

/// Where lines come from.
#[derive(Clone, Debug)]
pub(super) enum Frame {
    /// A text, from byte `at` on.
    File { file: FileId, at: usize },
    /// Commands given as words (`if … then "…"`).
    Commands { queue: VecDeque<Word>, speculative: bool },
}

/// A cursor that is pulled.
#[derive(Clone, Debug)]
pub struct Script {
    pub(super) frames: Vec<Frame>,
    /// The label that `jump` looks for.
    pub(super) seeking: Option<Word>,
    /// `next` has run out: the next `jump` is passed over.
    pub(super) skip_jump: bool,
    /// The command at hand stands in a branch that may not be taken (`check` mode).
    pub(super) speculative: bool,
    /// A jump or quit in such a branch was passed over, so that loops must end by themselves.
    pub(super) escaped: bool,
    /// Jumps that have been made.
    pub(super) made: BTreeSet<(FileId, u32)>,
    raw: String,
}

impl Script {
    /// A cursor at the start of a text.
    pub fn new(file: FileId) -> Self {
        Self::with(Frame::File { file, at: 0 })
    }

    /// A cursor through a text typed after the one this cursor has read: a `next` that has run out there
    /// still passes over the first `jump` here.
    pub fn then(&self, file: FileId) -> Self {
        Self { skip_jump: self.skip_jump, ..Self::new(file) }
    }

    /// A cursor through commands given as words, as in `run … every N "command"`.
    pub fn of_commands(words: &[Word]) -> Self {
        Self::with(Frame::Commands { queue: words.iter().cloned().collect(), speculative: false })
    }

    fn with(frame: Frame) -> Self {
        Self {
            frames: vec![frame],
            seeking: None,
            skip_jump: false,
            speculative: false,
            escaped: false,
            made: BTreeSet::new(),
            raw: String::new(),
        }
    }

    /// The line read last, as it is echoed; there also when it was refused.
    pub fn raw(&self) -> &str {
        &self.raw
    }

    /// What is left of the file that the line at hand stands in; `None` if it is a command of an `if`.
    pub fn unread(&self) -> Option<(FileId, usize)> {
        match self.frames.last() {
            Some(Frame::File { file, at }) => Some((*file, *at)),
            _ => None,
        }
    }

    /// Whether the command at hand may or may not be reached (`check` mode).
    pub fn is_speculative(&self) -> bool {
        self.speculative
    }

    /// The next logical line, blank ones and comments included; `None` at the end.
    ///
    /// After an error the cursor stands behind the line at fault and can go on.
    pub fn next(&mut self, sources: &mut Sources, vars: &Vars, env: &mut dyn Env) -> Result<Option<Line>> {
        loop {
            let Some(line) = self.pull(sources)? else { return Ok(None) };
            let code = line.text.head(line.code);
            if let Some(label) = &self.seeking {
                if is_label(&code, label, vars, env) {
                    self.seeking = None;
                }
                continue;
            }
            self.raw.clone_from(&line.text.text);
            let mut echoes = Vec::new();
            let full = expand(&code, vars, env, &mut echoes)?;
            let command = lex::command(&full)?;
            let expanded = !echoes.is_empty();
            return Ok(Some(Line { raw: line.text.text, echoes, command, expanded }));
        }
    }

    /// The next logical line of whatever is on top.
    fn pull(&mut self, sources: &Sources) -> Result<Option<Logical>> {
        loop {
            match self.frames.last_mut() {
                None => return Ok(None),
                Some(Frame::Commands { queue, speculative }) => {
                    self.speculative = *speculative;
                    if let Some(w) = queue.pop_front() {
                        self.raw.clone_from(&w.text);
                        return lex::standalone(Mapped::whole(&w.text, w.span, w.origin, w.unknown))
                            .map(Some);
                    }
                }
                Some(Frame::File { file, at }) => {
                    self.speculative = false;
                    let text = sources.get(*file).map_or("", |s| s.text.as_str());
                    let start = *at;
                    // behind the physical line, should the logical one be unreadable
                    let line = text.get(start..).unwrap_or("");
                    let end = line.find('\n').unwrap_or(line.len());
                    *at = (start + end + 1).min(text.len());
                    if !line.is_empty() {
                        self.raw = line[..end].to_owned();
                    }
                    if let Some(l) = lex::logical(text, *file, start)? {
                        *at = l.next;
                        return Ok(Some(l));
                    }
                }
            }
            let file = matches!(self.frames.pop(), Some(Frame::File { .. }));
            if let Some(label) = self.seeking.take_if(|_| file) {
                return no_label(&label);
            }
        }
    }

    /// The file that is being read.
    pub(super) fn file(&mut self) -> Option<(usize, FileId)> {
        self.frames.iter().enumerate().rev().find_map(|(k, f)| match f {
            Frame::File { file, .. } => Some((k, *file)),
            Frame::Commands { .. } => None,
        })
    }
}

/// Whether a line that is passed over is `label` with this name.
fn is_label(line: &Mapped, label: &Word, vars: &Vars, env: &mut dyn Env) -> bool {
    if !line.text.trim_start().starts_with("label") {
        return false;
    }
    let full = expand(line, vars, env, &mut vec![]);
    let Ok(Ok(Some(c))) = full.map(|l| lex::command(&l)) else { return false };
    c.name.text == "label" && c.args.first().is_some_and(|a| a.text == label.text)
}

fn no_label<T>(label: &Word) -> Result<T> {
    let span: Span = label.span;
    fail(crate::diag::Code::UNKNOWN_NAME, span, format!("there is no `label {}` to jump to", label.text))
}
