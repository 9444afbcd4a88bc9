//! The plans of all examples, as `perigrain plan` prints them, against `plans/DECK.txt`.
//!
//! `PERIGRAIN_BLESS=1` writes them anew.

#[path = "common/examples.rs"]
mod examples;

use examples::examples;
use perigrain::output::log::Log;
use perigrain::session::{Mode, Options, Session};
use perigrain_plan::Stage;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

#[test]
fn plans_of_examples_are_as_they_were() {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/plans");
    let bless = std::env::var_os("PERIGRAIN_BLESS").is_some();
    let (mut wrong, mut seen) = (String::new(), BTreeSet::new());
    for (deck, vars) in examples() {
        let name = deck.file_name().unwrap().to_string_lossy().replace("in.", "");
        if !seen.insert(name.clone()) {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let log = Log::silent();
        log.open(&path, false).unwrap();
        let here = deck.parent().unwrap().to_path_buf();
        let options =
            Options { mode: Mode::Plan, log: log.clone(), vars, folder: here, ..Options::default() };
        let mut session = Session::new(options).unwrap();
        let ended = session.run_text(&name, &fs::read_to_string(&deck).unwrap());
        log.close().unwrap();
        let plans = plans(&fs::read_to_string(path).unwrap());
        if let Err(e) = ended {
            let _ = writeln!(wrong, "--- {name} has no plan: {}", e.0[0].message);
        }
        let golden = stored.join(format!("{name}.txt"));
        if bless {
            fs::create_dir_all(&stored).unwrap();
            fs::write(&golden, &plans).unwrap();
        } else if fs::read_to_string(&golden).unwrap_or_default() != plans {
            let _ = writeln!(wrong, "--- {name} has the plans\n{plans}");
        }
    }
    assert!(wrong.is_empty(), "{wrong}(PERIGRAIN_BLESS=1 writes tests/plans anew)");
}

/// The plans that a log holds, each once: lines of stages, and of ops below them.
fn plans(log: &str) -> String {
    let heads: Vec<&str> = Stage::ALL.iter().map(|s| s.name()).chain(["left out"]).collect();
    let (mut all, mut plan): (Vec<String>, String) = (vec![], String::new());
    let mut inside = false;
    for line in log.lines().map(str::trim_end) {
        let head = heads.contains(&line);
        inside = head || (inside && line.starts_with("  "));
        let ended = !inside || line == heads[0];
        if ended && !plan.is_empty() {
            let plan = std::mem::take(&mut plan);
            all.extend((!all.contains(&plan)).then_some(plan));
        }
        if inside {
            plan += &format!("{line}\n");
        }
    }
    all.extend((!plan.is_empty() && !all.contains(&plan)).then_some(plan));
    all.join("\n")
}
