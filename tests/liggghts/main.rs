//! Decks of LIGGGHTS: numbers of LIGGGHTS 3.8.0, its tutorials where they are installed, and the dialect itself.

mod bits;
mod clumps;
mod dialect;
mod golden;
mod reading;
mod tutorials;

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder.
fn perigrain(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain")).current_dir(folder).args(words).output().unwrap()
}

/// What it has printed.
fn printed(out: &Output) -> String {
    String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr)
}
