//! Values between Rust and Python: lists of numbers are passed as bytes, which become arrays of `ctypes` or
//! numpy.

use perigrain::session::{Global, Order, Rows, VariableValue};
use perigrain::world::Slot;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

/// The bytes of numbers.
pub fn reals<'py>(py: Python<'py>, list: &[f64]) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = list.iter().flat_map(|a| a.to_ne_bytes()).collect();
    PyBytes::new(py, &bytes)
}

/// The bytes of integers.
pub fn wholes<'py>(py: Python<'py>, list: &[i32]) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = list.iter().flat_map(|a| a.to_ne_bytes()).collect();
    PyBytes::new(py, &bytes)
}

/// Numbers, and whether they are integers.
pub fn rows<'py>(py: Python<'py>, rows: &Rows) -> (Bound<'py, PyBytes>, bool) {
    match rows {
        Rows::Wholes(list) => (wholes(py, list), true),
        Rows::Reals(list) => (reals(py, list), false),
    }
}

/// Numbers from bytes.
pub fn taken(bytes: &[u8], whole: bool) -> PyResult<Rows> {
    let (chunks, rest) =
        (bytes.chunks_exact(if whole { 4 } else { 8 }), bytes.len() % if whole { 4 } else { 8 });
    if rest != 0 {
        return Err(PyValueError::new_err("the data end in the middle of a number"));
    }
    Ok(match whole {
        true => Rows::Wholes(chunks.map(|c| i32::from_ne_bytes([c[0], c[1], c[2], c[3]])).collect()),
        false => Rows::Reals(
            chunks.map(|c| f64::from_ne_bytes([c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]])).collect(),
        ),
    })
}

/// Three numbers each.
pub fn threes(list: &[f64]) -> PyResult<Vec<[f64; 3]>> {
    if !list.len().is_multiple_of(3) {
        return Err(PyValueError::new_err(format!("{} numbers are no triples", list.len())));
    }
    Ok(list.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

/// `"ids"`, `"places"`, or a list of ids.
pub fn order(given: &Bound<'_, PyAny>) -> PyResult<Order> {
    match given.extract::<String>().as_deref() {
        Ok("ids") => return Ok(Order::Ids),
        Ok("places") => return Ok(Order::Places),
        _ => {}
    }
    let wrong = |_| PyTypeError::new_err("ids of particles are whole numbers");
    given.extract::<Vec<i64>>().map(Order::Chosen).map_err(wrong)
}

/// A number of the scene with LAMMPS' code of its type.
pub fn global<'py>(py: Python<'py>, global: Global) -> PyResult<(i32, Bound<'py, PyAny>)> {
    const WHOLE: i32 = 0;
    const REAL: i32 = 2;
    const LARGE: i32 = 4;
    const TEXT: i32 = 6;
    Ok(match global {
        Global::Whole(k) => (WHOLE, k.into_pyobject(py)?.into_any()),
        Global::Large(k) => (LARGE, k.into_pyobject(py)?.into_any()),
        Global::Real(a) => (REAL, a.into_pyobject(py)?.into_any()),
        Global::Wholes(list) => (WHOLE, list.into_pyobject(py)?.into_any()),
        Global::Reals(list) => (REAL, list.into_pyobject(py)?.into_any()),
        Global::Text(text) => (TEXT, text.into_pyobject(py)?.into_any()),
    })
}

/// A variable's kind and value.
pub fn variable<'py>(py: Python<'py>, value: VariableValue) -> PyResult<(&'static str, Bound<'py, PyAny>)> {
    Ok(match value {
        VariableValue::Number(a) => ("number", a.into_pyobject(py)?.into_any()),
        VariableValue::Vector(list) => ("vector", reals(py, &list).into_any()),
        VariableValue::Particles(list) => ("particles", reals(py, &list).into_any()),
        VariableValue::Text(text) => ("text", text.into_pyobject(py)?.into_any()),
    })
}

/// The data of a compute or fix: scalar, vector, array, per-particle values, local values; lists as bytes
/// with their numbers of columns.
pub fn slot<'py>(py: Python<'py>, slot: &Slot, particles: usize) -> PyResult<Bound<'py, PyTuple>> {
    let o = slot.offers;
    let list = |there: bool, list: &[f64], cols: usize| there.then(|| (reals(py, list), cols));
    let mut atom = slot.atom.clone();
    // Particles created since have no value yet.
    atom.resize(particles * slot.cols, 0.0);
    (
        o.scalar.then_some(slot.scalar),
        o.vector.then(|| reals(py, &slot.vector)),
        list(o.array, &slot.array, slot.array_cols),
        list(o.atom, &atom, slot.cols),
        list(o.local, &slot.local, slot.local_cols),
    )
        .into_pyobject(py)
}
