//! The files a deck reads, and those it would have written where it is only checked.

use super::overlay::Overlay;
use perigrain_base::diag::{Code, Diagnostic};
use perigrain_lang::Files;
use perigrain_world::reading::{ReadFiles, place};
use perigrain_world::{Promise, Promises};
use std::path::{Path, PathBuf};

/// Files as the system has them.
pub(super) struct RealFiles<'a> {
    /// What the deck would have written by now, where nothing is.
    pub promised: Promises,
    /// The deck's folder.
    pub folder: &'a Path,
    /// Texts that are open in an editor.
    pub overlay: &'a Overlay,
    /// Takes note of what is read.
    pub read: ReadFiles,
    /// Whether the deck is only looked at.
    pub looking: bool,
    /// How many lines have been looked at, each turn of a loop counted, and since when.
    pub looked: (u64, std::time::Instant),
}

/// How many lines of a deck are looked at before loops are left, and for how long.
const LOOKED: (u64, std::time::Duration) = (50_000, std::time::Duration::from_secs(10));

impl Files for RealFiles<'_> {
    fn read(&self, path: &str) -> std::io::Result<String> {
        match self.promised.get(path) {
            Some(Promise::Text(text)) => return Ok(text.clone()),
            // one that is there is an old one
            Some(_) => return Err(std::io::ErrorKind::NotFound.into()),
            None => {}
        }
        let (named, path) = (self.folder.join(path), place(path, self.folder));
        if let Some(text) = self.overlay.get(&path).or_else(|| self.overlay.get(&named)) {
            return Ok(text.to_string());
        }
        let bytes = perigrain_base::gate::read(&path)?;
        self.read.note(&path);
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn read_data(&self, path: &str) -> std::io::Result<String> {
        self.read(path).map(|text| self.read.plain(path, text))
    }

    fn comes_later(&self, path: &str) -> bool {
        self.looking && self.promised.may_come(path)
    }

    fn only_looks(&self) -> bool {
        self.looking
    }

    fn has_looked_long(&self) -> bool {
        let (lines, since) = self.looked;
        lines > LOOKED.0 || since.elapsed() > LOOKED.1
    }
}

/// Notes on loops that were left before their end where a deck was only checked.
pub(super) fn left_loops(script: &perigrain_lang::Script) -> Vec<Diagnostic> {
    let note = |(span, turns): (perigrain_base::diag::Span, u64)| {
        let text = format!(
            "the end of this loop is not in sight after {turns} turns: later ones were not looked at"
        );
        Diagnostic::note(Code::LONG_LOOP, span, text)
    };
    script.left_loops().map(note).collect()
}

/// The warning about a log file that another run is writing.
pub(super) fn shared(path: &Path) -> Diagnostic {
    let text = format!(
        "another run is writing `{}` now: each of them writes over what the other has written",
        path.display()
    );
    Diagnostic::warning(Code::SUSPICIOUS, None, text)
        .help("start each run in a folder of its own, or with `-log FILE`")
}

/// The folder a deck's relative names refer to: its own.
pub fn folder_of(deck: &Path) -> PathBuf {
    deck.parent().map(Path::to_path_buf).unwrap_or_default()
}
