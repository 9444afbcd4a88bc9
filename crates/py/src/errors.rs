//! Errors as exceptions of the package.

use perigrain::diag::{Diagnostic, Diagnostics, Severity, Sources, render};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// An exception of `perigrain.errors` with these arguments.
pub fn raised<'py>(py: Python<'py>, class: &str, args: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py
        .import("perigrain.errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call1(args));
    made.map_or_else(|e| e, PyErr::from_value)
}

/// The scene is executing a command, or the operation is only allowed between runs.
pub fn busy(py: Python<'_>) -> PyErr {
    raised(
        py,
        "BusyError",
        ("the scene is at work: another thread or a callback has called in the middle of a command",),
    )
}

/// A function called within a step uses an operation that is only allowed between commands.
pub fn within(py: Python<'_>) -> PyErr {
    let words = "a step is under way: a function of `fix python/invoke` is shown particles, box and settings; commands, \
                 computes, fixes and variables wait until the run is over";
    raised(py, "BusyError", (words,))
}

/// The scene is closed.
pub fn closed(py: Python<'_>, why: &str) -> PyErr {
    raised(py, "ClosedError", (why,))
}

/// The errors of a deck.
pub fn deck(py: Python<'_>, problems: &Diagnostics, sources: &Sources) -> PyErr {
    match described(py, problems, sources) {
        Ok(list) => raised(py, "DeckError", (list, render::plain(problems, sources))),
        Err(e) => e,
    }
}

/// Problems as dictionaries.
pub fn described<'py>(
    py: Python<'py>,
    problems: &Diagnostics,
    sources: &Sources,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for d in &problems.0 {
        list.append(one(py, d, sources)?)?;
    }
    Ok(list)
}

fn one<'py>(py: Python<'py>, d: &Diagnostic, sources: &Sources) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    out.set_item("severity", severity)?;
    out.set_item("code", d.code.to_string())?;
    out.set_item("message", &d.message)?;
    let source = d.span.and_then(|span| sources.get(span.file).map(|source| (span, source)));
    let place = source.map(|(span, _)| sources.place(span));
    out.set_item("file", source.map(|(_, source)| source.name.as_str()))?;
    out.set_item("line", place.map(|(line, _)| line))?;
    out.set_item("column", place.map(|(_, column)| column))?;
    let word = source.and_then(|(span, source)| source.text.get(span.start as usize..span.end as usize));
    out.set_item("word", word)?;
    out.set_item("help", d.help.join("\n"))?;
    Ok(out)
}
