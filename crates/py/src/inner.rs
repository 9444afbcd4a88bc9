//! What a scene has behind its lock.

use super::errors;
use super::functions::Library;
use super::memory::Looked;
use super::outside::Hook;
use super::screen::Screen;
use perigrain::session::Session;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Why there is no scene, after `close`.
pub const CLOSED: &str = "the scene is closed";
/// Why there is no scene, after a panic.
const BROKEN: &str = "the scene is gone: perigrain failed in the middle of a command, which is its own fault";

/// What a lock guards.
pub struct Inner {
    pub session: Option<Session>,
    pub looked: Looked,
    pub screen: Screen,
    /// The functions of variables of style python.
    pub library: Arc<Library>,
    /// What fixes external talk to, by their ids.
    pub hooks: BTreeMap<String, Arc<Hook>>,
    pub why: &'static str,
    /// It is shown to a function that is called within a step.
    pub moment: bool,
}

impl Inner {
    /// Ends the scene; what is looked at belongs to who looks.
    pub fn end(&mut self, why: &'static str) {
        self.looked.end(self.session.as_mut(), why);
        std::mem::take(&mut self.hooks).values().for_each(|hook| hook.forget());
        self.session = None;
        self.why = why;
    }

    /// After a panic nothing of the session can be trusted.
    pub fn broken(&mut self, py: Python<'_>, words: &str) -> PyErr {
        self.screen.show(py);
        // What the scene still has of columns that are looked at must outlive it: the session is left behind, not dropped.
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
