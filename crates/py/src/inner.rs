//! Contents of a scene behind its lock.

use super::errors;
use super::functions::Library;
use super::memory::Looked;
use super::outside::Hook;
use super::screen::Screen;
use perigrain::session::Session;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Reason for a missing scene, after `close`.
pub const CLOSED: &str = "the scene is closed";
/// Reason for a missing scene, after a panic.
const BROKEN: &str = "the scene is gone: perigrain failed in the middle of a command, which is its own fault";

/// The guarded data.
pub struct Inner {
    pub session: Option<Session>,
    pub looked: Looked,
    pub screen: Screen,
    /// The functions of variables of style python.
    pub library: Arc<Library>,
    /// The hooks of fixes external, by fix ID.
    pub hooks: BTreeMap<String, Arc<Hook>>,
    pub why: &'static str,
    /// Whether it is a scene that a function sees within a step.
    pub moment: bool,
}

impl Inner {
    /// Ends the scene; memory that is viewed is left to the viewers.
    pub fn end(&mut self, why: &'static str) {
        self.looked.end(self.session.as_mut(), why);
        std::mem::take(&mut self.hooks).values().for_each(|hook| hook.forget());
        self.session = None;
        self.why = why;
    }

    /// After a panic the session's state cannot be trusted.
    pub fn broken(&mut self, py: Python<'_>, words: &str) -> PyErr {
        self.screen.show(py);
        // Columns with live views must outlive the session: it is leaked, not dropped.
        std::mem::forget(self.session.take());
        self.looked.end(None, BROKEN);
        self.why = BROKEN;
        errors::raised(py, "InternalError", (words,))
    }
}

impl Default for Inner {
    fn default() -> Self {
        Self {
            session: None,
            looked: Looked::default(),
            screen: Screen::default(),
            library: Arc::default(),
            hooks: BTreeMap::new(),
            why: CLOSED,
            moment: false,
        }
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        self.end(CLOSED);
    }
}
