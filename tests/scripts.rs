//! Small decks, one idea each: good ones print what they promise, bad ones are refused with the right word underlined.
//!
//! A file in `tests/scripts/{good,bad}` holds blocks that open with `--- name`. Lines that begin with `# error:`,
//! `# run error:`, `# warning:`, `# help:`, `# print:` or `# not:` (no printed line holds this) are expectations about the deck line above them:
//!
//! ```text
//! pair_sytle peri/pmb
//! # error: 1-10 unknown command `pair_sytle`
//! # help: pair_style
//! ```
//!
//! A line `@scene` stands for the lines of `tests/scripts/scene.in`, a small block of particles ready to run.
//! `1-10` are the underlined columns, the rest is a part of the message; without columns no place is expected.
//! `error` is found by `perigrain check` too, `run error` only while the deck runs, `check warning` by `check` alone (`tests/checks.rs`).

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

const SCENE: &str = include_str!("scripts/scene.in");

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Error,
    RunError,
    Warning,
}

/// What a block expects at one of its lines.
#[derive(Debug)]
struct Expected {
    kind: Kind,
    line: usize,
    columns: Option<(usize, usize)>,
    part: String,
    help: Vec<String>,
}

/// One message as it was printed.
#[derive(Debug, Default)]
struct Message {
    severity: String,
    text: String,
    line: usize,
    columns: Option<(usize, usize)>,
    help: Vec<String>,
}

struct Block {
    name: String,
    deck: String,
    expected: Vec<Expected>,
    prints: Vec<String>,
    never: Vec<String>,
}

#[test]
fn bad_decks_are_refused() {
    each("bad", |block| {
        let (code, printed, left) = perigrain(&["-in", "in.deck", "-log", "log.deck"], &block.deck);
        let printed = messages(&printed.1);
        let wanted: Vec<&Expected> = block.expected.iter().filter(|e| e.kind != Kind::Warning).collect();
        let errors: Vec<&Message> = printed.iter().filter(|m| m.severity == "error").collect();
        let mut report = String::new();
        if code != Some(1) {
            let _ = writeln!(report, "  run: exit code {code:?}, not 1");
        }
        match (wanted.first(), errors.first()) {
            (Some(w), Some(e)) if !fits(w, e) => {
                let _ = writeln!(report, "  run: wanted {w:?}\n       printed {e:?}");
            }
            (Some(w), None) => {
                let _ = writeln!(report, "  run: wanted {w:?}, printed no error");
            }
            (None, _) => {
                let _ = writeln!(report, "  a bad deck without an expected error");
            }
            _ => {}
        }
        // a deck may print files for its own later lines
        let left: Vec<_> =
            left.iter().filter(|name| !block.deck.contains(&format!("file {name} screen no"))).collect();
        if !left.is_empty() {
            let _ = writeln!(report, "  run: left behind {left:?}");
        }

        let (code, printed, left) = perigrain(&["check", "in.deck"], &block.deck);
        let printed = messages(&printed.1);
        let refused = block.expected.iter().any(|e| e.kind == Kind::Error);
        if code != Some(i32::from(refused)) {
            let _ = writeln!(report, "  check: exit code {code:?}, not {}", i32::from(refused));
        }
        report += &unmatched("check", &printed, &block.expected, Kind::Error, "error");
        report += &missing("check", &printed, &block.expected, Kind::Warning, "warning");
        if !left.is_empty() {
            let _ = writeln!(report, "  check: left behind {left:?}");
        }
        report
    });
}

#[test]
fn good_decks_run_and_print_what_they_promise() {
    each("good", |block| {
        let (code, (out, err), _) = perigrain(&["-in", "in.deck", "-log", "none"], &block.deck);
        let mut report = String::new();
        if code != Some(0) {
            let _ = writeln!(report, "  exit code {code:?}:\n{err}");
        }
        let printed = messages(&err);
        report += &unmatched("run", &printed, &block.expected, Kind::Warning, "warning");
        // in the order of the expectations, other lines between them
        let mut printed = out.lines();
        for line in &block.prints {
            if !printed.any(|l| l.trim_end() == line) {
                let _ = writeln!(report, "  does not print {line:?} here; it prints\n{out}");
                break;
            }
        }
        for line in out.lines().filter(|l| block.never.iter().any(|part| l.contains(part.as_str()))) {
            let _ = writeln!(report, "  prints {line:?}, which it should not");
        }
        report
    });
}

/// Runs `test` on every block of a folder, several at a time, and fails with all reports together.
fn each(folder: &str, test: impl Fn(&Block) -> String + Sync) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts").join(folder);
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let mut todo = vec![];
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let found = blocks(&fs::read_to_string(&file).unwrap());
        todo.extend(found.into_iter().map(|block| (name.clone(), block)));
    }
    let count = todo.len();
    let next = AtomicUsize::new(0);
    let reports: Mutex<BTreeMap<usize, String>> = Mutex::default();
    let work = || {
        while let Some((k, (file, block))) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, todo.get(k)?)))
        {
            let report = test(block);
            if !report.is_empty() {
                reports.lock().unwrap().insert(k, format!("{file}, {}:\n{report}\n", block.name));
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|s| (0..threads).for_each(|_| drop(s.spawn(work))));
    let failed: String = reports.into_inner().unwrap().into_values().collect();
    println!("{count} decks");
    assert!(failed.is_empty(), "\n{failed}");
}

fn blocks(text: &str) -> Vec<Block> {
    let mut found: Vec<Block> = vec![];
    let (mut number, mut above) = (0, 0);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("--- ") {
            let name = name.trim().to_string();
            found.push(Block { name, deck: String::new(), expected: vec![], prints: vec![], never: vec![] });
            (number, above) = (0, 0);
            continue;
        }
        let Some(block) = found.last_mut() else { continue };
        let line = if line == "@scene" { SCENE.trim_end() } else { line };
        number += line.lines().count().max(1);
        let _ = writeln!(block.deck, "{line}");
        let kind =
            [("# error: ", Kind::Error), ("# run error: ", Kind::RunError), ("# warning: ", Kind::Warning)]
                .into_iter()
                .find_map(|(prefix, kind)| Some((kind, line.strip_prefix(prefix)?)));
        if let Some((kind, rest)) = kind {
            let (columns, part) = match rest.split_once(' ') {
                Some((first, part)) => (columns(first), if columns(first).is_some() { part } else { rest }),
                None => (None, rest),
            };
            block.expected.push(Expected { kind, line: above, columns, part: part.into(), help: vec![] });
        } else if let Some(help) = line.strip_prefix("# help: ") {
            block.expected.last_mut().expect("help follows an error").help.push(help.into());
        } else if let Some(part) = line.strip_prefix("# not: ") {
            block.never.push(part.into());
        } else if let Some(print) = line.strip_prefix("# print: ") {
            block.prints.push(print.into());
        } else {
            above = number;
        }
    }
    found
}

fn columns(word: &str) -> Option<(usize, usize)> {
    let (from, to) = word.split_once('-')?;
    Some((from.parse().ok()?, to.parse().ok()?))
}

/// Runs the program in a folder of its own; exit code, (stdout, stderr), files left beside deck and log.
fn perigrain(args: &[&str], deck: &str) -> (Option<i32>, (String, String), Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(args)
        .args(["-threads", "1"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let left = fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name != "in.deck" && name != "log.deck")
        .collect();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), (text(&output.stdout), text(&output.stderr)), left)
}

/// Reads rendered diagnostics back: header, place, underlined columns, help.
fn messages(text: &str) -> Vec<Message> {
    let mut found: Vec<Message> = vec![];
    for line in text.lines() {
        let header = ["error[", "warning[", "note["].iter().find_map(|h| line.strip_prefix(h).map(|_| h));
        if let Some(header) = header {
            let severity = header.trim_end_matches('[').to_string();
            let text = line.split_once("]: ").map_or("", |p| p.1).to_string();
            found.push(Message { severity, text, ..Message::default() });
        }
        let Some(message) = found.last_mut() else { continue };
        let trimmed = line.trim_start();
        if let Some(place) = trimmed.strip_prefix("--> ") {
            message.line = place.rsplit(':').nth(1).and_then(|l| l.parse().ok()).unwrap_or(0);
        } else if let Some(help) = trimmed.strip_prefix("= help: ") {
            message.help.push(help.to_string());
        } else if let (Some((_, under)), None) = (trimmed.split_once("| "), message.columns)
            && trimmed.starts_with('|')
            && under.trim_start().starts_with('^')
        {
            let from = under.len() - under.trim_start().len() + 1;
            let carets = under.trim_start().chars().take_while(|&c| c == '^').count();
            message.columns = Some((from, from + carets - 1));
        }
    }
    found
}

fn fits(expected: &Expected, message: &Message) -> bool {
    let here =
        expected.columns.is_none() || (message.columns == expected.columns && message.line == expected.line);
    here && message.text.contains(&expected.part)
        && expected.help.iter().all(|h| message.help.iter().any(|m| m.contains(h)))
}

/// Expected messages that were not printed, and printed ones that were not expected.
fn unmatched(what: &str, printed: &[Message], expected: &[Expected], kind: Kind, severity: &str) -> String {
    let mut report = missing(what, printed, expected, kind, severity);
    for m in printed.iter().filter(|m| m.severity == severity) {
        if !expected.iter().any(|e| e.kind == kind && fits(e, m)) {
            let _ = writeln!(report, "  {what}: not expected: {m:?}");
        }
    }
    report
}

fn missing(what: &str, printed: &[Message], expected: &[Expected], kind: Kind, severity: &str) -> String {
    let mut report = String::new();
    for e in expected.iter().filter(|e| e.kind == kind) {
        if !printed.iter().any(|m| m.severity == severity && fits(e, m)) {
            let near = printed.iter().find(|m| m.line == e.line);
            let _ = writeln!(report, "  {what}: wanted {e:?}\n       at that line: {near:?}");
        }
    }
    report
}

#[test]
fn expectations_and_messages_are_read() {
    let found = blocks(
        "--- a\nunits si\npair_sytle x\n# error: 1-10 unknown\n# help: pair_style\n# warning: odd\n--- b\n",
    );
    assert_eq!(found.len(), 2);
    let e = &found[0].expected[0];
    assert_eq!((e.line, e.columns, e.part.as_str()), (2, Some((1, 10)), "unknown"));
    assert_eq!((found[0].expected[1].line, found[0].expected[1].columns), (2, None));
    let m = messages(
        "error[PG0102]: unknown command\n  --> in.deck:2:1\n  |\n2 | pair_sytle x\n  | ^^^^^^^^^^\n  |\n  = help: did you mean `pair_style`?\n",
    );
    assert!(fits(e, &m[0]), "{m:?}");
}
