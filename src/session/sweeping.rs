//! The `sweep` line of a deck: which runs `perigrain sweep` makes of it, and what each of them reports.

use super::axes::{Axis, combined, zip};
use super::{Session, commands, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Word;
use perigrain_styles::words::{Each, Words};
use perigrain_world::reading::place;

/// A deck's `sweep` line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    /// The lists of values, the last one fastest.
    pub axes: Vec<Axis>,
    /// What each run reports at its end.
    pub report: Vec<String>,
}

/// The words of a `sweep` line.
#[derive(Words)]
#[word(least = 1, what = "each, zip, table or report")]
pub struct Sweep {
    #[word(flatten)]
    parts: Each<Listed>,
}

/// A part of the line.
#[derive(Words)]
#[word(keywords)]
enum Listed {
    /// A list of values for an index variable; several lists mean all combinations, the last one fastest. `a..b` and `a..b:step` are
    /// whole numbers, `a:b:n` are n numbers evenly from a to b; anything else is a text.
    Each {
        #[word(name = "NAME", what = "a variable's name")]
        name: Word,
        #[word(name = "VALUE", what = "a value", least = 1)]
        values: Vec<Word>,
    },
    /// Ties lists together that are equally long.
    Zip(#[word(name = "NAME", least = 2, kind = Kind::Variable)] Vec<Word>),
    /// A file with one run per line below a line with the variables' names, between commas or blanks.
    Table(#[word(name = "FILE", what = "a file name", kind = Kind::File)] Word),
    /// What each run reports at its end, in the words of formulas: `c_ID`, `f_ID[2]`, `v_NAME`, words of thermo output.
    Report(
        #[word(name = "WORD", what = "a word such as c_ID, v_name or pe", least = 1, kind = Kind::Column)]
        Vec<Word>,
    ),
}

impl Session {
    /// The deck's `sweep` line, if it has been reached.
    pub fn swept(&self) -> Option<&Swept> {
        self.swept.as_ref()
    }

    /// `sweep each NAME VALUE … zip NAME … table FILE report WORD …`: a run by itself takes the first values.
    ///
    /// # Errors
    /// Lists that make no sense, a second line that differs.
    pub(super) fn sweep(&mut self, line: Sweep, span: Span) -> Result<()> {
        let swept = self.axes_of(line, span)?;
        let rows = combined(&swept.axes).map_err(|e| e.at(span))?;
        if self.swept.as_ref().is_some_and(|before| *before != swept) {
            return refuse(Code::CONFLICT, span, "a deck has one `sweep` line");
        }
        let mut taken = vec![];
        for (name, value) in rows.first().into_iter().flatten() {
            if self.vars.kind(name).is_none() {
                self.vars.set_index(name, std::slice::from_ref(value)).map_err(|e| e.at(span))?;
                taken.push(format!("{name}={value}"));
            }
        }
        self.seen_names = self.vars.names_version();
        self.graph.variables = commands::variable_kinds(&self.vars);
        self.swept = Some(swept);
        if !taken.is_empty() && !self.looking() {
            let text = format!(
                "One of {} runs, {}: `perigrain sweep` makes all of them",
                rows.len(),
                taken.join(" ")
            );
            self.options.log.line(&text)?;
        }
        Ok(())
    }

    fn axes_of(&self, line: Sweep, span: Span) -> Result<Swept> {
        let mut swept = Swept::default();
        let mut zips = vec![];
        for part in line.parts.0 {
            match part.value {
                Listed::Each { name, values } => {
                    let (values, whole) = texts(&values, name.span);
                    swept.axes.push(Axis::each(&name.text, &values).map_err(|e| e.at(whole))?);
                }
                Listed::Zip(names) => zips.push(texts(&names, part.span)),
                Listed::Report(words) => swept.report.extend(texts(&words, part.span).0),
                Listed::Table(file) => swept.axes.push(self.table(&file)?),
            }
        }
        for (names, span) in zips {
            zip(&mut swept.axes, &names).map_err(|e| e.at(span))?;
        }
        if swept.axes.is_empty() {
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, span, "a sweep needs values to go through");
            return Err(d
                .help("as `sweep each v 10 20 30`, or a table of runs: `sweep table runs.csv`")
                .into());
        }
        Ok(swept)
    }

    fn table(&self, file: &Word) -> Result<Axis> {
        let path = place(&file.text, &self.options.folder);
        let text = match perigrain_base::gate::read_to_string(&path) {
            Ok(text) => text,
            Err(e) => {
                let text = format!("the table `{}` cannot be read: {e}", file.text);
                return refuse(Code::NO_FILE, file.span, text);
            }
        };
        self.world.read_files.note(&path);
        let text = self.world.read_files.plain(&file.text, text);
        let source = perigrain_base::diag::Source { name: file.text.clone(), text };
        let source = std::sync::Arc::new(source);
        Axis::table(&source.text, perigrain_base::diag::FileId::BROUGHT).map_err(|e| e.within(&source))
    }
}

/// The texts of words, and the place from another one to their last.
fn texts(words: &[Word], from: Span) -> (Vec<String>, Span) {
    let whole = words.last().map_or(from, |last| from.to(last.span));
    (words.iter().map(|word| word.text.clone()).collect(), whole)
}
