//! Dump `local`: values of pairs, bonds and other local data as text.

use super::base::{Base, Sort, column, unknown};
use super::{Dump, DumpStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::args::blame;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_output::dump::{Data, Field, Snapshot, sort_rows};
use perigrain_output::formats::{Formats, Kind};
use perigrain_plan::{Op, Stage};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Style, Wants};

/// `dump … local`.
pub struct Local;

impl Style for Local {
    fn name(&self) -> &'static str {
        "local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "dump ID group local N file index|c_ID|c_ID[k]|f_ID|f_ID[k] …",
            summary: "Writes local values (of pairs, bonds …) every N steps as text.",
            text: "One row per local value, in the order of the compute or fix that makes them; all columns must have the same \
                   number of rows. `index` counts rows from 1. The group decides nothing: the compute does. `dump_modify` \
                   understands what all dumps do (see `dump custom`) but what concerns particles, and `colname N name`, `format`, `header \
                   yes|no`, `label NAME` (for `ENTRIES` in the header), `time yes` and `units yes`; `sort N` sorts by a \
                   column.",
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
        local(Base::new(self.name(), args, cx, &[])?, args, cx)
    }
}

/// A dump of style `local` into this file; parses its values.
pub(super) fn local(mut base: Base, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
    base.sort = Sort::Off;
    let (mut columns, mut names) = (vec![], vec![]);
    while let Some(word) = args.peek().filter(|w| w.text != "modify") {
        args.next();
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
        if columns.is_empty() {
            args.expect("a local value such as index or c_ID")?;
        }
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

/// Keywords of dumps that apply to particles only.
const OF_PARTICLES: &[&str] = &["element", "pbc", "refresh", "region", "thresh"];

const OWN: &[&str] = &["colname", "format", "header", "label", "time", "units"];

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
        while let Some(word) = args.next() {
            let text = word.text.as_str();
            if OF_PARTICLES.contains(&text) {
                let message = format!("dump_modify {text} concerns particles, and dump local writes none");
                return fail(Code::CONFLICT, word.span, message);
            }
            match text {
                "header" => self.header = args.flag("header")?,
                "label" => self.label = args.expect("the name of the rows")?.text.clone(),
                "time" => self.time = args.flag("time")?,
                "units" => self.units = args.flag("units")?,
                "format" => self.format(args)?,
                "colname" => self.rename(args)?,
                "sort" if args.peek_text() == "id" => {
                    return fail(Code::CONFLICT, args.here(), "local values have no id: sort by a column");
                }
                _ if self.base.modify(word, args, cx)? => {}
                _ => return Err(unknown(word, args, OWN)),
            }
        }
        Ok(())
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

    fn rename(&mut self, args: &mut Args) -> Result<()> {
        let which = args.expect("a column or default")?;
        if which.text == "default" {
            self.renamed.clear();
            return Ok(());
        }
        let column = column(which, self.names.iter().map(String::as_str))?;
        self.renamed.push((column, args.expect("the column's new name")?.text.clone()));
        Ok(())
    }

    fn format(&mut self, args: &mut Args) -> Result<()> {
        let which = args.expect("line, int, float, a column or none")?;
        if which.text == "none" {
            self.formats.clear();
            return Ok(());
        }
        let word = args.expect("a format such as %g")?;
        let kinds: Vec<Kind> = (0..self.columns.len()).map(|k| self.kind(k)).collect();
        let outcome = match which.text.as_str() {
            "line" => self.formats.set_line(&word.text, &kinds),
            "int" => self.formats.set_int(&word.text),
            "float" => self.formats.set_float(&word.text),
            text => match text.parse::<usize>() {
                Ok(k) if k >= 1 && k <= kinds.len() => {
                    self.formats.set_column(k - 1, kinds[k - 1], &word.text)
                }
                _ => {
                    let text = format!("this dump has columns 1 to {}", kinds.len());
                    return fail(Code::BAD_VALUE, which.span, text);
                }
            },
        };
        outcome.map_err(|e| e.at(word.span))
    }
}
