//! The `sweep` line of a deck: which runs `perigrain sweep` makes of it, and what each of them reports.

use super::axes::{Axis, combined, zip};
use super::{Session, commands, refuse};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::{Args, Word};
use perigrain_world::reading::place;

/// A deck's `sweep` line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    /// The lists of values, the last one fastest.
    pub axes: Vec<Axis>,
    /// What each run reports at its end.
    pub report: Vec<String>,
}

/// Words that begin a part of the line.
const KEYS: [&str; 4] = ["each", "zip", "table", "report"];

impl Session {
    /// The deck's `sweep` line, if it has been reached.
    pub fn swept(&self) -> Option<&Swept> {
        self.swept.as_ref()
    }

    /// `sweep each NAME VALUE … zip NAME … table FILE report WORD …`: a run by itself takes the first values.
    ///
    /// # Errors
    /// Lists that make no sense, a second line that differs.
    pub(super) fn sweep(&mut self, args: &mut Args, span: Span) -> Result<()> {
        let swept = self.read_sweep(args, span)?;
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

    fn read_sweep(&self, args: &mut Args, span: Span) -> Result<Swept> {
        let mut swept = Swept::default();
        let mut zips = vec![];
        args.clone().expect("each, zip, table or report")?;
        while let Some(key) = args.next() {
            match key.text.as_str() {
                "each" => {
                    let name = args.expect("a variable's name")?;
                    args.clone().expect("a value")?;
                    let (values, whole) = words(args);
                    swept.axes.push(Axis::each(&name.text, &values).map_err(|e| e.at(name.span.to(whole)))?);
                }
                "zip" => zips.push(words(args)),
                "report" => {
                    args.clone().expect("a word such as c_ID, v_name or pe")?;
                    swept.report.extend(words(args).0);
                }
                "table" => swept.axes.push(self.table(args.expect("a file name")?)?),
                _ => return Err(args.unknown(key, &KEYS)),
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

/// The words up to the next key, and where they stand.
fn words(args: &mut Args) -> (Vec<String>, Span) {
    let mut out = vec![];
    let mut span = args.here();
    while let Some(word) = args.peek().filter(|w| !KEYS.contains(&w.text.as_str())) {
        span = span.to(word.span);
        out.push(word.text.clone());
        args.next();
    }
    (out, span)
}
