//! A file with its bytes, and messages about places in it.

use crate::text::find_bytes;
pub use perigrain_base::diag::brought::{broken, not_read, place};
use perigrain_base::diag::{Diagnostic, Diagnostics, FileId, Result, Source, Span};
use perigrain_lang::Word;
use perigrain_world::World;
use std::sync::Arc;

/// A file that a deck names, read whole.
pub struct File {
    /// Where it was found.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
    /// The deck's word for it.
    pub at: Span,
}

impl File {
    /// Finds and reads a file, which is a `what`; unpacked when its name ends in `.gz`.
    ///
    /// # Errors
    /// Files that cannot be read, or that only a run would write.
    pub fn find(w: &World, word: &Word, what: &str) -> Result<Self> {
        let (name, bytes) = find_bytes(w, word, what)?;
        Ok(Self { name, bytes, at: word.span })
    }

    /// Its text.
    ///
    /// # Errors
    /// Bytes that are none.
    pub fn text(&self) -> Result<&str> {
        std::str::from_utf8(&self.bytes)
            .map_err(|e| broken(e.valid_up_to(), "the file is no text from here on"))
    }

    /// Puts messages where they belong: underlined in the file where it is a text, else at the deck's word with the number of the
    /// byte.
    pub fn blame(&self, e: Diagnostics) -> Diagnostics {
        match std::str::from_utf8(&self.bytes) {
            Ok(text) if e.0.iter().any(|d| d.span.is_some_and(|s| s.file == FileId::BROUGHT)) => {
                e.within(&Arc::new(Source { name: self.name.clone(), text: text.to_string() }))
            }
            Ok(_) => e.at(self.at),
            Err(_) => Diagnostics(e.0.into_iter().map(|d| self.by_byte(d)).collect()),
        }
    }

    fn by_byte(&self, mut d: Diagnostic) -> Diagnostic {
        d.labels.retain(|l| l.span.file != FileId::BROUGHT);
        match d.span {
            Some(s) if s.file == FileId::BROUGHT => {
                d.message = format!("{} (byte {} of `{}`)", d.message, s.start, self.name);
                d.span = Some(self.at);
                d
            }
            _ => d.at(self.at),
        }
    }
}
