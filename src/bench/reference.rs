//! What a measure is compared with: the finest run, a closed form, a file.

use super::norm::{Kind, paired};
use super::{Bench, Error, Measure, Run, fault};
use crate::session::axes::Axis;
use crate::sweep::Outcome;
use crate::sweep::lammps;
use crate::sweep::series::Series;
use perigrain_base::diag::{Code, Diagnostics, FileId};
use std::path::{Path, PathBuf};

/// What is taken for right.
#[derive(Clone, Debug, PartialEq)]
pub enum Against {
    /// The run with the last value of these knobs, of all if none is named; switches of the program have their first value.
    Finest(Vec<String>),
    /// A number, a formula or a word of the deck, in the run itself.
    Form(String),
    /// A table of times and values, or a log with step tables.
    File(PathBuf),
}

impl Against {
    /// In a few words.
    pub fn describe(&self) -> String {
        match self {
            Self::Finest(knobs) if knobs.is_empty() => "the finest run".into(),
            Self::Finest(knobs) => format!("the run with the finest {}", knobs.join(" and ")),
            Self::Form(form) => format!("`{form}`"),
            Self::File(path) => format!("`{}`", path.display()),
        }
    }
}

/// The errors of all settings in a measure. Where there is none, `problems` has the reason.
pub(super) fn errors(bench: &Bench, m: &Measure, runs: &[Run], problems: &mut Diagnostics) -> Vec<Error> {
    let file = match &m.against {
        Against::File(path) => match read(path, &m.word) {
            Ok(series) => Some(series),
            Err(text) => {
                problems.append(fault(Code::BAD_FILE, text));
                Some(Series::default())
            }
        },
        _ => None,
    };
    let empty = file.as_ref().is_some_and(|s| s.times.is_empty());
    let mut reasons: Vec<String> = vec![];
    let mut out = vec![];
    for (point, run) in runs.iter().enumerate() {
        let mut error = Error { value: end(bench, run, &m.word), ..Error::default() };
        let reference = finest(bench, m, point);
        error.is_reference = reference == Some(point);
        error.is_twin = reference.is_some_and(|reference| {
            let both = bench.places(reference).into_iter().zip(bench.places(point)).zip(&bench.axes);
            reference != point && both.into_iter().all(|((a, b), axis)| a == b || axis.is_switch())
        });
        if run.outcome.is_some() && !empty && !error.is_reference {
            match compared(bench, m, run, reference.map(|k| &runs[k]), file.as_ref()) {
                Ok(found) => error.error = Some(found),
                Err(why) => reasons.extend((!reasons.contains(&why)).then_some(why)),
            }
        }
        out.push(error);
    }
    for why in reasons {
        problems.append(fault(Code::WRONG_KIND, format!("`{}` has no error: {why}", m.name)));
    }
    out
}

/// The setting that a setting is compared with, if it is one of them.
pub(super) fn finest(bench: &Bench, m: &Measure, point: usize) -> Option<usize> {
    let Against::Finest(knobs) = &m.against else { return None };
    let places = bench.places(point).into_iter().zip(&bench.axes).map(|(place, axis)| match axis {
        axis if axis.is_switch() => 0,
        axis if knobs.is_empty() || axis.names.iter().any(|n| knobs.contains(n)) => axis.rows.len() - 1,
        _ => place,
    });
    Some(bench.at(&places.collect::<Vec<_>>()))
}

fn end(bench: &Bench, run: &Run, word: &str) -> Option<f64> {
    run.outcome.as_ref().and_then(|o: &Outcome| o.value(word)).or_else(|| {
        // A number stands for itself in runs that cannot work formulas out.
        word.parse().ok().or_else(|| series(bench, run, word)?.values.last().copied())
    })
}

fn series<'a>(bench: &Bench, run: &'a Run, word: &str) -> Option<&'a Series> {
    let k = bench.sweep.report.iter().position(|w| w == word)?;
    run.series.get(k).filter(|s| !s.times.is_empty())
}

/// The error of one run; else why there is none.
fn compared(
    bench: &Bench,
    m: &Measure,
    run: &Run,
    other: Option<&Run>,
    file: Option<&Series>,
) -> Result<f64, String> {
    let (from, word) = match &m.against {
        Against::Form(form) => (run, form),
        _ => (other.unwrap_or(run), &m.word),
    };
    if from.outcome.is_none() {
        return Err("its reference run has failed".into());
    }
    if m.norm.kind == Kind::End {
        let expected = match file {
            Some(series) => series.values.last().copied(),
            None => end(bench, from, word),
        };
        if let Some(file) = file.filter(|s| s.times.len() > 1)
            && let Some(ours) = series(bench, run, &m.word)
        {
            paired(ours, file)?;
        }
        let value = end(bench, run, &m.word).ok_or_else(|| no_number(&m.word))?;
        return Ok(m.norm.of(&[(value, expected.ok_or_else(|| no_number(word))?)]));
    }
    let column = |run, word: &str| {
        series(bench, run, word).ok_or_else(|| {
            format!(
                "norm `{}` needs rows of time, and `{word}` is no column of a step table, or time goes back",
                m.norm.name()
            )
        })
    };
    let ours = column(run, &m.word)?;
    let constant = match (&m.against, file) {
        (Against::Form(form), _) if series(bench, run, form).is_none() => {
            let value = end(bench, run, form).ok_or_else(|| no_number(form))?;
            Some(Series { times: ours.times.clone(), values: vec![value; ours.times.len()] })
        }
        (_, file) => file.cloned(),
    };
    let pairs = match &constant {
        Some(expected) => paired(ours, expected)?,
        None => paired(ours, column(from, word)?)?,
    };
    Ok(m.norm.of(&pairs))
}

fn no_number(word: &str) -> String {
    format!("`{word}` is no number there")
}

/// A measure's series in a file: a log of LAMMPS or perigrain, or a table with a line of names, `time` among them. A table of one
/// row may do without times.
fn read(path: &Path, word: &str) -> Result<Series, String> {
    let name = path.display();
    let text =
        std::fs::read_to_string(path).map_err(|e| format!("the reference `{name}` cannot be read: {e}"))?;
    if text.contains("Loop time of ") {
        let log = lammps::read(&text);
        return Series::of(&log.tables, word).ok_or_else(|| {
            format!("the reference `{name}` has no step table with the columns `time` and `{word}`")
        });
    }
    let (table, _) = Axis::grid(&text, FileId::BROUGHT).map_err(|e| {
        let first = e.0.into_iter().next().map_or_else(String::new, |d| d.message);
        format!("the reference `{name}`: {first}")
    })?;
    let column = |wanted: &str| table.names.iter().position(|n| n == wanted);
    let Some(values) = column(word) else {
        return Err(format!(
            "the reference `{name}` has no column `{word}`: it has {}",
            table.names.join(", ")
        ));
    };
    let times = column("time");
    if times.is_none() && table.rows.len() > 1 {
        return Err(format!("the reference `{name}` has no column `time`"));
    }
    let mut out = Series::default();
    for (k, row) in table.rows.iter().enumerate() {
        let number = |at: usize| {
            let bad = || format!("the reference `{name}`, row {}: `{}` is no number", k + 1, row[at]);
            row[at].parse::<f64>().map_err(|_| bad())
        };
        let time = times.map_or(Ok(0.0), number)?;
        if out.times.last().is_some_and(|last| *last >= time) {
            return Err(format!("the reference `{name}`, row {}: time goes back", k + 1));
        }
        out.times.push(time);
        out.values.push(number(values)?);
    }
    Ok(out)
}
