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

/// Parts of identifiers that are refused: names use the terms of the field and of programming.
const REFUSED_NAMES: &[&str] = &[
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
    "said",
    "says",
    "welcome",
];

/// Lines that may keep a refused word: the file, and a part of the line (at most 40 of them).
const EXCEPTIONS: &[(&str, &str)] = &[];

#[test]
fn comments_strings_and_pages_use_plain_words() {
    let mut found = String::new();
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
                let number = 1 + text[..start].matches('\n').count();
                writeln!(found, "{name}:{number}: \"{word}\": {}", line.trim()).unwrap();
            }
        }
    }
    assert!(found.is_empty(), "words that are not plain English:\n{found}");
    let unused: Vec<_> = EXCEPTIONS.iter().zip(used).filter(|(_, used)| !used).map(|(e, _)| e).collect();
    assert!(unused.is_empty(), "exceptions without a line: {unused:?}");
    assert!(EXCEPTIONS.len() <= 40, "{} exceptions, 40 at most", EXCEPTIONS.len());
}

#[test]
fn names_use_plain_words() {
    let mut found = BTreeMap::<String, usize>::new();
    for path in files().iter().filter(|path| path.extension().is_some_and(|e| e == "rs")) {
        let name = path.strip_prefix(root()).unwrap().to_str().unwrap();
        let text = fs::read_to_string(path).unwrap();
        for word in rust_names(&text) {
            let parts = parts(word);
            if REFUSED_NAMES.iter().any(|refused| parts.iter().any(|part| part == refused)) {
                *found.entry(format!("{name}: `{word}`")).or_default() += 1;
            }
        }
    }
    assert!(found.is_empty(), "names that are not plain English: {found:#?}");
}

#[test]
fn the_scanner_finds_words_where_they_stand() {
    let code = "//! Who.\nlet a = \"told\"; // it goes\n/* goes. On */ let b = r#\"tell \"us\"\"#; let c = 'w';\n\
                /// goes\n/// on\nfn who<'a>() { b\"asks\\\"\" }";
    let words: Vec<&str> = rust_prose(code).into_iter().flat_map(offenders).map(|(_, word)| word).collect();
    assert_eq!(words, ["who", "told", "tell", "goes on", "asks"]);
    assert_eq!(rust_names(code).join(" "), "let a let b let c fn who a b");
    assert_eq!(parts("told_WhoAsks2"), ["told", "who", "asks2"]);
    assert!(offenders("whoever wholesale retells bytellers, goes, on").is_empty());
}

/// The comments and string literals of Rust code; consecutive lines of comments are one piece.
fn rust_prose(text: &str) -> Vec<&str> {
    let [prose, _] = split(text);
    prose
}

/// The identifiers and keywords of Rust code outside comments and strings.
fn rust_names(text: &str) -> Vec<&str> {
    let [_, code] = split(text);
    let code = code.into_iter().flat_map(words).map(|(_, word)| word);
    code.filter(|word| !word.starts_with(|c: char| c.is_ascii_digit())).collect()
}

/// The parts of a name between underscores and before capitals, in lower case.
fn parts(name: &str) -> Vec<String> {
    let mut spaced = String::new();
    let mut before = '_';
    for c in name.chars() {
        if c.is_uppercase() && before.is_lowercase() {
            spaced.push('_');
        }
        spaced.extend(c.to_lowercase());
        before = c;
    }
    spaced.split('_').filter(|part| !part.is_empty()).map(String::from).collect()
}

/// Splits Rust code into its prose (comments, string literals) and the code between.
fn split(text: &str) -> [Vec<&str>; 2] {
    let (mut prose, mut code) = (Vec::<(usize, usize)>::new(), vec![]);
    let (mut k, mut code_from) = (0, 0);
    while k < text.len() {
        let (length, is_prose) = token(&text[..k], &text[k..]);
        let end = k + length;
        if is_prose.is_some() {
            code.push(&text[code_from..k]);
            code_from = end;
        }
        if is_prose == Some(true) {
            match prose.last_mut().filter(|last| comments_join(&text[last.0..k], &text[k..])) {
                Some(last) => last.1 = end,
                None => prose.push((k, end)),
            }
        }
        k = end;
    }
    code.push(&text[code_from..]);
    [prose.into_iter().map(|(from, end)| &text[from..end]).collect(), code]
}

/// The length of what a text begins with, and whether it is prose or (`Some(false)`) a character literal; `None` for one
/// character of code.
fn token(before: &str, text: &str) -> (usize, Option<bool>) {
    let in_name = before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    if text.starts_with("//") {
        (text.find('\n').unwrap_or(text.len()), Some(true))
    } else if text.starts_with("/*") {
        (text.find("*/").map_or(text.len(), |end| end + 2), Some(true))
    } else if let Some(length) = raw_string(text).filter(|_| !in_name) {
        (length, Some(true))
    } else if text.starts_with('"') {
        (plain_string(text), Some(true))
    } else if let Some(length) = character(text) {
        (length, Some(false))
    } else {
        (text.chars().next().map_or(1, char::len_utf8), None)
    }
}

/// Whether the line comment at the beginning of `next` continues the prose `last`, the comment of the line before.
fn comments_join(last: &str, next: &str) -> bool {
    let gap = last.len() - last.trim_end().len();
    last.starts_with("//") && next.starts_with("//") && last[last.len() - gap..].matches('\n').count() == 1
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

/// All Rust files, the pages of `docs` and the pages at the root, sorted.
fn files() -> Vec<PathBuf> {
    let mut found = vec![];
    let mut folders: Vec<PathBuf> = ["src", "crates", "tests", "benches", "fuzz", "docs", "examples"]
        .iter()
        .map(|name| root().join(name))
        .collect();
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
    // These two list refused words.
    found.retain(|path| !path.ends_with("tests/english.rs") && !path.ends_with("docs/decisions/names.md"));
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
