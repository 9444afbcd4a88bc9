//! The screen of a scene: what it says goes to Python's `sys.stdout`, wherever that leads.

use pyo3::prelude::*;
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

/// What was said and not shown yet.
#[derive(Clone, Default)]
pub struct Screen(Arc<Mutex<Vec<u8>>>);

impl Screen {
    /// Hands over what was said since; a stream that cannot be written is told of as Python does for what nobody can catch.
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
