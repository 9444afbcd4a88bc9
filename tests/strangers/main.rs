//! Faults that strangers hit, by kind: one file of tests per kind, with the decks that showed them in `decks/`.
//!
//! Which row each test answers, and what caused it, stands in `docs/decisions/strangers.md`.

mod bonds;
mod classics;
mod energy_of_contacts;
mod energy_of_solids;
mod interrupts;
mod ledger;
mod meshes;
mod movers;
mod pages;
mod pictures;
mod rigid;
mod room;
mod styles;
mod tools;
mod units;
mod words;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The decks of this folder.
fn decks() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/strangers/decks")
}

/// What the program prints and its exit status for a deck of `decks/`, run in a temporary folder without a log.
///
/// The folder of the decks is the deck's own folder, so that files beside it are found.
fn run(deck: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .arg("-in")
        .arg(decks().join(deck))
        .args(["-log", "none"])
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap()
}

/// Standard output and standard error as one text.
fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The numbers behind `name` on the last printed line that begins with it.
///
/// # Panics
///
/// Panics where no line begins with `name`, and prints the whole text.
fn numbers(text: &str, name: &str) -> Vec<f64> {
    let line = text.lines().rev().find(|l| l.split_whitespace().next() == Some(name));
    let line = line.unwrap_or_else(|| panic!("no line begins with {name}:\n{text}"));
    line.split_whitespace().skip(1).filter_map(|w| w.parse().ok()).collect()
}

/// The processor's time in the program's own code for a deck of `decks/` [s]: unlike the clock's it does not count what runs beside it.
///
/// # Panics
///
/// Panics where the run fails.
#[cfg(unix)]
fn processor(deck: &str, arguments: &[&str]) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new("sh")
        .args(["-c", "\"$0\" \"$@\" > said 2>&1 || exit 1; times", env!("CARGO_BIN_EXE_perigrain"), "-in"])
        .arg(decks().join(deck))
        .args(["-log", "none"])
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", std::fs::read_to_string(folder.path().join("said")).unwrap());
    // The second line is that of the shell's children: minutes and seconds in the program, then in the system.
    let printed = String::from_utf8(output.stdout).unwrap();
    let time = printed.lines().nth(1).unwrap().split_whitespace().next().unwrap();
    let (minutes, seconds) = time.trim_end_matches('s').split_once('m').unwrap();
    60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()
}
