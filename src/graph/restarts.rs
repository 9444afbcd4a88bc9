//! `restart`: restart files written during a run.

pub mod writing;

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_output::file::Pattern;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Kind, Or, Reference, Steps, Value, Words, read_or};
use std::path::PathBuf;

/// At which steps restart files are written.
#[derive(Clone, Debug)]
pub enum Rhythm {
    /// At multiples.
    Every(i64),
    /// At those that a variable names one after another.
    Named(ValueRef),
}

/// The words of a `restart` line.
#[derive(Words)]
pub struct RestartLine {
    /// At which steps: multiples of `N`, or those that the variable names one after another, by `logfreq()`, `stride()` and the like;
    /// 0 ends all files.
    #[word(name = "N", what = "the interval of restart files")]
    every: Or<Reference, Steps>,
    /// A file for each step, with the step in place of `*` or behind `.` at the end; of two names, the first file.
    #[word(name = "FILE")]
    first: Option<RestartFile>,
    /// The second of two files that are written in turn.
    #[word(name = "FILE2")]
    second: Option<RestartFile>,
}

/// The name of a file.
struct RestartFile(Word);

impl Value for RestartFile {
    const KIND: Kind = Kind::File;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.expect(what).cloned().map(Self)
    }
    fn begins(word: &Word) -> bool {
        divided(word).is_none()
    }
}

/// Which restart files are wanted; both kinds may be.
#[derive(Clone, Debug, Default)]
pub struct Restarts {
    /// A file of its own for each step that is a multiple.
    pub each: Option<(Rhythm, Pattern)>,
    /// Two files in turn.
    pub turn: Option<(Rhythm, [PathBuf; 2])>,
    /// The line.
    pub span: Span,
}

impl Restarts {
    /// Reads `restart 0`, `restart N root` or `restart N file1 file2`; N may be a variable.
    ///
    /// # Errors
    /// Every mistake in the line.
    pub fn declare(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let RestartLine { every, first, second } = read_or(args, cx, divided)?;
        let every = match every {
            Or::Word(Reference(r)) => Rhythm::Named(r),
            Or::Else(Steps(0)) => return self.end(first.iter().chain(&second)),
            Or::Else(Steps(n)) => Rhythm::Every(n),
        };
        let Some(RestartFile(first)) = first else {
            return args.expect("the name of the restart files").map(drop);
        };
        let name = pattern(&first.text).map_err(|e| e.at(first.span))?;
        let span = args.span();
        match second {
            None => *self = Self { each: Some((every, numbered(name)?)), span, ..self.clone() },
            Some(RestartFile(second)) => {
                pattern(&second.text).map_err(|e| e.at(second.span))?;
                if let Some(word) = [&first, &second].into_iter().find(|w| w.text.contains('*')) {
                    let text = "two files are written in turn: their names have no `*`";
                    return fail(Code::BAD_VALUE, word.span, text);
                }
                if first.text == second.text {
                    return fail(Code::BAD_VALUE, second.span, "the two files must have different names");
                }
                let files = [PathBuf::from(&first.text), PathBuf::from(&second.text)];
                *self = Self { turn: Some((every, files)), span, ..self.clone() };
            }
        }
        Ok(())
    }

    /// No further files: `restart 0` with nothing behind it.
    fn end<'a>(&mut self, mut files: impl Iterator<Item = &'a RestartFile>) -> Result<()> {
        if let Some(RestartFile(word)) = files.next() {
            let text = format!("`restart` does not expect `{}` here", word.text);
            return fail(Code::EXTRA_ARGUMENT, word.span, text);
        }
        *self = Self::default();
        Ok(())
    }

    /// The names of all files that may be written, with `*` for the step.
    pub fn names(&self) -> Vec<String> {
        let each = self.each.iter().map(|(_, p)| p.text().to_string());
        let turn = self.turn.iter().flat_map(|(_, files)| files.iter().map(|f| f.display().to_string()));
        each.chain(turn).collect()
    }
}

/// A name of restart files: any ending, no `%`.
///
/// # Errors
/// What is no such name.
pub fn pattern(text: &str) -> Result<Pattern> {
    Pattern::of_any_kind(text)
}

/// Without a `*`, the step is appended (LAMMPS).
fn numbered(name: Pattern) -> Result<Pattern> {
    if name.many() { Ok(name) } else { pattern(&format!("{}.*", name.text())) }
}

/// The refusal of a keyword about files of several processes.
pub fn divided(word: &Word) -> Option<Diagnostics> {
    if !["fileper", "nfile"].contains(&word.text.as_str()) {
        return None;
    }
    let text = format!("`{}` divides a restart file among processors: one process writes it here", word.text);
    Some(Diagnostic::error(Code::NOT_SUPPORTED, word.span, text).help("leave it out").into())
}
