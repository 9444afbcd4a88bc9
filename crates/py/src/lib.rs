//! perigrain as a Python module: the thin layer below the package `perigrain`, without physics or deck
//! language.
//!
//! Main types: [`Scene`], a session behind a lock; [`Memory`], a column of particles viewed from Python.

mod errors;
mod functions;
mod inner;
mod looking;
mod memory;
mod moment;
mod outside;
mod program;
mod scene;
mod screen;
mod values;
mod working;

pub use memory::Memory;
pub use scene::Scene;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::looking::{check, plan};
    #[pymodule_export]
    use super::memory::Memory;
    #[pymodule_export]
    use super::outside::Handle;
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::scene::{Scene, styles};

    #[pymodule_init]
    fn init(m: &Bound<'_, PyModule>) -> PyResult<()> {
        m.add("VERSION", env!("CARGO_PKG_VERSION"))
    }
}
