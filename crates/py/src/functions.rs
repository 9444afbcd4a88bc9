//! Python functions for variables of style `python` and the command `python`: those of the program's
//! `__main__`.

use perigrain::lang::python::{Functions, Given};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString, PyTuple};
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// The functions of `__main__`, and an exception raised there that has not been reported yet.
#[derive(Default)]
pub struct Library(Mutex<Option<PyErr>>);

impl fmt::Debug for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Library")
    }
}

/// The names of `__main__`.
pub fn names(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    Ok(py.import("__main__")?.dict())
}

impl Library {
    /// The exception raised by code or a function since the last call.
    pub fn raised(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Stores an exception; returns its text.
    pub fn keep(&self, e: PyErr) -> String {
        let words = e.to_string();
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(e);
        words
    }
}

impl Functions for Library {
    fn execute(&self, code: &str, name: &str) -> Result<(), String> {
        Python::attach(|py| {
            let run = || -> PyResult<()> {
                let builtins = py.import("builtins")?;
                let code = builtins.getattr("compile")?.call1((code, name, "exec"))?;
                builtins.getattr("exec")?.call1((code, names(py)?)).map(drop)
            };
            run().map_err(|e| self.keep(e))
        })
    }

    fn has(&self, function: &str) -> bool {
        Python::attach(|py| {
            let found = names(py).and_then(|names| names.get_item(function));
            found.ok().flatten().is_some_and(|f| f.is_callable())
        })
    }

    fn call(&self, function: &str, given: &[Given]) -> Result<Given, String> {
        Python::attach(|py| {
            let run = || -> PyResult<Given> {
                let Some(known) = names(py)?.get_item(function)? else {
                    return Err(PyTypeError::new_err(format!("there is no function `{function}` any more")));
                };
                let given: Vec<Bound<'_, PyAny>> =
                    given.iter().map(|one| object(py, one)).collect::<PyResult<_>>()?;
                back(&known.call1(PyTuple::new(py, given)?)?)
            };
            run().map_err(|e| self.keep(e))
        })
    }
}

fn object<'py>(py: Python<'py>, given: &Given) -> PyResult<Bound<'py, PyAny>> {
    Ok(match given {
        Given::Whole(k) => k.into_pyobject(py)?.into_any(),
        Given::Real(a) => a.into_pyobject(py)?.into_any(),
        Given::Text(text) => text.into_pyobject(py)?.into_any(),
        Given::Nothing => py.None().into_bound(py),
    })
}

/// Converts the result of a function; numpy numbers count as numbers.
fn back(value: &Bound<'_, PyAny>) -> PyResult<Given> {
    if value.is_none() {
        return Ok(Given::Nothing);
    }
    if value.is_instance_of::<PyString>() {
        return value.extract().map(Given::Text);
    }
    if value.is_instance_of::<PyBool>() || value.is_instance_of::<PyInt>() || value.hasattr("__index__")? {
        return value.call_method0("__index__")?.extract().map(Given::Whole);
    }
    if value.is_instance_of::<PyFloat>() || value.hasattr("__float__")? {
        return value.call_method0("__float__")?.extract().map(Given::Real);
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!("a number, a text or nothing is needed, not {kind}")))
}
