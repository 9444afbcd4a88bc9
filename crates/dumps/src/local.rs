//! Dump `local`: values of pairs, bonds and other local data as text.

use super::base::{Base, Common, Files, OfFile, OfParticles, Sort, column, foreign};
use super::columns::{ColumnFormat, OfColumn, OfColumns, Renamed, Table, Usual};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail};
use perigrain_lang::args::blame;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_output::dump::{Data, Field, Snapshot, sort_rows};
use perigrain_output::formats::{Formats, Kind};
use perigrain_plan::{Op, Stage};
use perigrain_styles::words::{self, Form, Or, Syntax, Words, read, read_or};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Style, Wants};

/// `dump … local`.
pub struct Local;

impl Style for Local {
    fn name(&self) -> &'static str {
        "local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Own::GRAMMAR)] },
            ),
            summary: "Writes local values (of pairs, bonds …) every N steps as text.",
            text: "One row per local value, in the order of the compute or fix that makes them; all columns must have the same \
                   number of rows. The group decides nothing: the compute does. The keywords of \
                   `dump_modify` that concern particles are refused.",
            example: "compute b all property/local batom1 batom2\ndump 1 all local 100 bonds.*.txt index c_b[1] c_b[2]",
        }
    }
}

/// A column.
#[derive(Clone, Debug)]
enum Column {
    Index,
    Value(ValueRef),
}

#[derive(Clone, Debug)]
struct Declared {
    base: Base,
    columns: Vec<Column>,
    names: Vec<String>,
    /// Column names set by `colname`.
    renamed: Vec<(usize, String)>,
    formats: Formats,
    header: bool,
    label: String,
    time: bool,
    units: bool,
}

impl DumpStyle for Local {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        local(Files::any(self.name()), args, cx)
    }
}

/// The line of a dump of local values.
#[derive(Words)]
pub(super) struct Line {
    #[word(flatten)]
    target: OfFile,
    /// `index`, which counts rows from 1, or a local value: `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`.
    #[word(name = "value", what = "a local value such as index or c_ID", kind = INDEX_OR_VALUE, least = 1)]
    values: Vec<Word>,
}

const INDEX_OR_VALUE: words::Kind = words::Kind::Or(
    &words::Kind::Choice(&[words::Alternative { word: "index", about: "", parts: &[] }]),
    &words::Kind::Value,
);

/// A dump of style `local` into these files.
pub(super) fn local(files: Files, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    let Line { target, values } = read(args, cx)?;
    let mut base = Base::new(files, &target.file, cx)?;
    base.sort = Sort::Off;
    let (mut columns, mut names) = (vec![], vec![]);
    for word in &values {
        if word.text == "index" {
            columns.push(Column::Index);
            names.push(word.text.clone());
            continue;
        }
        for word in cx.expand(word, Wants::Local)? {
            columns.push(Column::Value(reference(&word, cx)?));
            names.push(word.text.clone());
        }
    }
    if !columns.iter().any(|c| matches!(c, Column::Value(_))) {
        return fail(
            Code::MISSING_ARGUMENT,
            args.here(),
            "dump local needs a local value of a compute or fix: c_ID, c_ID[k], f_ID or f_ID[k]",
        );
    }
    Ok(Box::new(Declared {
        base,
        columns,
        names,
        renamed: vec![],
        formats: Formats::default(),
        header: true,
        label: "ENTRIES".into(),
        time: false,
        units: false,
    }))
}

fn reference(word: &Word, cx: &BuildCx) -> Result<ValueRef> {
    match ValueRef::parse(&word.text, word.span)?
        .filter(|r| matches!(r.kind, RefKind::Compute | RefKind::Fix))
    {
        Some(r) => cx.reading(&r, Wants::Local).map(|()| r),
        None => {
            let text = format!("`{}` is no local value", word.text);
            Err(blame(word, Code::UNKNOWN_NAME, text)
                .help("columns are index, c_ID, c_ID[k], f_ID and f_ID[k]")
                .into())
        }
    }
}

/// The keywords of `dump_modify` that this dump has beside those of all.
#[derive(Words)]
struct Own {
    #[word(flatten)]
    table: Table,
    /// What stands for `ENTRIES` in the header.
    #[word(keyword, name = "NAME", what = "the name of the rows")]
    label: Option<String>,
}

/// Refuses keywords that other dumps have.
fn foreign_here(word: &Word) -> Option<Diagnostics> {
    if !OfParticles::GRAMMAR.has(&word.text) {
        return foreign(word);
    }
    let text = format!("dump_modify {} concerns particles, and dump local writes none", word.text);
    Some(Diagnostic::error(Code::CONFLICT, word.span, text).into())
}

impl Dump for Declared {
    fn op(&self, cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        if let Sort::Column(k, _) = self.base.sort
            && k >= self.columns.len()
        {
            let text = format!("dump_modify sort: there is no column {}", k + 1);
            return fail(Code::BAD_VALUE, cx.span(), text);
        }
        let when = self.base.when(cx, every)?;
        let mut readings: Vec<Option<Reading>> = vec![];
        for c in &self.columns {
            readings.push(match c {
                Column::Index => None,
                Column::Value(r) => Some(cx.reading(r, Wants::Local, Stage::Output, &when)?),
            });
        }
        let dump = self.clone();
        self.base.seal(cx, every, &[], move |shot| {
            let w = shot.world;
            let lists: Vec<Option<Vec<f64>>> =
                readings.iter().map(|r| r.as_ref().map(|r| r.list(w))).collect();
            let counts: Vec<usize> = lists.iter().flatten().map(Vec::len).collect();
            let n = counts.first().copied().unwrap_or(0);
            if counts.iter().any(|c| *c != n) {
                let text = format!("the columns of this dump have different numbers of rows: {counts:?}");
                return Err(Diagnostic::error(Code::WRONG_KIND, None, text)
                    .help("make them with one compute, or with computes of the same pairs")
                    .into());
            }
            let fields: Vec<Field<'_>> = lists
                .iter()
                .enumerate()
                .map(|(k, list)| {
                    let data = match list {
                        None => Data::int(|i| i as i64 + 1),
                        Some(list) => Data::slice(list),
                    };
                    Field { name: dump.title(k), format: dump.formats.of(k, dump.kind(k)), data }
                })
                .collect();
            let mut rows: Vec<u32> = (0..n as u32).collect();
            if let Sort::Column(k, descending) = dump.base.sort {
                sort_rows(&mut rows, &fields[k].data, descending);
            }
            let domain = w.domain()?;
            let target = &mut shot.state.target;
            let snapshot = Snapshot {
                header: dump.header,
                item: &dump.label,
                step: shot.step,
                time: dump.time.then(|| w.clock.time()),
                units: (dump.units && target.is_fresh()).then(|| w.settings.units.name()),
                bounds: domain.bounds(),
                tilt: domain.tilt,
                boundary: &domain.boundary.letters(),
                rows: &rows,
                fields: &fields,
            };
            target.write(shot.step, |to| snapshot.write(to))
        })
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let (common, Own { table, label }): (Common, Own) = read_or(args, cx, foreign_here)?;
        if let Some(span) = common.by_id() {
            return fail(Code::CONFLICT, span, "local values have no id: sort by a column");
        }
        self.base.modify(common, cx)?;
        self.header = table.header.unwrap_or(self.header);
        self.units = table.units.unwrap_or(self.units);
        self.time = table.timed.time.unwrap_or(self.time);
        self.label = label.unwrap_or_else(|| std::mem::take(&mut self.label));
        for name in table.colname {
            match name {
                Or::Word(Usual::Default) => self.renamed.clear(),
                Or::Else(Renamed { column: word, name }) => {
                    self.renamed.push((column(&word, self.names.iter().map(String::as_str))?, name));
                }
            }
        }
        table.timed.formatted.format.into_iter().try_for_each(|format| self.format(format.value))
    }

    fn every(&self) -> Option<i64> {
        self.base.every()
    }

    fn growing(&self) -> bool {
        self.base.growing()
    }
}

impl Declared {
    fn kind(&self, column: usize) -> Kind {
        if matches!(self.columns[column], Column::Index) { Kind::Int } else { Kind::Float }
    }

    /// The heading of a column.
    fn title(&self, column: usize) -> &str {
        let new = self.renamed.iter().rev().find(|(k, _)| *k == column);
        new.map_or(&self.names[column], |(_, name)| name)
    }

    fn format(&mut self, format: ColumnFormat) -> Result<()> {
        let kinds: Vec<Kind> = (0..self.columns.len()).map(|k| self.kind(k)).collect();
        let (span, outcome) = match format {
            Or::Word(OfColumns::None) => {
                self.formats.clear();
                return Ok(());
            }
            Or::Word(OfColumns::Line(word)) => (word.span, self.formats.set_line(&word.text, &kinds)),
            Or::Word(OfColumns::Int(word)) => (word.span, self.formats.set_int(&word.text)),
            Or::Word(OfColumns::Float(word)) => (word.span, self.formats.set_float(&word.text)),
            Or::Else(OfColumn { column, format }) => match column.text.parse::<usize>() {
                Ok(k) if k >= 1 && k <= kinds.len() => {
                    (format.span, self.formats.set_column(k - 1, kinds[k - 1], &format.text))
                }
                _ => {
                    let text = format!("this dump has columns 1 to {}", kinds.len());
                    return fail(Code::BAD_VALUE, column.span, text);
                }
            },
        };
        outcome.map_err(|e| e.at(span))
    }
}
