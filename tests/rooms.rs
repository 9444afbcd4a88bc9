//! The house rules that a machine can check: which room may import which, what each file opens with, how long it gets.
#![allow(clippy::unwrap_used)] // a test fails by panicking

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Which room may import which; every room may also import `diag` and `math`, except `math` itself.
/// Arrows point down: nothing listed here leads back up. `styles` may also see `WORDS`.
const ARROWS: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("diag", &[]),
    ("units", &[]),
    ("par", &[]),
    ("lang", &["units"]),
    ("world", &["par", "units"]),
    ("neigh", &["world", "par"]),
    ("laws", &["world", "neigh", "par"]),
    ("plan", &["world", "par"]),
    ("out", &["world", "par"]),
    ("styles", &["laws", "plan", "neigh", "world", "out", "units", "par"]),
    ("graph", &["styles", "plan", "world", "neigh", "out", "lang", "units", "par"]),
    ("run", &["plan", "world", "par"]),
    ("session", &["graph", "run", "plan", "lang", "world", "out", "par", "styles"]),
    ("cli", &["session", "lang", "out", "styles"]),
];

/// What `styles` may see of `lang`: words and references as they stand in a deck, not how decks are read.
const WORDS: &[&str] = &["args", "Args", "Command", "Word", "Param", "RefKind", "ValueRef", "parse_number"];

/// Rooms that every room but `math` may import.
const OPEN_TO_ALL: &[&str] = &["diag", "math"];

/// Past this many lines a file is two files.
const LONGEST: usize = 600;

#[test]
fn rooms_import_downwards_only() {
    let mut wrong = String::new();
    for file in rust_files("src") {
        let Some(room) = room_of(&file) else { continue };
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == room) else {
            panic!("{} is in room `{room}`, which is not in the table of this test", file.display());
        };
        let text = fs::read_to_string(&file).unwrap();
        for (line, path) in imports(&text, depth_of(&file)) {
            if !permitted(&room, allowed, &path) {
                writeln!(
                    wrong,
                    "{}:{line}: `{room}` may not import `crate::{}`",
                    file.display(),
                    path.join("::")
                )
                .unwrap();
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that are not in the table:\n{wrong}");
}

#[test]
fn every_file_opens_with_one_sentence() {
    let mut wrong = String::new();
    for folder in ["src", "tests", "benches"] {
        for file in rust_files(folder) {
            let text = fs::read_to_string(&file).unwrap();
            let opening: Vec<&str> = text.lines().map_while(|l| l.strip_prefix("//! ")).collect();
            if !opening.concat().trim_end().ends_with('.') {
                writeln!(wrong, "{}", file.display()).unwrap();
            }
        }
    }
    assert!(wrong.is_empty(), "files whose first lines are no `//!` sentence with a full stop:\n{wrong}");
}

#[test]
fn no_file_is_two_files() {
    let mut wrong = String::new();
    let mut lengths: Vec<(usize, PathBuf)> = rust_files("src")
        .into_iter()
        .map(|file| (fs::read_to_string(&file).unwrap().lines().count(), file))
        .collect();
    lengths.sort();
    for (lines, file) in lengths.iter().rev() {
        if *lines > LONGEST {
            writeln!(wrong, "{lines} lines: {}", file.display()).unwrap();
        }
    }
    let (median, total) = (lengths[lengths.len() / 2].0, lengths.iter().map(|l| l.0).sum::<usize>());
    println!("{} files, {total} lines, median {median}; the longest:", lengths.len());
    for (lines, file) in lengths.iter().rev().take(5) {
        println!("{lines:6} {}", file.display());
    }
    assert!(wrong.is_empty(), "longer than {LONGEST} lines:\n{wrong}");
}

/// All Rust files below a folder of the package, sorted.
fn rust_files(folder: &str) -> Vec<PathBuf> {
    let mut found = vec![];
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(dir) = folders.pop() {
        let Ok(entries) = fs::read_dir(&dir) else { continue };
        for path in entries.map(|e| e.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The parts of a file's path below `src`.
fn below_src(file: &Path) -> Vec<String> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let below = file.strip_prefix(&src).unwrap();
    below.with_extension("").iter().map(|p| p.to_string_lossy().into_owned()).collect()
}

/// The room a file is in; `None` for the crate's own two doors, lib.rs and main.rs.
fn room_of(file: &Path) -> Option<String> {
    let parts = below_src(file);
    (parts != ["lib"] && parts != ["main"]).then(|| parts[0].clone())
}

/// How many `super::` lead from a file's module to the crate root.
fn depth_of(file: &Path) -> usize {
    below_src(file).iter().filter(|p| *p != "mod").count()
}

fn permitted(room: &str, allowed: &[&str], path: &[String]) -> bool {
    let target = path[0].as_str();
    let words_only =
        room == "styles" && target == "lang" && path.len() > 1 && WORDS.contains(&path[1].as_str());
    target == room
        || allowed.contains(&target)
        || (room != "math" && OPEN_TO_ALL.contains(&target))
        || words_only
}

/// Every path from the crate root that a file's code names, with its line; unit tests may look anywhere.
fn imports(text: &str, depth: usize) -> Vec<(usize, Vec<String>)> {
    let code = without_comments_and_strings(text);
    let code = &code[..code.find("#[cfg(test)]\nmod ").unwrap_or(code.len())];
    let mut found = vec![];
    for (at, _) in code.match_indices("crate::") {
        let starts_word = !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        if starts_word {
            let line = code[..at].matches('\n').count() + 1;
            let mut paths = vec![];
            tree(&code[at + "crate::".len()..], &mut vec![], &mut paths);
            found.extend(paths.into_iter().map(|p| (line, p)));
        }
    }
    let climb = "super::".repeat(depth);
    for (at, _) in code.match_indices(&climb) {
        if !code[..at].ends_with("super::") && !code[at + climb.len()..].starts_with("super::") {
            let line = code[..at].matches('\n').count() + 1;
            let mut paths = vec![];
            tree(&code[at + climb.len()..], &mut vec![], &mut paths);
            found.extend(paths.into_iter().map(|p| (line, p)));
        }
    }
    found
}

/// Reads a path or use-tree (`a::b`, `{a, b::{c, d}}`) and returns what is left after it.
fn tree<'a>(text: &'a str, prefix: &mut Vec<String>, paths: &mut Vec<Vec<String>>) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = tree(rest, prefix, paths).trim_start();
            if let Some(more) = rest.strip_prefix(',') {
                rest = more.trim_start();
            }
            if let Some(after) = rest.strip_prefix('}') {
                return after;
            }
            if rest.is_empty() {
                return rest;
            }
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_' && c != '*').unwrap_or(text.len());
    if end == 0 {
        // Not a path: step over the character so that reading a tree always ends.
        return text.get(1..).unwrap_or("");
    }
    prefix.push(text[..end].to_string());
    let rest = match text[end..].strip_prefix("::") {
        Some(more) => tree(more, prefix, paths),
        None => {
            paths.push(prefix.clone());
            let rest = &text[end..];
            match rest.trim_start().strip_prefix("as ") {
                Some(alias) => {
                    alias.trim_start().trim_start_matches(|c: char| c.is_alphanumeric() || c == '_')
                }
                None => rest,
            }
        }
    };
    prefix.pop();
    rest
}

/// The text with comments, string and character literals blanked and line breaks kept.
fn without_comments_and_strings(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '/' if chars.peek() == Some(&'/') => while chars.next_if(|&c| c != '\n').is_some() {},
            '"' => {
                while let Some(c) = chars.next() {
                    match c {
                        '\\' => drop(chars.next()),
                        '"' => break,
                        '\n' => out.push('\n'),
                        _ => {}
                    }
                }
            }
            '\'' if chars.peek() == Some(&'"') => drop(chars.next()),
            '\'' if chars.peek() == Some(&'\\') => drop((chars.next(), chars.next())),
            c => out.push(c),
        }
    }
    out
}

#[test]
fn imports_are_found_however_they_are_written() {
    let text = "use crate::{diag::{self, Span}, world as w};\nfn f() { crate::par::run(\"crate::no\") } // crate::no\n\
                use super::super::neigh::list;\n#[cfg(test)]\nmod tests { use crate::no; }";
    let found: Vec<String> =
        imports(text, 2).iter().map(|(line, p)| format!("{line} {}", p.join("::"))).collect();
    assert_eq!(found, ["1 diag::self", "1 diag::Span", "1 world", "2 par::run", "3 neigh::list"]);
}
