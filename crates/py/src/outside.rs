//! Fixes external: Python functions that give forces, and further values.

use super::values;
use perigrain::session::Rows;
use perigrain::world::Outside;
use perigrain::world::outside::{Each, HostCall, HostValues};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use pyo3::{PyTraverseError, PyVisit};
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The link between one fix external and Python. Its lock is held briefly, and never while Python code runs.
#[derive(Default)]
pub struct Hook(Mutex<State>);

#[derive(Default)]
struct State {
    function: Option<Py<PyAny>>,
    values: HostValues,
    /// Per-particle values that Python has set and no step has fetched yet.
    each: Each,
    /// The exception raised by the function.
    raised: Option<PyErr>,
}

impl fmt::Debug for Hook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Hook")
    }
}

impl Hook {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The exception raised by the function since the last call.
    pub fn raised(&self) -> Option<PyErr> {
        self.state().raised.take()
    }

    /// Removes the function. It is dropped outside the lock, because that may run Python code.
    pub fn forget(&self) {
        let gone = self.state().function.take();
        drop(gone);
    }

    /// Exposes held objects to Python's garbage collector.
    pub fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        match self.0.try_lock() {
            Ok(state) => state.function.as_ref().map_or(Ok(()), |function| visit.call(function)),
            Err(_) => Ok(()),
        }
    }
}

impl Outside for Hook {
    fn call(&self, call: HostCall<'_>) -> Option<Result<(), String>> {
        Python::attach(|py| {
            let function = self.state().function.as_ref().map(|function| function.clone_ref(py))?;
            Some(called(py, &function, call).map_err(|e| {
                let words = e.to_string();
                self.state().raised = Some(e);
                words
            }))
        })
    }

    fn values(&self) -> HostValues {
        self.state().values.clone()
    }

    fn each(&self) -> Each {
        std::mem::take(&mut self.state().each)
    }
}

/// Hands Python copies, and takes the forces over if it ends well.
fn called(py: Python<'_>, function: &Py<PyAny>, call: HostCall<'_>) -> PyResult<()> {
    let ids: Vec<i32> = call.ids.iter().map(|&id| id as i32).collect();
    let reals = |list: &[[f64; 3]]| values::reals(py, list.as_flattened());
    let f = PyByteArray::from(reals(call.f).as_any())?;
    function.call1(py, (call.step, values::wholes(py, &ids), reals(call.x), f.clone()))?;
    match values::taken(&f.to_vec(), false)? {
        Rows::Reals(list) if list.len() == 3 * call.f.len() => {
            call.f.as_flattened_mut().copy_from_slice(&list);
            Ok(())
        }
        _ => Err(PyValueError::new_err("there are more or fewer forces than particles")),
    }
}

/// Per-particle energies and virials from bytes.
pub fn each_of(energy: Option<&[u8]>, virial: Option<&[u8]>) -> PyResult<Each> {
    let reals = |bytes: &[u8]| match values::taken(bytes, false)? {
        Rows::Reals(list) => Ok(list),
        Rows::Wholes(_) => Err(PyValueError::new_err("whole numbers are no energies")),
    };
    let energy = energy.map(reals).transpose()?;
    let virial = virial.map(reals).transpose()?;
    let six = |c: &[f64]| [c[0], c[1], c[2], c[3], c[4], c[5]];
    Ok(Each { energy, virial: virial.map(|list| list.chunks_exact(6).map(six).collect()) })
}

/// The package's handle of a fix external.
#[pyclass(frozen, name = "Outside", module = "perigrain._core")]
pub struct Handle(pub Arc<Hook>);

#[pymethods]
impl Handle {
    /// Sets the function: its arguments are step, ids, positions and forces, the last as a bytearray to be
    /// written.
    fn call(&self, function: Py<PyAny>) {
        let before = self.0.state().function.replace(function);
        drop(before);
    }

    /// Sets the energy of the forces.
    fn energy(&self, energy: f64) {
        self.0.state().values.energy = energy;
    }

    /// Sets their virial.
    fn virial(&self, virial: [f64; 6]) {
        self.0.state().values.virial = virial;
    }

    /// Sets per-particle energies and virials for the call in progress.
    #[pyo3(signature = (energy, virial))]
    fn each(&self, energy: Option<&[u8]>, virial: Option<&[u8]>) -> PyResult<()> {
        let given = each_of(energy, virial)?;
        let mut state = self.0.state();
        let own = &mut state.each;
        if given.energy.is_some() {
            own.energy = given.energy;
        }
        if given.virial.is_some() {
            own.virial = given.virial;
        }
        Ok(())
    }

    /// Sets one of the values; the index counts from 1.
    fn value(&self, index: usize, value: f64) {
        let list = &mut self.0.state().values.vector;
        list.resize(list.len().max(index), 0.0);
        if let Some(own) = index.checked_sub(1).and_then(|k| list.get_mut(k)) {
            *own = value;
        }
    }
}
