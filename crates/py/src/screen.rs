//! Screen output of a scene: written to Python's `sys.stdout`, including redirections.

use pyo3::prelude::*;
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

/// Output that has not been written yet.
#[derive(Clone, Default)]
pub struct Screen(Arc<Mutex<Vec<u8>>>);

impl Screen {
    /// Writes new output; errors of the stream are reported as Python does for exceptions that cannot be
    /// raised.
    pub fn show(&self, py: Python<'_>) {
        let bytes = std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        if bytes.is_empty() {
            return;
        }
        if let Err(e) = write(py, &String::from_utf8_lossy(&bytes)) {
            e.write_unraisable(py, None);
        }
    }
}

fn write(py: Python<'_>, text: &str) -> PyResult<()> {
    let out = py.import("sys")?.getattr("stdout")?;
    if out.is_none() {
        return Ok(());
    }
    out.call_method1("write", (text,))?;
    out.call_method0("flush")?;
    Ok(())
}

impl Write for Screen {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
