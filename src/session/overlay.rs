//! Texts that are open in an editor, in place of what lies on the disk.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Texts by absolute paths. A copy is cheap.
#[derive(Clone, Debug, Default)]
pub struct Overlay(Arc<BTreeMap<PathBuf, Arc<str>>>);

impl Overlay {
    /// Of texts by their [`absolute`] paths.
    pub fn new(texts: BTreeMap<PathBuf, Arc<str>>) -> Self {
        Self(Arc::new(texts))
    }

    /// The text of a file, if it is open.
    pub fn get(&self, path: &Path) -> Option<&str> {
        if self.0.is_empty() { None } else { self.0.get(&absolute(path)).map(AsRef::as_ref) }
    }
}

/// An absolute path without `.` and `..`, so that one file has one name.
pub fn absolute(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut out = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(out.pop()),
            part => out.push(part),
        }
    }
    out
}
