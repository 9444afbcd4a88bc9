//! The words of lines: each declared keyword is read, and each word that decks use is declared.

use crate::scene::{Folder, deck, hosted, is_for_the_shell};
use perigrain::cli::manual::{Page, pages};
use perigrain::diag::{Code, Diagnostic, FileId, Severity};
use perigrain::lang::{RawLine, raw_lines};
use perigrain::manual::knowing::strays;
use perigrain::manual::syntax::is_word;
use perigrain::manual::walk::Declared;
use perigrain::session::{Known, Mode, Options, Session};
use perigrain::styles::words::{Kind, Part, Syntax};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Pages of commands whose lines are written by hand, each with the reason.
const WRITTEN: &[(&str, &str)] = &[
    ("variable", "the language reads it, below the crate of words; formulas are one word or several"),
    ("if", "the language reads it: commands in quotes, branches in any number"),
    ("label", "the language reads it before values are put in"),
    ("jump", "the language reads it"),
    ("next", "the language reads it"),
    ("include", "the language reads it"),
    ("quit", "the language reads it"),
    ("shell", "whatever does not begin with one of its words is a line for the system's shell"),
    ("balance", "axes with uniform cuts or places may follow each other; without effect here"),
];

/// The material that made-up lines name.
const GLASS: &str = "material glass E 72e9 nu 0.25 rho 2235 Gc 10\n";

/// A word that a place may take.
fn fitting(kind: Kind) -> Vec<String> {
    let word = match kind {
        Kind::Number | Kind::Param => "0.5",
        Kind::Whole => "2",
        Kind::Switch => "yes",
        Kind::Types => "1",
        Kind::Text => "text",
        Kind::Group => "all",
        Kind::Region => "half",
        Kind::Compute => "dmg",
        Kind::Fix => "motion",
        Kind::Dump => "1",
        Kind::Variable => "speed",
        Kind::Molecule => "mol",
        Kind::Material => "glass",
        Kind::File => "some.file",
        Kind::Value | Kind::Reference => "v_speed",
        Kind::Attribute => "vx",
        Kind::Column => "step",
        Kind::Style(_) => "none",
        Kind::Choice(all) | Kind::Models(all) => {
            let Some(first) = all.first() else { return vec![] };
            return std::iter::once(first.word.to_string()).chain(filled(first.parts)).collect();
        }
        Kind::Words(grammar) => return grammar.in_order().into_iter().flat_map(|p| filled(&[*p])).collect(),
        Kind::OrNull(inner) => return fitting(*inner),
        Kind::Or(first, _) => return fitting(*first),
    };
    vec![word.to_string()]
}

/// The fewest words that may stand in order.
fn filled(parts: &[Part]) -> Vec<String> {
    parts
        .iter()
        .flat_map(|part| match part {
            Part::Word(place) => fitting(place.kind),
            Part::Maybe(_) => vec![],
            Part::Many(inner, least) => (0..*least.max(&1)).flat_map(|_| filled(inner)).collect(),
            Part::All(grammar) => grammar.in_order().into_iter().flat_map(|p| filled(&[*p])).collect(),
        })
        .collect()
}

fn texts(line: &RawLine) -> Vec<&str> {
    line.words.iter().map(|word| word.text.as_str()).collect()
}

/// The last line of a deck that has a form, up to its end, and where it begins.
fn base(deck: &str, form: &Declared) -> Option<(String, usize)> {
    let fits = |line: &&RawLine| {
        let words = texts(line);
        words.len() >= form.head().len()
            && form.head().iter().zip(words).all(|(head, word)| !is_word(head) || head == word)
    };
    let lines = raw_lines(deck, FileId(0));
    let line = lines.iter().rfind(fits)?;
    let last = line.words.last()?;
    let end = last.span.end as usize
        + usize::from(last.quoted && deck[last.span.end as usize..].starts_with(['"', '\'']));
    Some((deck[..end].to_string(), line.words[0].span.start as usize))
}

/// The ID of the last fix or dump of a deck, for `fix_modify` and `dump_modify`.
fn last_id(deck: &str, modify: &str) -> String {
    let kind = modify.trim_end_matches("_modify");
    let lines = raw_lines(deck, FileId(0));
    let last = lines.iter().map(texts).rfind(|words| words[0] == kind).map(|words| words[1].to_string());
    last.unwrap_or_else(|| "1".to_string())
}

/// A deck that ends with a line of a form, made up where the example has none.
fn based(page: &Page, form: &Declared) -> (String, usize) {
    let deck = deck(&page.title(), page.doc.example);
    base(&deck, form).unwrap_or_else(|| {
        let (first, others) = form.head().split_first().unwrap();
        let head = others.iter().map(|word| match word.as_str() {
            "ID" if first.ends_with("_modify") => last_id(&deck, first),
            "ID" => "made_up".to_string(),
            "group" => "all".to_string(),
            "N" => "2".to_string(),
            "I" | "J" | "T" | "TYPE" => "1".to_string(),
            word => word.to_string(),
        });
        let parts = form.grammar().in_order().into_iter().flat_map(|part| filled(&[*part]));
        let words: Vec<String> = std::iter::once(first.clone()).chain(head).chain(parts).collect();
        let deck = deck.clone() + if words.iter().any(|word| word == "material") { GLASS } else { "" };
        (format!("{deck}{}", words.join(" ")), deck.len())
    })
}

/// The mistakes that a check of a deck finds at or behind a byte.
fn mistakes(name: &str, deck: &str, from: usize) -> Vec<Diagnostic> {
    let mut session = hosted(Session::new(Options { mode: Mode::Check, ..Options::default() }).unwrap());
    let found = session.run_text(name, deck).err().map_or(vec![], |all| all.0);
    let here = |d: &Diagnostic| d.span.is_some_and(|span| span.start as usize >= from);
    found.into_iter().filter(|d| d.severity == Severity::Error && here(d)).collect()
}

#[test]
fn each_declared_keyword_is_read() {
    let _folder = Folder::new(super::folder());
    let (mut read, mut hidden, mut wrong) = (0, vec![], String::new());
    // Lines of `dump_modify` and the like for one style are read behind the example of that style.
    let styles = pages().into_iter().filter(|p| p.kind != "command");
    let of_styles: Vec<String> = styles.flat_map(|p| p.declared()).map(|form| form.line()).collect();
    for page in pages().iter().filter(|p| !is_for_the_shell(p) && p.kind != "topic") {
        for form in
            page.declared().iter().filter(|form| page.kind != "command" || !of_styles.contains(&form.line()))
        {
            let (base, start) = based(page, form);
            let line: Vec<&str> = base[start..].split_whitespace().collect();
            for keyword in form.grammar().every().iter().filter(|k| !line.contains(&k.word)) {
                // The end of a `rerun` line are the words of `read_dump`.
                let end = if page.name == "rerun" {
                    start + base[start..].find(" dump").unwrap()
                } else {
                    base.len()
                };
                let at = end + 1;
                let words = filled(keyword.values).join(" ");
                let deck = format!("{} {} {words}{}\n", &base[..end], keyword.word, &base[end..]);
                let found = mistakes(&page.title(), &deck, start);
                let refuses = |d: &&Diagnostic| {
                    [Code::UNKNOWN_KEYWORD, Code::EXTRA_ARGUMENT].contains(&d.code)
                        && d.span.is_some_and(|span| span.start as usize == at)
                };
                if let Some(d) = found.iter().find(refuses) {
                    let _ = writeln!(
                        wrong,
                        "{}: {} … {}: {}",
                        page.title(),
                        line.join(" "),
                        keyword.word,
                        d.message
                    );
                }
                match found.iter().find(|d| d.span.is_some_and(|span| (span.start as usize) < at)) {
                    Some(d) => hidden.push(format!(
                        "{}: {} {}: {}",
                        page.title(),
                        line.join(" "),
                        keyword.word,
                        d.message
                    )),
                    None => read += 1,
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    // A line that has a mistake for another reason proves nothing.
    assert!(
        read > 750 && hidden.len() < 60,
        "{read} were read; other mistakes hide {}:\n{}",
        hidden.len(),
        hidden.join("\n")
    );
}

/// All decks below a folder.
fn decks(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        // Decks below `checks` have mistakes, too.
        if path.is_dir() && !["bad", "checks"].contains(&name.as_str()) {
            decks(&path, found);
        } else if path.is_file() && (name.starts_with("in.") || name.ends_with(".in")) {
            found.push(path);
        }
    }
}

/// Words that no declaration can have, each with the reason: page, how they begin.
const OPEN: &[(&str, &str)] = &[
    // Properties have the names that `fix property/atom` gives them.
    ("set", "i_"),
    ("set", "d_"),
    ("set", "d2_"),
    // The beginning of a category is enough, as in LAMMPS.
    ("info", "sys"),
];

/// Words of a text that the reading accepts and no declaration has.
fn undeclared(name: &str, text: &str, found: &mut String) -> usize {
    let (mut known, mut style, mut count) = (Known::default(), None, 0);
    for line in raw_lines(text, FileId(0)) {
        let mut words = texts(&line);
        match words.first() {
            Some(&"pair_style") => style = words.get(1).map(|style| (*style).to_string()),
            Some(&"pair_coeff") => match style.as_deref() {
                // The words are those of the sub-style.
                Some("hybrid" | "hybrid/overlay") if words.len() > 3 => {
                    known.pair = Some(words.remove(3).to_string())
                }
                Some(style) if !style.contains('$') => known.pair = Some(style.to_string()),
                _ => continue,
            },
            // Which style the words belong to depends on another line.
            Some(&"bond_coeff") => continue,
            _ => {}
        }
        // How many words a value in the line stands for is open.
        if words.iter().any(|word| word.contains('$')) {
            continue;
        }
        let Some((strays, page)) = strays(&words, &known) else { continue };
        count += 1;
        let open = |word: &str| OPEN.iter().any(|(of, begin)| *of == page.name && word.starts_with(begin));
        if let Some(k) = strays.first().filter(|k| !open(words[**k])) {
            let _ = writeln!(found, "{name}: {}: `{}` in {}", page.title(), words[*k], words.join(" "));
        }
    }
    count
}

#[test]
fn each_word_that_decks_use_is_declared() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![];
    for folder in ["examples", "src/verify/cases", "src/bench/cases", "tests"] {
        decks(&root.join(folder), &mut files);
    }
    let (mut lines, mut found) = (0, String::new());
    for file in &files {
        let text = String::from_utf8_lossy(&fs::read(file).unwrap()).into_owned();
        // Decks of LIGGGHTS have words of their own, which `crates/liggghts` reads.
        if text.lines().any(|line| line.split_whitespace().eq(["atom_style", "granular"])) {
            continue;
        }
        let name = file.strip_prefix(root).unwrap().display().to_string();
        // Files of small decks: each is one by itself.
        lines += format!("\n{text}")
            .split("\n--- ")
            .map(|deck| {
                let begin = deck.find('\n').unwrap_or(deck.len());
                undeclared(&name, &deck[begin..], &mut found)
            })
            .sum::<usize>();
    }
    for page in pages().iter().filter(|p| !is_for_the_shell(p)) {
        lines += undeclared(&page.title(), page.doc.example, &mut found);
    }
    assert!(found.is_empty(), "{found}");
    assert!(lines > 5000, "only {lines} lines");
}

#[test]
fn few_lines_are_written_by_hand() {
    let by_hand = |p: &&Page| matches!(p.doc.syntax, Syntax::Written(_)) && p.kind == "command";
    let pages = pages();
    let names: Vec<&str> = pages.iter().filter(by_hand).map(|p| p.name).collect();
    let open: Vec<&&str> =
        names.iter().filter(|name| !WRITTEN.iter().any(|(known, _)| known == *name)).collect();
    assert!(open.is_empty(), "declare the words of {open:?}");
    let over: Vec<&str> = WRITTEN.iter().map(|w| w.0).filter(|known| !names.contains(known)).collect();
    assert!(over.is_empty(), "{over:?} are declared: they are in the list without need");
    assert!(WRITTEN.len() <= 15);
}
