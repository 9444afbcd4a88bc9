//! The manual on paper is the manual in the program; its decks work.
//! `PERIGRAIN_BLESS=1 cargo test --test folders docs::` writes the pages anew.

use perigrain::cli::errors_page;
use perigrain::cli::grammar::{textmate, vim};
use perigrain::cli::manual::{heading, pages};
use perigrain::diag::{CODES, Code};
use perigrain::output::log::Log;
use perigrain::session::{Mode, Options, Session};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Where the pages lie.
pub fn docs() -> PathBuf {
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
    files.push((docs().join("errors.md"), errors_page()));
    files.push((docs().join("SUMMARY.md"), summary()));
    files.push((docs().join("editor/vscode/perigrain.tmLanguage.json"), textmate()));
    files.push((docs().join("editor/vim/syntax/perigrain.vim"), vim()));
    let house = docs().join("architecture.md");
    files.push((house.clone(), with_code(&fs::read_to_string(house).unwrap())));
    files
}

/// What stands in the book before and behind the pages of commands and styles.
const BOOK: [&str; 2] = [
    "# perigrain\n\n\
     [A short tour](tour.md)\n\n\
     [Gallery](gallery.md)\n\n\
     # How to\n\n\
     - [A first crack in five minutes](howto/first-crack.md)\n\
     - [Find what is wrong with a deck](howto/wrong-deck.md)\n\
     - [Explore at the prompt](howto/prompt.md)\n\
     - [Calibrate to a material](howto/material.md)\n\
     - [A crack from a notch](howto/notch.md)\n\
     - [Load a body slowly](howto/slow.md)\n\
     - [A metal that hardens](howto/metal.md)\n\
     - [Heat and cracks](howto/heat.md)\n\
     - [A ball strikes a plate](howto/impact.md)\n\
     - [Erosion by a stream of grains](howto/erosion.md)\n\
     - [A laminate of unlike plies](howto/laminate.md)\n\
     - [Grains run out of a hopper](howto/hopper.md)\n\
     - [Angle of repose](howto/repose.md)\n\
     - [A rotating drum](howto/drum.md)\n\
     - [Calibrate an agglomerate in five minutes](howto/agglomerate.md)\n\
     - [A body from a mesh, a scan or a table](howto/bodies.md)\n\
     - [Look at a run](howto/report.md)\n\
     - [Make a movie of a crack](howto/movie.md)\n\
     - [Read results in ParaView, OVITO and pandas](howto/results.md)\n\
     - [Make a long run](howto/long-runs.md)\n\
     - [Many cores](howto/cores.md)\n\
     - [On a cluster](howto/cluster.md)\n\
     - [Make many runs of one deck](howto/sweep.md)\n\
     - [Weigh time against error](howto/bench.md)\n\
     - [Drive a run from Python](howto/from-python.md)\n\
     - [The Python module](python.md)\n\
     - [In your editor](editor/README.md)\n\n\
     # Theory\n\n\
     - [What is computed](theory/README.md)\n\
     - [Bond-based peridynamics](theory/bond-based.md)\n\
     - [State-based peridynamics](theory/state-based.md)\n\
     - [Correspondence](theory/correspondence.md)\n\
     - [Bonds that flow or soften](theory/softening.md)\n\
     - [Materials that flow and break](theory/materials.md)\n\
     - [When bonds break](theory/damage-laws.md)\n\
     - [Heat in solids](theory/heat.md)\n\
     - [Contacts: along the normal](theory/contacts.md)\n\
     - [Contacts: friction, rolling and twisting](theory/friction.md)\n\
     - [Powders: plastic and adhesive grains](theory/powders.md)\n\
     - [Surfaces that meet grains](theory/hybrid.md)\n\
     - [Bonded particles](theory/bonds.md)\n\
     - [Time integration](theory/integration.md)\n\
     - [How long may a step be](theory/time-step.md)\n\
     - [Stiffness without a run](theory/calibration.md)\n\n\
     # Reference\n\n\
     - [The language](language.md)\n\
     - [Commands and styles](commands.md)\n",
    "- [Error codes](errors.md)\n\
     - [Verification](verification.md)\n\
     - [Benchmarks](benchmarks.md)\n\
     - [Stability](stability.md)\n\
     - [Coming from LAMMPS](coming-from-lammps.md)\n\
     - [Coming from LIGGGHTS](coming-from-liggghts.md)\n\
     - [Untrusted decks](safe.md)\n\
     - [How fast, and what limits it](speed.md)\n\
     - [Forecast on many machines](scaling.md)\n\
     - [What a step does without](skipping.md)\n\n\
     # Inside the program\n\n\
     - [Architecture](architecture.md)\n\
     - [Decisions: crates](decisions/crates.md)\n\
     - [Decisions: state and plans](decisions/state.md)\n\
     - [Decisions: passes over particles](decisions/passes.md)\n\
     - [Decisions: loops over grains](decisions/grains.md)\n\
     - [Decisions: bodies on lattices](decisions/lattices.md)\n\
     - [Decisions: which bonds break](decisions/breaking.md)\n\
     - [Decisions: lanes](decisions/lanes.md)\n\
     - [Decisions: threads and memory](decisions/threads.md)\n\
     - [Decisions: ranks](decisions/ranks.md)\n\
     - [Decisions: adding laws](decisions/adding-laws.md)\n\
     - [Decisions: dependencies](decisions/dependencies.md)\n\
     - [Decisions: faults found by outside tests](decisions/strangers.md)\n\
     - [Decisions: motions of matter as a whole](decisions/movers.md)\n\
     - [Decisions: names](decisions/names.md)\n",
];

/// The book's table of contents: every page once.
fn summary() -> String {
    let mut text = String::from(BOOK[0]);
    for page in pages() {
        let _ = writeln!(text, "  - [{}](styles/{})", page.title(), page.file());
    }
    text + BOOK[1]
}

/// The text with the code shown below each `<!-- FILE -->` and `<!-- line of FILE: WORD -->` as it is in the tree.
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
        for folder in ["styles", "editor"] {
            fs::create_dir_all(docs().join(folder)).unwrap();
        }
        for (path, text) in &wanted {
            fs::write(path, text).unwrap();
        }
        for entry in fs::read_dir(docs().join("styles")).unwrap().map(|e| e.unwrap().path()) {
            if !wanted.iter().any(|(p, _)| *p == entry) {
                fs::remove_file(entry).unwrap();
            }
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
    assert!(wrong.is_empty(), "{wrong}\nPERIGRAIN_BLESS=1 cargo test --test folders docs:: writes them anew");
}

/// Every Markdown file below `docs`.
pub fn texts() -> Vec<PathBuf> {
    let mut found = vec![];
    let mut folders = vec![docs()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn the_book_has_every_page_once() {
    let text = fs::read_to_string(docs().join("SUMMARY.md")).unwrap();
    let mut wrong = String::new();
    for path in texts().iter().filter(|p| !p.ends_with("SUMMARY.md")) {
        let name = path.strip_prefix(docs()).unwrap().to_string_lossy().into_owned();
        let count = text.matches(&format!("({name})")).count();
        if count != 1 {
            let _ = writeln!(wrong, "{name}: {count} times");
        }
    }
    assert!(wrong.is_empty(), "pages that SUMMARY.md does not have once:\n{wrong}");
}

/// The codes that a deck draws, whether read or run.
fn codes(deck: &str) -> Vec<Code> {
    let mut all = vec![];
    for mode in [Mode::Check, Mode::Run] {
        let mut session = Session::new(Options { mode, log: Log::silent(), ..Options::default() }).unwrap();
        let outcome = session.run_text("in.deck", deck);
        all.extend(session.notes.0.iter().chain(outcome.err().iter().flat_map(|e| &e.0)).map(|d| d.code));
    }
    all
}

#[test]
fn every_code_is_drawn_by_its_wrong_lines_and_not_by_the_right_ones() {
    // Beside the others, so that files of examples go nowhere else.
    let folder = tempfile::tempdir().unwrap();
    let _alone = super::folder();
    std::env::set_current_dir(&folder).unwrap();
    let scene = include_str!("scripts/scene.in");
    let deck = |lines: &str| {
        if lines.starts_with("units") { lines.to_string() } else { format!("{scene}\n{lines}\n") }
    };
    let mut wrong = String::new();
    for k in CODES.iter().filter(|k| !k.wrong.is_empty()) {
        if !codes(&deck(k.wrong)).contains(&k.code) {
            let _ = writeln!(wrong, "{} is not drawn by\n{}", k.code, k.wrong);
        }
        let severe = codes(&deck(k.right));
        if !k.right.is_empty() && severe.contains(&k.code) {
            let _ = writeln!(wrong, "{} is drawn by\n{}", k.code, k.right);
        }
    }
    std::env::set_current_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_editor_grammar_is_json() {
    let text = fs::read_to_string(docs().join("editor/vscode/perigrain.tmLanguage.json")).unwrap();
    // TOML's inline tables and strings are near enough to JSON's to find a missing brace or a bad escape.
    let value = text.split_once("\"patterns\": ").unwrap().1.split_once("],\n  \"repository\"").unwrap().0;
    let value = format!("patterns = {}]", value.replace("\": ", "\" = "));
    let table: toml::Table = value.parse().unwrap();
    assert!(table["patterns"].as_array().unwrap().len() > 10);
}

#[test]
fn every_page_is_complete() {
    let mut wrong = String::new();
    for page in pages() {
        let (doc, syntax) = (page.doc, page.syntax());
        if syntax.is_empty() || doc.text.is_empty() || doc.example.is_empty() {
            let _ = writeln!(wrong, "{}: syntax, text or example is missing", page.title());
        }
        if !doc.summary.starts_with(char::is_uppercase) || !doc.summary.ends_with('.') {
            let _ = writeln!(wrong, "{}: the summary is no sentence: {}", page.title(), doc.summary);
        }
        if !syntax.contains(page.name) {
            let _ = writeln!(wrong, "{}: the syntax does not name it: {syntax}", page.title());
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The most words in a paragraph of a page.
const LONGEST: usize = 120;

/// The paragraphs of a Markdown text, each item of a list one of its own, without headings, tables and blocks of code.
fn paragraphs(text: &str) -> Vec<String> {
    let (mut all, mut open, mut code) = (vec![], String::new(), false);
    for line in text.lines().map(str::trim) {
        code ^= line.starts_with("```");
        let outside = code || line.is_empty() || ["```", "#", "|"].iter().any(|mark| line.starts_with(mark));
        if outside || line.starts_with("- ") {
            all.push(std::mem::take(&mut open));
        }
        if !outside {
            let _ = write!(open, "{line} ");
        }
    }
    all.push(open);
    all.retain(|paragraph| !paragraph.is_empty());
    all
}

#[test]
fn paragraphs_are_short() {
    let mut wrong = String::new();
    for page in pages() {
        for paragraph in paragraphs(&page.markdown()) {
            let count = paragraph.split_whitespace().count();
            if count > LONGEST {
                let start: Vec<&str> = paragraph.split_whitespace().take(8).collect();
                let _ = writeln!(wrong, "{}: {count} words: {} …", page.title(), start.join(" "));
            }
        }
    }
    assert!(wrong.is_empty(), "paragraphs of more than {LONGEST} words:\n{wrong}");
}

#[test]
fn paragraphs_end_at_empty_lines_items_tables_and_code() {
    let text = "# page\n\na b\nc\n- d\n  e\n- f\n```text\ng\n```\nh\n| i |\n";
    assert_eq!(paragraphs(text), ["a b c ", "- d e ", "- f ", "h "]);
}

#[test]
fn links_lead_somewhere() {
    let mut wrong = String::new();
    let mut files: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].iter().map(|f| docs().join("..").join(f)).collect();
    files.extend(texts());
    for file in &files {
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

#[test]
fn every_dependency_has_its_sentence() {
    let manifest: toml::Table = fs::read_to_string(docs().join("../Cargo.toml")).unwrap().parse().unwrap();
    let text = fs::read_to_string(docs().join("decisions/dependencies.md")).unwrap();
    let mut wrong = String::new();
    let others = manifest["workspace"]["dependencies"].as_table().unwrap().keys();
    for name in others.filter(|name| !name.starts_with("perigrain-")) {
        let explained = text
            .lines()
            .any(|l| l.starts_with("| `") && l.split('|').nth(1).unwrap().contains(&format!("`{name}`")));
        if !explained {
            let _ = writeln!(wrong, "{name}");
        }
    }
    assert!(wrong.is_empty(), "without a sentence in docs/decisions/dependencies.md:\n{wrong}");
}
