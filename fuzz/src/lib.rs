//! What the targets share: a deck worked off in a folder of its own, with a file of any bytes beside it.

use perigrain::session::{Mode, Options, Session};
use std::path::Path;

/// Works the deck off; the outcome means nothing, a panic everything.
pub fn work_off(deck: &str, mode: Mode, folder: &Path) {
    let options = Options { mode, folder: folder.to_path_buf(), ..Options::default() };
    if let Ok(mut session) = Session::new(options) {
        let _ = session.run_text("fuzz.in", deck);
    }
}

/// Works a deck off that reads the bytes as a file; `FILE` in it stands for the file's path.
pub fn with_file(bytes: &[u8], deck: &str) {
    let Ok(folder) = tempfile::tempdir() else { return };
    let path = folder.path().join("input");
    if std::fs::write(&path, bytes).is_ok() {
        work_off(&deck.replace("FILE", &path.display().to_string()), Mode::Run, folder.path());
    }
}
