//! The cursor through a deck: it yields one logical line after the other, through includes, jumps and then-commands.

use super::command::{Command, Line, Word};
use super::lex::{self, Logical};
use super::progress::Progress;
use super::substitute::{expand, outside_quotes};
use super::text::Mapped;
use super::value::Env;
use super::vars::Vars;
use perigrain_base::diag::{FileId, Result, Sources, Span};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// Where lines come from.
#[derive(Clone, Debug)]
pub(super) enum Frame {
    /// A text, from byte `at` on.
    File { file: FileId, at: usize, speculative: bool, aside: bool },
    /// Commands given as words (`if … then "…"`).
    Commands { queue: VecDeque<Word>, speculative: bool, aside: bool },
}

/// The moment when a label was passed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Passed {
    /// How many lines had set variables.
    pub sets: u64,
    /// How many jumps and quits that a run may make had been passed over.
    pub escapes: u64,
}

/// A logical line, taken apart as far as it does not depend on variables.
#[derive(Debug)]
struct Prepared {
    raw: Arc<str>,
    body: Body,
    /// The first byte after it.
    next: usize,
}

/// What is left to do with a line.
#[derive(Debug)]
enum Body {
    /// Values have to be put in.
    Open(Mapped),
    /// Nothing: these are its words.
    Closed(Option<Arc<Command>>),
}

/// What a file has shown of itself so far.
#[derive(Clone, Debug, Default)]
struct Known {
    /// Lines by their first byte; kept once a jump has shown that lines come back.
    lines: BTreeMap<usize, Arc<Prepared>>,
    /// The byte behind the first `label` line of each name; none before the first jump to a label.
    labels: Option<Arc<BTreeMap<String, usize>>>,
}

/// A cursor that is pulled.
#[derive(Clone, Debug)]
pub struct Script {
    pub(super) frames: Vec<Frame>,
    /// `next` has run out: the next `jump` is passed over.
    pub(super) skip_jump: bool,
    /// Only a run determines whether that `next` has run out.
    pub(super) unsure: bool,
    /// Only a run determines whether the current command is reached.
    pub(super) speculative: bool,
    /// The command at hand stands in another branch than the first one that a run may take.
    pub(super) aside: bool,
    /// Of several branches that a run may take only the first one is carried out.
    pub(super) first_only: bool,
    /// How many jumps and quits that a run may make have been passed over.
    pub(super) escapes: u64,
    /// A jump has been passed over that a run may make.
    pub(super) cut_short: bool,
    /// Labels that have been passed, by the byte behind them.
    pub(super) passed: BTreeMap<(FileId, usize), Passed>,
    /// Labels further down that a run may have jumped to, each with the number of lines up to the jump that set variables.
    pub(super) awaited: BTreeMap<(FileId, usize), u64>,
    /// Whether loops get anywhere.
    pub(super) progress: Progress,
    /// The jumps of loops that were left before their end, with the number of turns that were followed.
    pub(super) left_loops: BTreeMap<Span, u64>,
    raw: Arc<str>,
    known: BTreeMap<FileId, Known>,
}

impl Script {
    /// A cursor at the start of a text.
    pub fn new(file: FileId) -> Self {
        let mut script = Self::with(Frame::File { file, at: 0, speculative: false, aside: false });
        script.passed.insert((file, 0), Passed::default());
        script
    }

    /// A cursor through a text typed after the one this cursor has read: a `next` that has run out there
    /// still passes over the first `jump` here.
    pub fn then(&self, file: FileId) -> Self {
        Self { skip_jump: self.skip_jump, unsure: self.unsure, ..Self::new(file) }
    }

    /// A cursor through commands given as words, as in `run … every N "command"`.
    pub fn of_commands(words: &[Word]) -> Self {
        let queue = words.iter().cloned().collect();
        Self::with(Frame::Commands { queue, speculative: false, aside: false })
    }

    /// The same cursor, which takes only the first of several branches of an `if` whose condition only a run determines. Of the
    /// others it yields the commands with [`Script::is_aside`] set.
    pub fn first_branches(self) -> Self {
        Self { first_only: true, ..self }
    }

    fn with(frame: Frame) -> Self {
        Self {
            frames: vec![frame],
            skip_jump: false,
            unsure: false,
            speculative: false,
            aside: false,
            first_only: false,
            escapes: 0,
            cut_short: false,
            passed: BTreeMap::new(),
            awaited: BTreeMap::new(),
            progress: Progress::default(),
            left_loops: BTreeMap::new(),
            raw: "".into(),
            known: BTreeMap::new(),
        }
    }

    /// The line read last, as it is echoed; there also when it was refused.
    pub fn raw(&self) -> &str {
        &self.raw
    }

    /// What is left of the file that the line at hand stands in; `None` if it is a command of an `if`.
    pub fn unread(&self) -> Option<(FileId, usize)> {
        match self.frames.last() {
            Some(Frame::File { file, at, .. }) => Some((*file, *at)),
            _ => None,
        }
    }

    /// Whether only a run determines if the current command is reached.
    pub fn is_speculative(&self) -> bool {
        self.speculative
    }

    /// Whether a jump has been passed over that a run may make, so that lines may come more often than they did here.
    pub fn is_cut_short(&self) -> bool {
        self.cut_short
    }

    /// The jumps of loops that were left before their end where a deck is only looked at, with the number of turns followed.
    pub fn left_loops(&self) -> impl Iterator<Item = (Span, u64)> {
        self.left_loops.iter().map(|(span, turns)| (*span, *turns))
    }

    /// Whether the command at hand stands in a branch that is left aside: see [`Script::first_branches`].
    pub fn is_aside(&self) -> bool {
        self.aside
    }

    /// Notes that a command has changed something outside the variables.
    pub fn changed(&mut self) {
        self.progress.outside();
    }

    /// The next logical line, blank ones and comments included; `None` at the end.
    ///
    /// After an error the cursor stands behind the wrong line and can continue.
    pub fn next(&mut self, sources: &mut Sources, vars: &Vars, env: &mut dyn Env) -> Result<Option<Line>> {
        let Some(line) = self.pull(sources)? else { return Ok(None) };
        self.raw = line.raw.clone();
        let (command, echoes) = match &line.body {
            Body::Closed(command) => (command.clone(), vec![]),
            Body::Open(code) => {
                let mut echoes = Vec::new();
                let full = expand(code, vars, env, Some(&mut echoes))?;
                (lex::command(&full)?.map(Arc::new), echoes)
            }
        };
        let expanded = !echoes.is_empty();
        Ok(Some(Line { raw: line.raw.clone(), echoes, command, expanded }))
    }

    /// The next logical line of whatever is on top.
    fn pull(&mut self, sources: &Sources) -> Result<Option<Arc<Prepared>>> {
        loop {
            match self.frames.last_mut() {
                None => return Ok(None),
                Some(Frame::Commands { queue, speculative, aside }) => {
                    (self.speculative, self.aside) = (*speculative, *aside);
                    if let Some(w) = queue.pop_front() {
                        self.raw = w.text.as_str().into();
                        let line = lex::standalone(Mapped::whole(&w.text, w.span, w.origin, w.unknown))?;
                        return prepared(line).map(|l| Some(Arc::new(l)));
                    }
                }
                Some(Frame::File { file, at, speculative, aside }) => {
                    (self.speculative, self.aside) = (*speculative, *aside);
                    let (file, start) = (*file, *at);
                    if let Some(line) = self.known.get(&file).and_then(|k| k.lines.get(&start)) {
                        *at = line.next;
                        return Ok(Some(line.clone()));
                    }
                    if let Some(line) = self.read(sources, file, start)? {
                        return Ok(Some(line));
                    }
                }
            }
            self.frames.pop();
        }
    }

    /// Reads the line of the topmost file that starts at byte `start`.
    fn read(&mut self, sources: &Sources, file: FileId, start: usize) -> Result<Option<Arc<Prepared>>> {
        let text = sources.get(file).map_or("", |s| s.text.as_str());
        // behind the physical line, should the logical one be unreadable
        let line = text.get(start..).unwrap_or("");
        let end = line.find('\n').unwrap_or(line.len());
        self.move_to((start + end + 1).min(text.len()));
        if !line.is_empty() {
            self.raw = line[..end].into();
        }
        let Some(line) = lex::logical(text, file, start)? else { return Ok(None) };
        self.move_to(line.next);
        let line = Arc::new(prepared(line)?);
        if let Some(known) = self.known.get_mut(&file) {
            known.lines.insert(start, line.clone());
        }
        Ok(Some(line))
    }

    fn move_to(&mut self, byte: usize) {
        if let Some(Frame::File { at, .. }) = self.frames.last_mut() {
            *at = byte;
        }
    }

    /// Notes that lines of a file come back.
    pub(super) fn comes_back(&mut self, file: FileId) {
        self.known.entry(file).or_default();
    }

    /// The byte behind the first `label` line with this name; `None` if there is none.
    ///
    /// # Errors
    /// A line before it that cannot be read.
    pub(super) fn behind_label(
        &mut self,
        name: &str,
        file: FileId,
        sources: &Sources,
    ) -> Result<Option<usize>> {
        let known = self.known.entry(file).or_default();
        if let Some(labels) = &known.labels {
            return Ok(labels.get(name).copied());
        }
        let text = sources.get(file).map_or("", |s| s.text.as_str());
        let mut labels = BTreeMap::new();
        let mut at = 0;
        loop {
            let line = match lex::logical(text, file, at) {
                Ok(Some(line)) => line,
                Ok(None) => break,
                // a line that cannot be read hides what stands behind it
                Err(e) => return labels.get(name).map_or(Err(e), |at| Ok(Some(*at))),
            };
            at = line.next;
            if let Some(label) = label_of(&line) {
                labels.entry(label).or_insert(at);
            }
        }
        let found = labels.get(name).copied();
        known.labels = Some(Arc::new(labels));
        Ok(found)
    }

    /// The file that is being read.
    pub(super) fn file(&self) -> Option<(usize, FileId)> {
        self.frames.iter().enumerate().rev().find_map(|(k, f)| match f {
            Frame::File { file, .. } => Some((k, *file)),
            Frame::Commands { .. } => None,
        })
    }
}

/// Takes a line apart, into words if no value has to be put in.
fn prepared(line: Logical) -> Result<Prepared> {
    let code = line.text.head(line.code);
    // what stands in quotes gets its values from the command that reads it
    let open = !matches!(outside_quotes(&code.text), Ok(None));
    let body = if open { Body::Open(code) } else { Body::Closed(lex::command(&code)?.map(Arc::new)) };
    Ok(Prepared { raw: line.text.text.into(), body, next: line.next })
}

/// The name that a `label` line gives; as in LAMMPS no values are put in.
fn label_of(line: &Logical) -> Option<String> {
    let code = line.text.text.get(..line.code)?;
    let mut words = code.split_whitespace();
    if words.next() != Some("label") {
        return None;
    }
    let name = words.next()?;
    Some(name.trim_matches(|c| c == '"' || c == '\'').to_owned())
}
