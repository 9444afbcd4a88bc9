//! The house rules that a machine can check: which crate may know which, what each file opens with, how long it gets.

mod circles;

use perigrain_computes::COMPUTES;
use perigrain_dumps::DUMPS;
use perigrain_fixes::FIXES;
use perigrain_pairs::PAIRS;
use perigrain_pairs::bond::BONDS;
use perigrain_styles::Style;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Which crate may depend on which others of the house. Cargo refuses circles; this table refuses short cuts.
const ARROWS: &[(&str, &[&str])] = &[
    // Communication between ranks; every crate may query its rank, through `base`.
    ("comm", &[]),
    // A macro: knows Rust alone.
    ("words", &[]),
    ("base", &["comm"]),
    // Laws of stress and strain: functions of 3×3 matrices, without the rest of the house.
    ("constitutive", &[]),
    ("bonded", &["base"]),
    // Equilibria of whole bodies, and the limit of their step.
    ("statics", &["base", "bonded"]),
    ("lang", &["base"]),
    // Another program's decks as native lines: words alone.
    ("liggghts", &["base", "lang"]),
    ("mesh", &["base"]),
    ("neigh", &["base"]),
    ("peri", &["base", "constitutive"]),
    ("world", &["base", "constitutive", "mesh", "peri"]),
    ("contact", &["base", "neigh", "peri", "world"]),
    ("plan", &["base", "statics", "world"]),
    ("output", &["base", "world"]),
    ("styles", &["base", "bonded", "lang", "mesh", "neigh", "output", "peri", "plan", "words", "world"]),
    // Readers of files with bodies and scenes, and what makes particles of them.
    ("geometry", &["base", "lang", "mesh", "output", "styles", "world"]),
    ("commands", &["base", "constitutive", "geometry", "lang", "mesh", "neigh", "output", "styles", "world"]),
    // One command with all that belongs to it.
    ("calibrate", &["base", "bonded", "lang", "neigh", "output", "plan", "statics", "styles", "world"]),
    (
        "pairs",
        &["base", "bonded", "constitutive", "contact", "lang", "neigh", "peri", "plan", "styles", "world"],
    ),
    ("walls", &["base", "contact", "lang", "mesh", "output", "pairs", "plan", "styles", "world"]),
    ("computes", &["base", "commands", "lang", "neigh", "peri", "plan", "statics", "styles", "world"]),
    ("dumps", &["base", "computes", "lang", "output", "plan", "styles", "world"]),
    // The Python module knows the program, and of what is below only what that shows.
    ("py", &[]),
    (
        "fixes",
        &[
            "base", "commands", "computes", "contact", "geometry", "lang", "mesh", "output", "pairs", "peri",
            "plan", "styles", "walls", "world",
        ],
    ),
];

/// Maps by string in the world, and why no step looks into them: where else state has a name it is a `Named`, whose handles are
/// made outside of steps (debug builds refuse to make one inside).
const BY_STRING: &[(&str, &str)] = &[
    ("by_name", "slots are found by name while plans are made; steps have their ids"),
    ("files", "promises are kept while a deck is checked, where no step is made"),
    ("materials", "words of a line that is being read"),
    ("mixtures", "words of a line that is being read; fixes hold the mixture itself"),
    ("templates", "words of a line that is being read; fixes hold the molecules themselves"),
];

/// Within the root package: the command graph knows no session, a session no program.
const UPWARDS: &[(&str, &[&str])] = &[
    ("graph", &["session", "manual", "lsp", "sweep", "bench", "cli"]),
    ("session", &["manual", "lsp", "sweep", "bench", "cli"]),
    ("manual", &["lsp", "sweep", "bench", "cli"]),
    ("lsp", &["sweep", "bench", "cli"]),
    ("sweep", &["bench", "cli"]),
    ("bench", &["cli"]),
    ("report", &["bench", "cli"]),
    ("plot", &["session", "sweep", "bench", "cli"]),
];

/// Past this many lines a file is two files.
const LONGEST: usize = 600;

/// Past this many lines a crate is two crates.
const LARGEST: usize = 25_000;

#[test]
fn crates_depend_only_on_what_the_table_lists() {
    let mut wrong = String::new();
    for name in crates() {
        let Some((_, allowed)) = ARROWS.iter().find(|(known, _)| *known == name) else {
            panic!("crates/{name} is not in the table of this test");
        };
        let manifest = fs::read_to_string(root().join("crates").join(&name).join("Cargo.toml")).unwrap();
        let manifest: toml::Table = manifest.parse().unwrap();
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        for dependency in dependencies.into_iter().flatten().map(|(name, _)| name) {
            if let Some(other) = dependency.strip_prefix("perigrain-")
                && !allowed.contains(&other)
            {
                writeln!(wrong, "crates/{name} may not know perigrain-{other}").unwrap();
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that are not in the table:\n{wrong}");
}

#[test]
fn the_graph_knows_no_session_and_a_session_no_program() {
    let mut wrong = String::new();
    for (room, above) in UPWARDS {
        for file in rust_files(&format!("src/{room}")) {
            let text = fs::read_to_string(&file).unwrap();
            let code = &text[..text.find("#[cfg(test)]\nmod ").unwrap_or(text.len())];
            for up in above.iter().filter(|up| code.contains(&format!("crate::{up}"))) {
                writeln!(wrong, "{}: `{room}` may not import `crate::{up}`", file.display()).unwrap();
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn no_crate_is_two_crates() {
    for name in crates() {
        let lines: usize = rust_files(&format!("crates/{name}/src"))
            .iter()
            .map(|file| fs::read_to_string(file).unwrap().lines().count())
            .sum();
        println!("{lines:6} crates/{name}");
        assert!(lines <= LARGEST, "crates/{name} has {lines} lines");
    }
}

#[test]
fn no_inherent_method_of_the_world_outside_its_crate() {
    // Rust refuses them; what is left to check is that no trait of helpers stands in for them.
    for name in crates().iter().filter(|name| *name != "world") {
        for file in rust_files(&format!("crates/{name}/src")) {
            let text = fs::read_to_string(&file).unwrap();
            let test = file.iter().any(|part| part == "tests");
            assert!(test || !text.contains(" for World {"), "{} gives the world methods", file.display());
        }
    }
}

#[test]
fn traits_that_many_write_are_short() {
    // The methods that an author of an op, a fix or a pair style has to look through, those with a default included.
    for (file, name, most) in [
        // One more than eight: on ranks only an op knows the rows whose values it needs.
        ("crates/plan/src/op.rs", "Op", 9),
        ("crates/styles/src/fix.rs", "Fix", 12),
        // One more than others may have: the exact limit of a step, which peridynamic bodies alone know.
        ("crates/styles/src/pair.rs", "Pair", 13),
    ] {
        let text = fs::read_to_string(root().join(file)).unwrap();
        let (_, from) = text.split_once(&format!("\npub trait {name}: ")).unwrap();
        let (body, _) = from.split_once("\n}").unwrap();
        let methods = body.lines().filter(|line| line.starts_with("    fn ")).count();
        println!("{name}: {methods} methods");
        assert!((1..=most).contains(&methods), "{file}: `{name}` has {methods} methods, {most} at most");
    }
}

#[test]
fn no_state_is_found_by_a_string_inside_a_step() {
    let mut found = vec![];
    for file in rust_files("crates/world/src") {
        let text = fs::read_to_string(&file).unwrap();
        let code = &text[..text.find("#[cfg(test)]\nmod ").unwrap_or(text.len())];
        let fields = code.lines().filter_map(|line| line.trim().trim_start_matches("pub ").split_once(": "));
        let maps = ["Map<String", "Map<Box<str>", "Map<Arc<str>", "Map<&"];
        let by_string =
            fields.filter(|(name, of)| !name.contains(' ') && maps.iter().any(|map| of.contains(map)));
        found.extend(by_string.map(|(name, _)| name.to_string()));
    }
    found.sort();
    let known: Vec<&str> = BY_STRING.iter().map(|(name, _)| *name).collect();
    assert_eq!(found, known, "maps by string in the world: steps find state by handles (`Named`)");
}

/// Words of the world that are names of styles as well.
const WORDS_OF_THE_WORLD: &[(&str, &str)] = &[
    ("hybrid", "an atom style"),
    ("image", "the field of crossings of periodic faces"),
    ("pair", "coefficients of a pair style, beside those of a bond style"),
    ("rigid", "the field of rigid bodies"),
];

#[test]
fn the_world_names_no_style() {
    fn names<S: Style + ?Sized>(table: &[&S]) -> Vec<&'static str> {
        table.iter().map(|style| style.name()).collect()
    }
    let styles = [names(FIXES), names(COMPUTES), names(PAIRS), names(BONDS), names(DUMPS)].concat();
    let mut wrong = String::new();
    for file in rust_files("crates/world/src") {
        let text = fs::read_to_string(&file).unwrap();
        let code = &text[..text.find("#[cfg(test)]\nmod ").unwrap_or(text.len())];
        let lines = code.lines().map(str::trim).filter(|line| !line.starts_with("//"));
        for literal in lines.flat_map(|line| line.split('"').skip(1).step_by(2)) {
            let known = WORDS_OF_THE_WORLD.iter().any(|(word, _)| *word == literal);
            let begins = |name: &&&str| {
                literal
                    .strip_prefix(**name)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', ' ']))
            };
            if let Some(style) = styles.iter().find(begins).filter(|_| !known) {
                writeln!(wrong, "{}: `{literal}` is the style `{style}`", file.display()).unwrap();
            }
        }
    }
    assert!(wrong.is_empty(), "styles own their state and register it (`Registration`):\n{wrong}");
}

#[test]
fn every_file_opens_with_one_sentence() {
    let mut wrong = String::new();
    for folder in ["src", "crates", "tests", "benches"] {
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
fn code_in_comments_is_tested() {
    let silent = |manifest: &Path| fs::read_to_string(manifest).unwrap().contains("\ndoctest = false\n");
    let rooms =
        crates().into_iter().map(|name| (root().join("crates").join(&name), format!("crates/{name}/src")));
    for (room, folder) in rooms.chain([(root().to_owned(), "src".into())]) {
        if !silent(&room.join("Cargo.toml")) {
            continue;
        }
        for file in rust_files(&folder) {
            let text = fs::read_to_string(&file).unwrap();
            let comments = text.lines().filter_map(|l| {
                let l = l.trim_start();
                l.strip_prefix("///").or(l.strip_prefix("//!"))
            });
            let fences: Vec<&str> = comments.map(str::trim).filter(|l| l.starts_with("```")).collect();
            // Every other one ends a block.
            let code = fences.iter().step_by(2).find(|f| **f != "```text");
            assert!(code.is_none(), "{}: its crate says `doctest = false`", file.display());
        }
    }
}

#[test]
fn no_file_is_two_files() {
    let mut wrong = String::new();
    let mut lengths: Vec<(usize, PathBuf)> = ["src", "crates"]
        .into_iter()
        .flat_map(rust_files)
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
    let mut folders = vec![root().join(folder)];
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

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The names of the crates below `crates`, sorted.
fn crates() -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// What opens files or starts programs beside the gate, and why.
const OPENERS: &[(&str, &str)] = &[
    ("crates/base/src/gate", "the gate itself"),
    ("crates/comm/src/", "what a launcher says of ranks"),
    ("crates/output/src/file.rs", "what the gate has let pass"),
    ("crates/output/src/gzip.rs", "what the gate has let pass"),
    ("crates/output/src/sheet.rs", "what the gate has let pass"),
    ("crates/output/src/movie.rs", "ffmpeg, which is not started under -safe"),
    ("crates/fixes/src/halt.rs", "what the gate has let pass"),
    ("src/session/shell.rs", "refused as a whole under -safe"),
    ("src/processes.rs", "processes that the program itself has started"),
    ("crates/base/src/memory.rs", "memory of the machine"),
    ("crates/plan/src/run/verlet.rs", "time of the processor"),
    ("crates/lang/src/expr/pattern.rs", "name of the system"),
    ("src/cli/", "files that the command line names, or whoever types"),
    ("src/sweep/", "folders of a sweep, which does not go with -safe"),
    ("src/bench/", "references that the command line names, and logs of its own runs"),
    ("src/verify/", "folders and reports of the program's own decks"),
];

/// Every file that a deck names is opened at the gate, so that `-safe` keeps it in its folder.
#[test]
fn files_are_opened_at_the_gate() {
    const CALLS: [&str; 12] = [
        // Of several ranks the first one looks.
        ".exists()",
        "fs::read(",
        "fs::read_to_string(",
        "fs::write(",
        "fs::read_dir(",
        "fs::remove_file(",
        "fs::rename(",
        "File::open(",
        "File::create(",
        "File::options(",
        "Command::new(",
        "env::var",
    ];
    let mut wrong = String::new();
    for path in ["crates", "src"].into_iter().flat_map(rust_files) {
        let name = path.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let text = text.split("#[cfg(test)]").next().unwrap_or("");
        let known = OPENERS.iter().any(|(opener, _)| name.starts_with(opener)) || name.contains("test");
        for call in CALLS.iter().filter(|call| !known && text.contains(**call)) {
            // An environment variable is refused where it is defined.
            if (*call, &*name) != ("env::var", "crates/lang/src/vars/text.rs") {
                let _ = writeln!(wrong, "{name} calls {call}…): perigrain_base::gate does that");
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}
