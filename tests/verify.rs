//! The program's own verification: quick cases by the real binary, its reports and exit codes, and the page of the manual.

use perigrain::verify::DECKS;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn verify(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .arg("verify")
        .args(args)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn out(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

/// What is behind one JSON value; fails where there is none.
fn behind(text: &str) -> &str {
    let text = text.trim_start();
    let ends = match text.as_bytes()[0] {
        b'{' => return members(&text[1..], '}'),
        b'[' => return members(&text[1..], ']'),
        b'"' => {
            let inner = &text[1..];
            let escaped = |at: usize| inner[..at].bytes().rev().take_while(|b| *b == b'\\').count() % 2 == 1;
            let end = inner.match_indices('"').map(|(at, _)| at).find(|at| !escaped(*at)).unwrap();
            assert!(!inner[..end].contains(|c: char| c < ' '), "{inner}");
            return &inner[end + 1..];
        }
        _ => text.find([',', '}', ']']).unwrap_or(text.len()),
    };
    let word = text[..ends].trim();
    assert!(["true", "false", "null"].contains(&word) || word.parse::<f64>().is_ok(), "`{word}` is no value");
    &text[ends..]
}

/// What is behind the members of an object or an array.
fn members(mut rest: &str, close: char) -> &str {
    rest = rest.trim_start();
    if let Some(rest) = rest.strip_prefix(close) {
        return rest;
    }
    loop {
        if close == '}' {
            assert!(rest.trim_start().starts_with('"'), "{rest}");
            rest = behind(rest).trim_start().strip_prefix(':').unwrap();
        }
        rest = behind(rest).trim_start();
        match rest.strip_prefix(',') {
            Some(more) => rest = more,
            None => return rest.strip_prefix(close).unwrap(),
        }
    }
}

#[test]
fn quick_cases_pass_and_are_reported_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let reports = "-json a.json -junit a.xml -html a.html -markdown a.md -threads 2";
    let args = |only| ["-only", only].into_iter().chain(reports.split(' ')).collect::<Vec<&str>>();
    let o = verify(folder.path(), &args("one_bond"));
    assert_eq!(o.status.code(), Some(0), "{}", out(&o));
    assert!(
        out(&o).contains("  passed          stretch: tension: 5.026548 for 5.026548 N, off by"),
        "{}",
        out(&o)
    );
    assert!(out(&o).contains("9 checks of 1 cases: 9 passed, 0 known deviations, 0 failed"), "{}", out(&o));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let json = read("a.json");
    assert_eq!(behind(&json).trim(), "", "{json}");
    assert!(json.contains("\"passed\": 9, \"known\": 0, \"failed\": 0"), "{json}");
    assert_eq!(read("a.xml").matches("<testcase ").count(), 9);
    assert!(read("a.html").contains("<h3>One beam bond"));
    assert!(read("a.md").contains("### One beam bond"));
    // A case with curves, and with a deviation that is known and does not fail.
    let o = verify(folder.path(), &args("cattaneo"));
    assert_eq!(o.status.code(), Some(0), "{}", out(&o));
    assert!(out(&o).contains("known deviation friction on the way"), "{}", out(&o));
    assert_eq!(behind(&read("a.json")).trim(), "");
    assert!(read("a.html").contains("<svg") && read("a.xml").contains("<skipped message="));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4, "the reports alone");
}

#[test]
fn cases_are_listed_chosen_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let all = out(&verify(folder.path(), &["-list"]));
    assert_eq!(all.lines().count(), DECKS.len());
    let some = out(&verify(folder.path(), &["-list", "-only", "Chung and Ooi"]));
    assert_eq!(some.lines().count(), 8, "{some}");
    let deck = out(&verify(folder.path(), &["-deck", "-only", "cattaneo"]));
    assert_eq!(deck, DECKS.iter().find(|d| d.0.contains("cattaneo")).unwrap().1);
    let o = verify(folder.path(), &["-only", "chung_oui_1"]);
    let printed = String::from_utf8_lossy(&o.stderr).into_owned();
    assert_eq!(o.status.code(), Some(2));
    assert!(
        printed.contains("no case has `chung_oui_1`") && printed.contains("did you mean `chung_ooi_1`?"),
        "{printed}"
    );
    assert_eq!(
        verify(folder.path(), &["-only", "cattaneo", "-json", "no/such/folder"]).status.code(),
        Some(2)
    );
}

#[test]
fn the_page_has_every_case() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/verification.md");
    let page = fs::read_to_string(page).unwrap();
    let missing: Vec<&str> =
        DECKS.iter().map(|d| d.0).filter(|name| !page.contains(&format!("(`{name}`, "))).collect();
    assert!(
        missing.is_empty(),
        "`perigrain verify -markdown docs/verification.md` writes it anew: {missing:?}"
    );
}
