//! A deck of LIGGGHTS as a native deck: `perigrain translate`.
//!
//! Lines are read as they are written: variables, loops and comments stay, and `${r}` goes into native lines as it is.

use crate::{Outcome, Translator, lammps, mark};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, FileId};
use perigrain_lang::{Command, RawLine, Word, raw_lines, raw_words};

/// Whose words the new deck has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Target {
    /// perigrain's own.
    #[default]
    Perigrain,
    /// Those of LAMMPS, as far as it has any.
    Lammps,
}

/// A rewritten deck.
#[derive(Clone, Debug, Default)]
pub struct Rewritten {
    /// Its text.
    pub text: String,
    /// What is wrong with the old one, and notes.
    pub problems: Diagnostics,
    /// How many lines have no counterpart in the language that was chosen.
    pub lost: usize,
}

/// The native deck of a deck of LIGGGHTS; any other deck stays as it is.
pub fn rewrite(text: &str, file: FileId, target: Target) -> Rewritten {
    let mut out = Rewritten::default();
    let mut translator = None;
    let mut settled = false;
    let mut at = 0;
    let mut other = Other::default();
    for raw in raw_lines(text, file) {
        let (start, end) = (raw.span.start as usize, raw.span.end as usize);
        out.text += &text[at.min(start)..start];
        at = end;
        let whole = &text[start..end];
        let Some(cmd) = command(&raw, text) else {
            out.text += whole;
            continue;
        };
        if cmd.name.text == "compat" {
            let chosen = cmd.args.first().map_or("", |w| w.text.as_str());
            settled |= chosen != "liggghts";
            match chosen == "liggghts" {
                true => translator = Some(Translator::default()),
                false => translator = None,
            }
            out.text += if chosen == "liggghts" { "" } else { whole };
            continue;
        }
        if translator.is_none() && !settled && mark(&cmd).is_some() {
            translator = Some(Translator::default());
        }
        let Some(translator) = &mut translator else {
            out.text += whole;
            continue;
        };
        match lines(translator, &cmd) {
            Ok(Outcome::NotMine) if target == Target::Perigrain => out.text += whole,
            Ok(Outcome::NotMine) => other.same(&mut out, &cmd, whole),
            Ok(Outcome::Native(lines)) => put(&mut out, &lines, &cmd, whole, target, &mut other),
            Err(problems) => out.problems.append(problems.at(cmd.span)),
        }
        out.problems.append(translator.take_notes());
    }
    out.text += &text[at.min(text.len())..];
    other.settle(&mut out);
    out
}

/// What is known of a deck for LAMMPS while it grows.
#[derive(Default)]
struct Other {
    seen: lammps::Seen,
    /// Walls that wait for the laws below them, by their marks in the text.
    walls: Vec<Command>,
}

impl Other {
    /// The mark of a wall that waits.
    fn mark(k: usize) -> String {
        format!("\u{1}{k}\u{1}")
    }

    /// A native line.
    fn line(&mut self, out: &mut Rewritten, line: &Command) -> String {
        if lammps::waits(line) {
            self.walls.push(line.clone());
            return Self::mark(self.walls.len() - 1);
        }
        let found = self.seen.line(line);
        self.shown(out, line, found)
    }

    /// The text of a line, or why there is none.
    fn shown(&self, out: &mut Rewritten, line: &Command, found: Result<String, &str>) -> String {
        found.unwrap_or_else(|why| {
            out.lost += 1;
            format!("# NOT IN LAMMPS: {} ({why})", line.text)
        })
    }

    /// A line that is the same in both, or has no counterpart.
    fn same(&mut self, out: &mut Rewritten, cmd: &Command, whole: &str) {
        let text = self.line(out, cmd);
        if text == cmd.text {
            out.text += whole;
            return;
        }
        out.text += &text;
        if whole.ends_with('\n') {
            out.text.push('\n');
        }
    }

    /// Writes the walls in the places of their marks.
    fn settle(&self, out: &mut Rewritten) {
        for (k, wall) in self.walls.iter().enumerate() {
            let text = self.shown(out, wall, self.seen.wall(wall));
            out.text = out.text.replacen(&Self::mark(k), &text, 1);
        }
    }
}

/// The command of a line.
fn command(raw: &RawLine, text: &str) -> Option<Command> {
    let (name, args) = raw.words.split_first()?;
    let span = args.last().map_or(name.span, |last| name.span.to(last.span));
    let text = text.get(span.start as usize..span.end as usize)?;
    Some(Command { name: name.clone(), args: args.to_vec(), span, text: text.to_string() })
}

/// The native lines of a line, also of the commands of an `if`.
fn lines(translator: &mut Translator, cmd: &Command) -> Result<Outcome, Diagnostics> {
    if cmd.name.text != "if" {
        return translator.line(cmd);
    }
    let mut before = vec![];
    for quoted in cmd.args.iter().filter(|w| w.quoted) {
        let words: Vec<Word> = raw_words(quoted);
        let Some((name, args)) = words.split_first() else { continue };
        let inner =
            Command { name: name.clone(), args: args.to_vec(), span: quoted.span, text: quoted.text.clone() };
        match translator.clone().line(&inner)? {
            Outcome::NotMine => {}
            Outcome::Native(lines) if lines.last().is_some_and(|last| last.args == inner.args) => {
                before.extend(translator.before_run(&inner)?);
            }
            Outcome::Native(_) => {
                let text = "a line of LIGGGHTS behind `if` cannot be rewritten";
                return Err(Diagnostic::error(Code::NO_COUNTERPART, quoted.span, text)
                    .help("put it into a file, and `include` it there")
                    .into());
            }
        }
    }
    if before.is_empty() {
        return Ok(Outcome::NotMine);
    }
    before.push(cmd.clone());
    Ok(Outcome::Native(before))
}

/// Writes the native lines below the line that they come from.
fn put(
    out: &mut Rewritten,
    lines: &[Command],
    cmd: &Command,
    whole: &str,
    target: Target,
    other: &mut Other,
) {
    let stays = lines.last() == Some(cmd);
    let made = &lines[..lines.len() - usize::from(stays)];
    if !stays {
        let parts: Vec<&str> =
            whole.lines().map(|line| line.trim().trim_end_matches('&').trim_end()).collect();
        out.text += &format!("# LIGGGHTS: {}\n", parts.join(" "));
    } else if !made.is_empty() {
        out.text += "# LIGGGHTS: what lines above mean for a run\n";
    }
    for line in made {
        match target {
            Target::Perigrain => out.text += &format!("{}\n", line.text),
            Target::Lammps => {
                let text = other.line(out, line);
                out.text += &format!("{text}\n");
            }
        }
    }
    match (stays, target) {
        (false, _) => {}
        (true, Target::Perigrain) => out.text += whole,
        (true, Target::Lammps) => other.same(out, cmd, whole),
    }
}
