//! `restart`: restart files written during a run.

pub mod writing;

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, ValueRef};
use perigrain_output::file::Pattern;
use perigrain_styles::BuildCx;
use std::path::PathBuf;

/// At which steps restart files are written.
#[derive(Clone, Debug)]
pub enum Rhythm {
    /// At multiples.
    Every(i64),
    /// At those that a variable names one after another.
    Named(ValueRef),
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
        let named = match args.peek() {
            Some(word) if word.text.starts_with("v_") => ValueRef::parse(&word.text, word.span)?,
            _ => None,
        };
        let every = match named {
            Some(r) => {
                args.next();
                cx.value(&r, false)?;
                Rhythm::Named(r)
            }
            None => Rhythm::Every(args.integer_from(0, "the interval of restart files")?),
        };
        if matches!(every, Rhythm::Every(0)) {
            args.finish()?;
            *self = Self::default();
            return Ok(());
        }
        let first = args.expect("the name of the restart files")?;
        let name = pattern(&first.text).map_err(|e| e.at(first.span))?;
        let span = args.span();
        match args.next() {
            None => *self = Self { each: Some((every, numbered(name)?)), span, ..self.clone() },
            Some(word) if matches!(word.text.as_str(), "fileper" | "nfile") => {
                return Err(one_process(word.span, &word.text));
            }
            Some(second) => {
                if let Some(word) = args.peek().filter(|w| matches!(w.text.as_str(), "fileper" | "nfile")) {
                    return Err(one_process(word.span, &word.text));
                }
                args.finish()?;
                pattern(&second.text).map_err(|e| e.at(second.span))?;
                if let Some(word) = [first, second].into_iter().find(|w| w.text.contains('*')) {
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
pub fn one_process(span: Span, word: &str) -> perigrain_base::diag::Diagnostics {
    let text = format!("`{word}` divides a restart file among processors: one process writes it here");
    Diagnostic::error(Code::NOT_SUPPORTED, span, text).help("leave it out").into()
}
