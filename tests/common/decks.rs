//! Decks that the program runs in a folder of their own.

use std::path::Path;
use std::process::Command;

/// Runs a deck in a folder, with further words of the command line: standard output and error, and whether it went well.
pub fn run_in(folder: &Path, deck: &str, words: &[&str]) -> (String, bool) {
    std::fs::write(folder.join("in.deck"), deck).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "in.deck", "-log", "none"])
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (text, out.status.success())
}

/// The same in a folder that is gone afterwards.
pub fn run_with(deck: &str, words: &[&str]) -> (String, bool) {
    run_in(tempfile::tempdir().unwrap().path(), deck, words)
}
