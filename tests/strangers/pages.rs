//! K9: numbers on pages are those that their decks print.
//!
//! Most pages are held to their decks by `tests/book.rs`, which compares blocks `output` with what the decks print; here stands what no
//! page can show in one.

use super::{decks, text};
use std::fs;
use std::process::Command;

/// The deck of the README breaks the plate and writes the picture that the page names.
#[test]
fn the_deck_of_the_readme_breaks_and_draws() {
    let readme = fs::read_to_string(decks().join("../../../README.md")).unwrap();
    let deck = readme.split("```text\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // A notch of 10 of 30 mm is damage from the start: the crack must have come through the rest of the width.
    let more = "compute broken all reduce max c_damage\nvariable tip equal c_tip[1]\nrun 0 post no\n\
                print \"RES $(v_tip) $(c_broken)\"\n";
    fs::write(path("in.readme"), format!("{deck}{more}")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    let output = command.args(["in.readme", "-log", "none"]).current_dir(folder.path()).output().unwrap();
    let printed = text(&output);
    assert!(output.status.success() && !printed.contains("warning"), "{printed}");
    let found = super::numbers(&printed, "RES");
    assert!(found[0] > 0.014 && found[1] > 0.5, "{found:?}");
    assert!(fs::read(path("crack.png")).unwrap().starts_with(b"\x89PNG"));
}
