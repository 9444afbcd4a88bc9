//! Plain English: words that make persons of things are refused in comments, strings and pages.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Words, and pairs of words, that plain technical English does not need. A phrase counts only where nothing but space
/// stands between its words.
const REFUSED: &[&str] = &[
    "who",
    "whom",
    "nobody",
    "somebody",
    "everybody",
    "anybody",
    "told",
    "tell",
    "tells",
    "telling",
    "asks",
    "welcome",
    "knows of",
    "know of",
    "hang on",
    "hangs on",
    "hung on",
    "go on",
    "goes on",
    "gone on",
    "going on",
    "went on",
    "work off",
    "works off",
    "worked off",
    "working off",
];

/// Lines that may keep a refused word: the file, and a part of the line (at most 40 of them).
const EXCEPTIONS: &[(&str, &str)] = &[];

/// Offenders that each part of the tree may still have.
const REMAINING: &[(&str, usize)] = &[
    ("CHANGELOG.md", 70),
    ("CONTRIBUTING.md", 4),
    ("README.md", 3),
    ("crates/base", 43),
    ("crates/bonded", 37),
    ("crates/comm", 3),
    ("crates/commands", 81),
    ("crates/computes", 36),
    ("crates/contact", 71),
    ("crates/dumps", 6),
    ("crates/fixes", 102),
    ("crates/lang", 44),
    ("crates/mesh", 1),
    ("crates/neigh", 2),
    ("crates/output", 29),
    ("crates/pairs", 43),
    ("crates/peri", 34),
    ("crates/plan", 91),
    ("crates/py", 30),
    ("crates/styles", 48),
    ("crates/world", 77),
    ("docs", 317),
    ("fuzz", 4),
    ("src", 338),
    ("tests", 82),
];

#[test]
fn comments_strings_and_pages_use_plain_words() {
    let (mut counts, mut found) = (BTreeMap::<String, usize>::new(), String::new());
    let mut used = vec![false; EXCEPTIONS.len()];
    for path in files() {
        let name = path.strip_prefix(root()).unwrap().to_str().unwrap().to_string();
        let text = fs::read_to_string(&path).unwrap();
        let pieces = if name.ends_with(".rs") { rust_prose(&text) } else { vec![text.as_str()] };
        for piece in pieces {
            let from = piece.as_ptr() as usize - text.as_ptr() as usize;
            for (at, word) in offenders(piece) {
                let start = text[..from + at].rfind('\n').map_or(0, |end| end + 1);
                let line = text[start..].lines().next().unwrap_or("");
                let exception =
                    EXCEPTIONS.iter().position(|(file, part)| *file == name && line.contains(part));
                if let Some(k) = exception {
                    used[k] = true;
                    continue;
                }
                *counts.entry(area(&name)).or_default() += 1;
                let number = 1 + text[..start].matches('\n').count();
                writeln!(found, "{name}:{number}: \"{word}\": {}", line.trim()).unwrap();
            }
        }
    }
    println!("{found}{counts:#?}");
    let allowed = |area: &str| REMAINING.iter().find(|(name, _)| *name == area).map_or(0, |(_, n)| *n);
    let over: Vec<_> = counts.iter().filter(|(area, n)| **n > allowed(area)).collect();
    assert!(over.is_empty(), "words that are not plain English: {over:?}\n{found}");
    let unused: Vec<_> = EXCEPTIONS.iter().zip(used).filter(|(_, used)| !used).map(|(e, _)| e).collect();
    assert!(unused.is_empty(), "exceptions without a line: {unused:?}");
    assert!(EXCEPTIONS.len() <= 40, "{} exceptions, 40 at most", EXCEPTIONS.len());
}

#[test]
fn the_scanner_finds_words_where_they_stand() {
    let code = "//! Who.\nlet a = \"told\"; // it goes\n/* goes. On */ let b = r#\"tell \"us\"\"#; let c = 'w';\n\
                /// goes\n/// on\nfn who<'a>() { b\"asks\\\"\" }";
    let words: Vec<&str> = rust_prose(code).into_iter().flat_map(offenders).map(|(_, word)| word).collect();
    assert_eq!(words, ["who", "told", "tell", "goes on", "asks"]);
    assert!(offenders("whoever wholesale retells bytellers, goes, on").is_empty());
}

/// The comments and string literals of Rust code; consecutive lines of comments are one piece.
fn rust_prose(text: &str) -> Vec<&str> {
    let bytes = text.as_bytes();
    let (mut pieces, mut k) = (Vec::<(usize, usize)>::new(), 0);
    while k < bytes.len() {
        let rest = &text[k..];
        let name = k > 0 && (bytes[k - 1].is_ascii_alphanumeric() || bytes[k - 1] == b'_');
        let (end, prose) = if rest.starts_with("//") {
            (k + rest.find('\n').unwrap_or(rest.len()), true)
        } else if rest.starts_with("/*") {
            (k + rest.find("*/").map_or(rest.len(), |end| end + 2), true)
        } else if let Some(length) = raw_string(rest).filter(|_| !name) {
            (k + length, true)
        } else if rest.starts_with('"') {
            (k + plain_string(rest), true)
        } else if let Some(length) = character(rest) {
            (k + length, false)
        } else {
            (k + rest.chars().next().map_or(1, char::len_utf8), false)
        };
        if prose {
            match pieces
                .last_mut()
                .filter(|last| comments_that_join(&text[last.0..last.1], &text[last.1..k], rest))
            {
                Some(last) => last.1 = end,
                None => pieces.push((k, end)),
            }
        }
        k = end;
    }
    pieces.into_iter().map(|(from, end)| &text[from..end]).collect()
}

/// Whether a line comment continues the comment of the line before it.
fn comments_that_join(last: &str, between: &str, next: &str) -> bool {
    last.starts_with("//")
        && next.starts_with("//")
        && between.trim().is_empty()
        && between.matches('\n').count() == 1
}

/// The length of the raw string that the text begins with.
fn raw_string(text: &str) -> Option<usize> {
    let after = text.strip_prefix('b').unwrap_or(text).strip_prefix('r')?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let length = body.find(&end)? + end.len();
    Some(text.len() - body.len() + length)
}

/// The length of the string that the text begins with.
fn plain_string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// The length of the character literal that the text begins with; a lifetime is none.
fn character(text: &str) -> Option<usize> {
    let body = text.strip_prefix('\'')?;
    let mut chars = body.char_indices();
    let (_, first) = chars.next()?;
    if first == '\\' {
        let (second, _) = chars.next()?;
        return Some(2 + second + body[second + 1..].find('\'')? + 1);
    }
    let (second, c) = chars.next()?;
    (c == '\'').then_some(1 + second + 1)
}

/// The refused words of a text with their places.
fn offenders(text: &str) -> Vec<(usize, &'static str)> {
    let words = words(text);
    let mut found = vec![];
    for (k, (at, word)) in words.iter().enumerate() {
        let next = words.get(k + 1).filter(|(to, _)| only_space(&text[at + word.len()..*to]));
        let pair = next.map(|(_, next)| format!("{word} {next}").to_lowercase());
        let word = word.to_lowercase();
        let refused = REFUSED.iter().find(|refused| **refused == word || Some(**refused) == pair.as_deref());
        found.extend(refused.map(|refused| (*at, *refused)));
    }
    found
}

/// The words of a text, that is runs of letters, digits and `_`, with their places.
fn words(text: &str) -> Vec<(usize, &str)> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = vec![];
    let mut from = None;
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match from {
            None if part(c) => from = Some(at),
            Some(start) if !part(c) => {
                found.push((start, &text[start..at]));
                from = None;
            }
            _ => {}
        }
    }
    found
}

/// Whether two words are neighbours: between them stand only space, the start of a comment line or a line that is continued.
fn only_space(between: &str) -> bool {
    between.chars().all(|c| c.is_whitespace() || "/!\\>".contains(c))
}

/// The part of the tree that a file is counted for: a crate, or a folder at the root.
fn area(name: &str) -> String {
    let parts: Vec<&str> = name.split('/').collect();
    if parts[0] == "crates" { parts[..2].join("/") } else { parts[0].to_string() }
}

/// All Rust files, the pages of `docs` and the pages at the root, sorted.
fn files() -> Vec<PathBuf> {
    let mut found = vec![];
    let mut folders: Vec<PathBuf> =
        ["src", "crates", "tests", "benches", "fuzz", "docs"].iter().map(|name| root().join(name)).collect();
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs" || e == "md") {
                found.push(path);
            }
        }
    }
    found.extend(["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    // The list of refused words stands in this file.
    found.retain(|path| !path.ends_with("tests/english.rs"));
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
