//! The manual on paper is the manual in the program; its decks work.
//! `PERIGRAIN_BLESS=1 cargo test --test docs` writes the pages anew.
#![allow(clippy::unwrap_used)] // a test fails by panicking

use perigrain::cli::manual::{heading, pages};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

/// Every generated file below `docs` with its text.
fn generated() -> Vec<(PathBuf, String)> {
    let mut index = String::from(
        "# Commands and styles\n\nWritten from the program's own tables, like `perigrain doc`.\n",
    );
    let mut kind = "";
    let mut files = vec![];
    for page in pages() {
        if page.kind != kind {
            kind = page.kind;
            let _ = write!(index, "\n## {}\n\n", heading(kind));
        }
        let _ = writeln!(index, "- [{}](styles/{}): {}", page.title(), page.file(), page.doc.summary);
        files.push((docs().join("styles").join(page.file()), page.markdown()));
    }
    files.push((docs().join("commands.md"), index));
    let house = docs().join("architecture.md");
    files.push((house.clone(), with_code(&fs::read_to_string(house).unwrap())));
    files
}

/// The text with the code shown below each `<!-- src/FILE -->` and `<!-- line of src/FILE: WORD -->` as it is in the tree.
fn with_code(text: &str) -> String {
    let mut out = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let _ = writeln!(out, "{line}");
        let Some(marker) = line.strip_prefix("<!-- ").and_then(|l| l.strip_suffix(" -->")) else { continue };
        let (file, word) = match marker.strip_prefix("line of ").and_then(|m| m.split_once(": ")) {
            Some((file, word)) => (file, Some(word)),
            None => (marker, None),
        };
        let code = fs::read_to_string(docs().join("..").join(file)).unwrap();
        let code = code.split("#[cfg(test)]").next().unwrap();
        let shown: Vec<&str> =
            code.trim_end().lines().filter(|l| word.is_none_or(|w| l.contains(w))).collect();
        let _ = write!(out, "\n```rust\n{}\n```\n", shown.join("\n"));
        if lines.next_if_eq(&"").is_some() && lines.next_if_eq(&"```rust").is_some() {
            while lines.next().is_some_and(|l| l != "```") {}
        } else {
            out.push('\n');
        }
    }
    out
}

#[test]
fn pages_are_up_to_date() {
    let bless = std::env::var_os("PERIGRAIN_BLESS").is_some();
    let wanted = generated();
    if bless {
        let _ = fs::remove_dir_all(docs().join("styles"));
        fs::create_dir_all(docs().join("styles")).unwrap();
        for (path, text) in &wanted {
            fs::write(path, text).unwrap();
        }
    }
    let mut wrong = String::new();
    for (path, text) in &wanted {
        if fs::read_to_string(path).ok().as_ref() != Some(text) {
            let _ = writeln!(wrong, "{} differs from the program's table", path.display());
        }
    }
    for entry in fs::read_dir(docs().join("styles")).into_iter().flatten() {
        let path = entry.unwrap().path();
        if !wanted.iter().any(|(p, _)| *p == path) {
            let _ = writeln!(wrong, "{} belongs to nothing", path.display());
        }
    }
    assert!(wrong.is_empty(), "{wrong}\nPERIGRAIN_BLESS=1 cargo test --test docs writes them anew");
}

#[test]
fn every_page_is_complete() {
    let mut wrong = String::new();
    for page in pages() {
        let doc = page.doc;
        if doc.syntax.is_empty() || doc.text.is_empty() || doc.example.is_empty() {
            let _ = writeln!(wrong, "{}: syntax, text or example is missing", page.title());
        }
        if !doc.summary.starts_with(char::is_uppercase) || !doc.summary.ends_with('.') {
            let _ = writeln!(wrong, "{}: the summary is no sentence: {}", page.title(), doc.summary);
        }
        if !doc.syntax.contains(page.name) {
            let _ = writeln!(wrong, "{}: the syntax does not name it: {}", page.title(), doc.syntax);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn links_lead_somewhere() {
    let mut wrong = String::new();
    let mut files: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].iter().map(|f| docs().join("..").join(f)).collect();
    for folder in [docs(), docs().join("decisions"), docs().join("styles")] {
        files.extend(fs::read_dir(folder).into_iter().flatten().map(|e| e.unwrap().path()));
    }
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "md")) {
        let text = fs::read_to_string(file).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = link.split('#').next().unwrap();
            if !link.contains("://") && !target.is_empty() && !file.parent().unwrap().join(target).exists() {
                let _ = writeln!(wrong, "{}: {link}", file.display());
            }
        }
    }
    assert!(wrong.is_empty(), "links that lead nowhere:\n{wrong}");
}

/// Fenced blocks of a Markdown text that begin like a deck.
fn decks(text: &str) -> Vec<String> {
    text.split("```text\n")
        .skip(1)
        .filter_map(|b| b.split("```").next())
        .filter(|b| b.starts_with("units "))
        .map(String::from)
        .collect()
}

/// Runs the program on a deck in a folder of its own; what it says on standard error if it fails.
fn perigrain(args: &[&str], deck: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_perigrain"));
    let output = command.args(args).current_dir(folder.path()).output().unwrap();
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn decks_in_the_text_run() {
    let mut wrong = String::new();
    let mut files: Vec<PathBuf> = fs::read_dir(docs()).unwrap().map(|e| e.unwrap().path()).collect();
    files.push(docs().join("../README.md"));
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "md")) {
        for deck in decks(&fs::read_to_string(file).unwrap()) {
            if let Some(said) = perigrain(&["in.deck", "-screen", "none"], &deck) {
                let _ = writeln!(wrong, "{}:\n{said}", file.display());
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_dependency_has_its_sentence() {
    let manifest: toml::Table = fs::read_to_string(docs().join("../Cargo.toml")).unwrap().parse().unwrap();
    let text = fs::read_to_string(docs().join("decisions/dependencies.md")).unwrap();
    let mut wrong = String::new();
    for section in ["dependencies", "dev-dependencies"] {
        for name in manifest[section].as_table().unwrap().keys() {
            let explained = text
                .lines()
                .any(|l| l.starts_with("| `") && l.split('|').nth(1).unwrap().contains(&format!("`{name}`")));
            if !explained {
                let _ = writeln!(wrong, "{name}");
            }
        }
    }
    assert!(wrong.is_empty(), "without a sentence in docs/decisions/dependencies.md:\n{wrong}");
}
