//! Decks driven to their limits: what stays bounded, what is kept, and what is refused by name.
//!
//! `tables/*.toml` are the cases, `scenes/*.in` the decks. The short form runs every case for few steps; `./check --stress` runs
//! the long one with the release build and writes `docs/stability.md`; `PERIGRAIN_STRESS_ONLY=words` chooses cases.

mod page;
mod running;
mod table;

use running::{Form, Row, run_all};
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/stability.md")
}

/// What is wrong in a list of rows, one line each.
fn wrong(rows: &[Vec<Row>]) -> String {
    let mut text = String::new();
    for row in rows.iter().flatten().filter(|r| !r.met) {
        let _ = writeln!(text, "{}: {}", row.case, row.problem());
    }
    text
}

#[test]
fn the_short_form_passes() {
    let wanted = std::env::var("PERIGRAIN_STRESS_ONLY").unwrap_or_default();
    let sections = table::sections(&wanted);
    let rows = run_all(&sections, Form::Short, env!("CARGO_BIN_EXE_perigrain").as_ref());
    let wrong = wrong(&rows);
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
#[ignore = "takes minutes: `./check --stress`"]
fn the_long_form_passes_and_is_the_page() {
    let wanted = std::env::var("PERIGRAIN_STRESS_ONLY").unwrap_or_default();
    let program = std::env::var_os("PERIGRAIN_STRESS_PROGRAM");
    let program = program.map_or_else(|| PathBuf::from(env!("CARGO_BIN_EXE_perigrain")), PathBuf::from);
    let sections = table::sections(&wanted);
    // A page of few steps states that it is one.
    let short = std::env::var("PERIGRAIN_STRESS_FORM").is_ok_and(|f| f == "short");
    let form = if short { Form::Short } else { Form::Long };
    let rows = run_all(&sections, form, &program);
    if wanted.is_empty() {
        std::fs::write(page(), page::markdown(&sections, &rows, form)).unwrap();
    }
    let wrong = wrong(&rows);
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_page_has_the_rows_of_the_tables() {
    let text = std::fs::read_to_string(page()).unwrap();
    let found: Vec<&str> = text.lines().filter(|l| l.starts_with("| ")).collect();
    let found: Vec<String> = found.iter().map(|l| page::key(l)).collect();
    let expected = page::keys(&table::sections(""));
    let missing: Vec<_> = expected.iter().filter(|k| !found.contains(k)).collect();
    let strange: Vec<_> = found.iter().filter(|k| !expected.contains(k)).collect();
    assert!(
        missing.is_empty() && strange.is_empty() && found.len() == expected.len(),
        "`./check --stress` writes the page anew: {missing:?} missing, {strange:?} belong to nothing"
    );
}
