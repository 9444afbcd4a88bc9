//! The files a deck reads, and what `check` knows of those it would have written.

use crate::lang::Files;
use crate::world::Promise;
use std::collections::BTreeMap;

/// Files as the system has them.
pub(super) struct RealFiles<'a> {
    /// Nothing is written (`check` mode): what the deck would have written by now.
    pub promised: Option<&'a BTreeMap<String, Promise>>,
    /// A shell command may have written anything.
    pub anything: bool,
}

impl Files for RealFiles<'_> {
    fn read(&self, path: &str) -> std::io::Result<String> {
        if let Some(Promise::Text(text)) = self.promised.and_then(|p| p.get(path)) {
            return Ok(text.clone());
        }
        let bytes = std::fs::read(path)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn comes_later(&self, path: &str) -> bool {
        self.promised.is_some_and(|p| self.anything || p.contains_key(path))
    }

    fn only_checks(&self) -> bool {
        self.promised.is_some()
    }
}
