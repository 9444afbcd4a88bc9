//! Commands that move the cursor: if, jump, label, next, include, quit; and `variable`, which steers them.

use super::args::{Args, blame};
use super::command::{Command, Word};
use super::condition;
use super::script::{Frame, Passed, Script};
use super::substitute::expand;
use super::text::Mapped;
use super::value::Env;
use super::vars::{Next, Vars};
use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Sources, fail, unseen};

/// How deep includes and then-commands may nest.
const NESTING: usize = 100;

/// How many turns of a loop are followed where a deck is only looked at.
const CHECKED_TURNS: u64 = 10_000;

/// Reads files for `include` and `jump`.
pub trait Files {
    /// The whole text of a file.
    fn read(&self, path: &str) -> std::io::Result<String>;
    /// The whole text of a file of data, in which characters that look like blanks are blanks.
    fn read_data(&self, path: &str) -> std::io::Result<String> {
        self.read(path)
    }
    /// Whether an earlier line of the deck may have written this file (where a deck is only looked at, nothing is written).
    fn comes_later(&self, _path: &str) -> bool {
        false
    }
    /// Whether the deck is only looked at, so that long loops need not be followed to their end.
    fn only_looks(&self) -> bool {
        false
    }
    /// Whether so much has been looked at that no loop is followed any more.
    fn has_looked_long(&self) -> bool {
        false
    }
}

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// It is none of the flow commands.
    NotMine,
    /// It is done.
    Done,
    /// The deck ends the program with this exit status.
    Quit(i32),
}

/// One branch of an `if`: its condition (none for `else`) and its commands.
type Branch<'a> = (Option<&'a Word>, &'a [Word]);

impl Script {
    /// The commands that [`Script::flow`] carries out.
    pub const FLOW: &'static [&'static str] = &["if", "jump", "label", "next", "include", "quit", "variable"];

    /// Carries out a command that moves the cursor or sets a variable.
    pub fn flow(
        &mut self,
        command: &Command,
        sources: &mut Sources,
        vars: &mut Vars,
        env: &mut dyn Env,
        files: &dyn Files,
    ) -> Result<Flow> {
        match command.name.text.as_str() {
            "if" => self.branch(command, vars, env)?,
            "jump" => self.jump(command, sources, vars, files)?,
            "include" => self.include(command, sources, vars, files)?,
            "label" => {
                let mut args = Args::new(command);
                args.expect("the label's name")?;
                args.finish()?;
                self.pass_label(vars);
            }
            "next" => {
                Args::new(command).expect("a variable's name")?;
                match vars.next(&command.args, self.speculative, self.escapes > 0)? {
                    Next::More => {}
                    Next::Over => self.skip_jump = true,
                    Next::Unknown => (self.skip_jump, self.unsure) = (true, true),
                }
            }
            "quit" => return self.quit(command),
            "variable" => self.variable(command, vars, env, files)?,
            _ => return Ok(Flow::NotMine),
        }
        Ok(Flow::Done)
    }

    fn variable(
        &mut self,
        command: &Command,
        vars: &mut Vars,
        env: &mut dyn Env,
        files: &dyn Files,
    ) -> Result<()> {
        let Some(name) = command.args.first().filter(|_| self.speculative) else {
            return vars.define(command, env, files);
        };
        // A variable that may be gone still has a value that a later line may read.
        if command.args.get(1).is_none_or(|style| style.text != "delete") {
            vars.define(command, env, files)?;
        }
        vars.set_adrift(&name.text);
        Ok(())
    }

    fn branch(&mut self, command: &Command, vars: &Vars, env: &mut dyn Env) -> Result<()> {
        let mut possible: Vec<&[Word]> = Vec::new();
        let mut unsure = false;
        for (condition, commands) in branches(command)? {
            let holds = condition.map_or(Ok(Some(true)), |c| evaluate(c, vars, env))?;
            if holds == Some(false) {
                continue;
            }
            possible.push(commands);
            unsure |= holds.is_none();
            if holds == Some(true) {
                break;
            }
        }
        let speculative = unsure || self.speculative;
        self.room(command)?;
        // The last one pushed is the first one read.
        for (k, commands) in possible.into_iter().enumerate().rev() {
            let aside = self.aside || (k > 0 && self.first_only);
            let queue = commands.iter().cloned().collect();
            self.frames.push(Frame::Commands { queue, speculative, aside });
        }
        Ok(())
    }

    fn jump(
        &mut self,
        command: &Command,
        sources: &mut Sources,
        vars: &mut Vars,
        files: &dyn Files,
    ) -> Result<()> {
        let mut args = Args::new(command);
        let target = args.expect("a file, or SELF")?;
        let label = args.next();
        args.finish()?;
        let skip = std::mem::take(&mut self.skip_jump);
        // Whether only a run determines if the jump is passed over.
        let maybe = std::mem::take(&mut self.unsure) || self.speculative;
        if skip && !maybe {
            return Ok(());
        }
        let Some((level, current)) = self.file() else {
            return fail(Code::WRONG_ORDER, command.span, "there is no file to jump in");
        };
        self.escapes += u64::from(maybe && !skip);
        let file = match target.text.as_str() {
            "SELF" => Some(current),
            _ if maybe => return Ok(()),
            _ => load(target, sources, files)?,
        };
        let Some(file) = file.filter(|_| label.is_none_or(|l| !l.unknown)) else {
            self.escapes += 1;
            vars.set_adrift_since(0);
            return Ok(());
        };
        let at = match label {
            None => 0,
            Some(l) => match self.behind_label(&l.text, file, sources)? {
                Some(at) => at,
                None => return no_label(l),
            },
        };
        // A loop with a way out that a run may take ends after this turn, unless a `next` brings it to its end.
        let left = |p: &Passed| self.escapes > p.escapes && !vars.moved_since(p.sets);
        if maybe || self.passed.get(&(file, at)).is_some_and(left) {
            self.pass_over((file, at), vars);
            return Ok(());
        }
        let place = (command.span.file, command.span.start);
        self.comes_back(file);
        let Some(turns) = self.progress.turn(place, vars.fingerprint() ^ self.position()) else {
            return stuck(command, target);
        };
        if files.only_looks() && (turns > CHECKED_TURNS || files.has_looked_long()) {
            self.left_loops.insert(command.span, turns);
            self.pass_over((file, at), vars);
            return Ok(());
        }
        self.passed.insert((file, at), Passed { sets: vars.sets(), escapes: self.escapes });
        if let Frame::File { file: now, at: byte, .. } = &mut self.frames[level] {
            (*now, *byte) = (file, at);
        }
        if label.is_some() {
            self.frames.truncate(level + 1);
        }
        Ok(())
    }

    /// Passes over a jump that a run may make: what the lines between here and its label set is unknown behind them.
    fn pass_over(&mut self, label: (FileId, usize), vars: &mut Vars) {
        self.cut_short = true;
        match self.passed.get(&label) {
            Some(p) => vars.set_adrift_since(p.sets),
            None => drop(self.awaited.entry(label).or_insert_with(|| vars.sets())),
        }
    }

    /// Passes a `label` line: where a jump to it may have left lines out, what they set is unknown.
    fn pass_label(&mut self, vars: &mut Vars) {
        let Some(Frame::File { file, at, .. }) = self.frames.last() else { return };
        let place = (*file, *at);
        if let Some(since) = self.awaited.remove(&place) {
            vars.set_adrift_since(since);
        }
        self.passed.insert(place, Passed { sets: vars.sets(), escapes: self.escapes });
    }

    /// A number for what waits to be read below and above the jump at hand.
    fn position(&self) -> u64 {
        self.frames.iter().fold(0, |h: u64, f| {
            let part = match f {
                Frame::File { file, at, .. } => (u64::from(file.0) << 32) ^ *at as u64,
                Frame::Commands { queue, .. } => !(queue.len() as u64),
            };
            h.rotate_left(13).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ part
        })
    }

    fn include(
        &mut self,
        command: &Command,
        sources: &mut Sources,
        vars: &Vars,
        files: &dyn Files,
    ) -> Result<()> {
        let mut args = Args::new(command);
        let target = args.expect("a file")?;
        args.finish()?;
        self.room(command)?;
        if let Some(file) = load(target, sources, files)? {
            let (speculative, aside) = (self.speculative, self.aside);
            self.passed.insert((file, 0), Passed { sets: vars.sets(), escapes: self.escapes });
            self.frames.push(Frame::File { file, at: 0, speculative, aside });
        }
        Ok(())
    }

    fn quit(&mut self, command: &Command) -> Result<Flow> {
        let mut args = Args::new(command);
        let span = args.here();
        let status = if args.is_empty() { 0 } else { args.integer("the exit status")? };
        let Ok(status) = i32::try_from(status) else {
            return fail(Code::BAD_VALUE, span, "this is no exit status");
        };
        args.finish()?;
        if self.speculative {
            self.escapes += 1;
            return Ok(Flow::Done);
        }
        Ok(Flow::Quit(status))
    }

    /// Drops finished frames and refuses one level too many.
    fn room(&mut self, command: &Command) -> Result<()> {
        while matches!(self.frames.last(), Some(Frame::Commands { queue, .. }) if queue.is_empty()) {
            self.frames.pop();
        }
        if self.frames.len() < NESTING {
            return Ok(());
        }
        fail(Code::CONFLICT, command.span, format!("files and then-commands nest deeper than {NESTING}"))
    }
}

/// The branches of an `if`.
fn branches(command: &Command) -> Result<Vec<Branch<'_>>> {
    let mut args = Args::new(command);
    let mut out = Vec::new();
    let condition = args.expect("a condition")?;
    let then = args.expect("the word then")?;
    if then.text != "then" {
        return Err(
            blame(then, Code::UNKNOWN_KEYWORD, format!("`{}` found, expected then", then.text)).into()
        );
    }
    args.clone().expect("a command to carry out")?;
    out.push((Some(condition), until_next(&mut args)));
    while let Some(word) = args.next() {
        if word.text == "elif" {
            let condition = args.expect("a condition")?;
            out.push((Some(condition), until_next(&mut args)));
            continue;
        }
        out.push((None, until_next(&mut args)));
        if let Some(w) = args.next() {
            let message = format!("`{}` after else can never be reached", w.text);
            return Err(blame(w, Code::EXTRA_ARGUMENT, message).into());
        }
    }
    Ok(out)
}

/// The words up to the next `elif` or `else`.
fn until_next<'a>(args: &mut Args<'a>) -> &'a [Word] {
    let all = args.clone().rest();
    let n = all.iter().position(|w| w.text == "elif" || w.text == "else").unwrap_or(all.len());
    for _ in 0..n {
        args.next();
    }
    &all[..n]
}

/// Whether a condition holds; `None` if only a run determines it.
fn evaluate(word: &Word, vars: &Vars, env: &mut dyn Env) -> Result<Option<bool>> {
    let text = Mapped::whole(&word.text, word.span, word.origin, word.unknown);
    let full = expand(&text, vars, env, None)?;
    condition::holds(&full)
}

/// A label that is nowhere.
fn no_label<T>(label: &Word) -> Result<T> {
    let message = format!("there is no `label {}` to jump to", label.text);
    Err(blame(label, Code::UNKNOWN_LABEL, message).into())
}

/// A loop in which nothing changes.
fn stuck<T>(command: &Command, target: &Word) -> Result<T> {
    let message =
        format!("this loop never ends: nothing has changed since an earlier `jump {}` here", target.text);
    let d = Diagnostic::error(Code::CONFLICT, command.span, message);
    Err(d.help("move a variable by `next`, or leave by `if … then \"jump SELF LABEL\"` on something that changes").into())
}

/// Why a file could not be read.
pub(super) fn unreadable(path: &Word, e: &std::io::Error) -> Diagnostic {
    let reason = match e.kind() {
        std::io::ErrorKind::NotFound => "does not exist".to_owned(),
        _ => format!("cannot be read: {e}"),
    };
    blame(path, perigrain_base::gate::code(e), format!("the file `{}` {reason}", path.text))
}

/// Reads a file into the sources, once per content; `None` if only a run determines its name.
fn load(path: &Word, sources: &mut Sources, files: &dyn Files) -> Result<Option<FileId>> {
    let text = match files.read(&path.text) {
        Ok(text) => text,
        Err(_) if path.unknown => return Ok(None),
        Err(_) if files.comes_later(&path.text) => return Err(unseen(path.span, &path.text)),
        Err(e) => return Err(unreadable(path, &e).into()),
    };
    let mut k = 0;
    while let Some(s) = sources.get(FileId(k)) {
        if s.name == path.text && s.text == text {
            return Ok(Some(FileId(k)));
        }
        k += 1;
    }
    Ok(Some(sources.add(path.text.clone(), text)))
}
