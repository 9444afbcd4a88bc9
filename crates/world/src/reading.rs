//! Files that a deck reads: where they are looked for, and which ones were read.

use super::World;
use perigrain_base::diag::Diagnostic;
use perigrain_base::{gate, letters};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The files that were read so far, and notes about what stands in them; copies take note of the same.
#[derive(Clone, Debug, Default)]
pub struct ReadFiles(Arc<Found>);

#[derive(Debug, Default)]
struct Found {
    paths: Mutex<BTreeSet<PathBuf>>,
    notes: Mutex<Vec<Diagnostic>>,
    /// Whether there are notes: checked after each line of a deck.
    noted: AtomicBool,
}

impl ReadFiles {
    /// Takes note of one.
    pub fn note(&self, path: &Path) {
        if let Ok(whole) = std::path::absolute(path) {
            self.0.paths.lock().unwrap_or_else(PoisonError::into_inner).insert(whole);
        }
    }

    /// All of them, as absolute paths in their order.
    pub fn all(&self) -> Vec<PathBuf> {
        self.0.paths.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    /// The text of a file of data with blanks and signs in the place of what looks like them, which a note names.
    pub fn plain(&self, name: &str, text: String) -> String {
        let (text, found) = letters::plain_data(text);
        if let Some(note) = letters::note_of_file(name, &text, &found) {
            self.0.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
            self.0.noted.store(true, Ordering::Relaxed);
        }
        text
    }

    /// The same of bytes that may be no text.
    pub fn plain_bytes(&self, name: &str, bytes: Vec<u8>) -> Vec<u8> {
        match String::from_utf8(bytes) {
            Ok(text) => self.plain(name, text).into_bytes(),
            Err(e) => e.into_bytes(),
        }
    }

    /// The notes since the last call.
    pub fn take_notes(&self) -> Vec<Diagnostic> {
        if !self.0.noted.load(Ordering::Relaxed) {
            return vec![];
        }
        self.0.noted.store(false, Ordering::Relaxed);
        std::mem::take(&mut self.0.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Where the file `name` of a deck is: in the working folder, else in `folder`, the deck's own.
pub fn place(name: &str, folder: &Path) -> PathBuf {
    let (plain, beside) = (PathBuf::from(name), folder.join(name));
    if !gate::exists(&plain) && gate::exists(&beside) { beside } else { plain }
}

impl World {
    /// Where the file `name` is that a line is about to read; it is taken note of.
    pub fn to_read(&self, name: &str) -> PathBuf {
        let path = place(name, &self.folder);
        self.read_files.note(&path);
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_looked_for_beside_the_deck_too() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("rock.stl"), "").unwrap();
        let w = World { folder: folder.path().to_owned(), ..World::default() };
        assert_eq!(w.to_read("rock.stl"), folder.path().join("rock.stl"));
        assert_eq!(w.to_read("nowhere.stl"), Path::new("nowhere.stl"));
        let read = w.read_files.all();
        assert!(read.len() == 2 && read.iter().all(|p| p.is_absolute()), "{read:?}");
    }
}
