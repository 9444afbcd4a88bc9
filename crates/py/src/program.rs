//! The whole program, for `python -m perigrain`.

use perigrain::sweep::starter::started_by;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Executes a command line and returns the exit code. `start` is the program with the words that start it
/// again.
#[pyfunction]
pub fn main(py: Python<'_>, start: Vec<OsString>, words: Vec<OsString>) -> u8 {
    let mut own = start.into_iter();
    let program = own.next().map(PathBuf::from).unwrap_or_default();
    started_by(program, own.collect(), words);
    py.detach(perigrain::cli::work)
}
