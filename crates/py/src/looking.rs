//! Checks and plans of decks, without running them.

use super::errors;
use super::screen::Screen;
use super::working::beside;
use perigrain::diag::{Diagnostics, render};
use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Mode, Options, Session};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

type Variables = Vec<(String, Vec<String>)>;

/// Checks a deck: returns the session and the errors.
fn look(
    py: Python<'_>,
    mode: Mode,
    log: Log,
    (text, name, folder, vars): (String, String, PathBuf, Variables),
) -> PyResult<(Session, Diagnostics)> {
    let options = Options { mode, log, vars, folder, ..Options::default() };
    let ended = beside(py, &Screen::default(), &AtomicBool::new(false), move || {
        let mut session = Session::new(options)?;
        let outcome = session.run_text(&name, &text);
        Ok((session, outcome.err().unwrap_or_default()))
    });
    if let Some(e) = ended.raised {
        return Err(e);
    }
    let outcome = ended.outcome.map_err(|words| errors::raised(py, "InternalError", (words,)))?;
    outcome.map_err(|e| errors::deck(py, &e, &Default::default()))
}

/// All problems of a deck: a list of dictionaries, and a text with all of them.
#[pyfunction]
pub fn check<'py>(
    py: Python<'py>,
    text: String,
    name: String,
    folder: PathBuf,
    vars: Variables,
) -> PyResult<(Bound<'py, PyList>, String)> {
    let (session, mut problems) = look(py, Mode::Check, Log::silent(), (text, name, folder, vars))?;
    problems.append(session.notes.clone());
    problems.0.sort_by_key(|d| d.span.map(|s| (s.file, s.start)));
    let list = errors::described(py, &problems, &session.sources)?;
    Ok((list, render::plain(&problems, &session.sources)))
}

/// The step plan of each run in a deck.
#[pyfunction]
pub fn plan(
    py: Python<'_>,
    text: String,
    name: String,
    folder: PathBuf,
    vars: Variables,
) -> PyResult<String> {
    let screen = Buffer::default();
    let log = Log::new(Some(Box::new(screen.clone())));
    let (session, problems) = look(py, Mode::Plan, log, (text, name, folder, vars))?;
    if problems.has_errors() {
        return Err(errors::deck(py, &problems, &session.sources));
    }
    Ok(screen.text())
}
