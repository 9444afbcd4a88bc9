//! Files that a deck writes itself: a check writes nothing, and misses none of them.

use super::{SCENE, check};
use perigrain::diag::{Code, Severity};
use std::fs;

/// The results of a check of a deck in a folder of its own that has these files: errors, and whether it ended early.
fn output_of(deck: &str, files: &[(&str, &str)]) -> (Vec<String>, bool) {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(dir.path().join(name), text).unwrap();
    }
    let there = format!("{}/", dir.path().display());
    let (all, _) = check(&deck.replace("@scene", SCENE).replace("@/", &there), dir.path());
    let ended = all.iter().any(|d| d.code == Code::NO_FILE && d.help.iter().any(|h| h.contains("ends here")));
    let errors = all.iter().filter(|d| d.severity == Severity::Error).map(|d| d.message.clone());
    (errors.collect(), ended)
}

/// Lines that write the file `@/f`, each with what it needs.
const WRITERS: [&str; 9] = [
    "fix w all ave/time 1 1 1 c_thermo_temp file @/f\nrun 1",
    "fix w all ave/histo 1 1 1 0 1 2 vx mode vector file @/f\nrun 1",
    "compute c all chunk/atom bin/1d x lower 1\nfix w all ave/chunk 1 1 1 c vx file @/f\nrun 1",
    "fix w all print 1 \"$(step)\" append @/f\nrun 1",
    "dump w all custom 1 @/f id\nminimize 0 0 1 1",
    "write_dump all custom @/f id",
    "log @/f",
    "print \"$(c_thermo_temp)\" file @/f",
    "shell python make.py",
];

/// Lines that read it, and whether a check has to end there.
const READERS: [(&str, bool); 6] = [
    ("variable v file @/f\nprint \"$v\"", false),
    ("read_dump @/f 1 x y z", false),
    ("include @/f\nprint \"${of_the_file}\"", true),
    ("jump @/f", true),
    ("clear\nread_data @/f\ncreate_atoms 9 box", true),
    ("molecule m @/f\nprint \"${nowhere}\"", true),
];

#[test]
fn a_file_the_deck_writes_is_neither_missed_nor_looked_into() {
    for writer in WRITERS {
        for (reader, ends) in READERS {
            let deck = format!("@scene\n{writer}\n{reader}\n");
            assert_eq!(output_of(&deck, &[]), (vec![], ends), "{deck}");
            if writer.starts_with("shell") {
                continue;
            }
            // One that is there is of an earlier run.
            assert_eq!(output_of(&deck, &[("f", "a b\nc d e\n")]), (vec![], ends), "old file: {deck}");
        }
    }
}

#[test]
fn a_file_without_a_writer_is_missed() {
    let other = "fix w all print 1 \"$(step)\" file @/g\ndump d all custom 1 @/g.* id\nrun 1";
    let more = ["create_atoms 1 mesh @/f", "rerun @/f dump x y z", "clear\nread_restart @/f"];
    for reader in READERS.iter().map(|r| r.0).chain(more) {
        for before in ["", other] {
            let (errors, ended) = output_of(&format!("@scene\n{before}\n{reader}\n"), &[]);
            assert!(!ended && errors.iter().any(|e| e.contains("/f`")), "{reader}: {errors:?}");
        }
    }
}

#[test]
fn dumps_with_a_step_in_their_name_are_known() {
    let deck = "@scene\ndump d all custom 10 @/d.*.txt id x y z\nrun 20\nrerun @/d.20.txt dump x y z\n";
    assert_eq!(output_of(deck, &[]), (vec![], false));
    assert_eq!(output_of(&deck.replace("rerun @/d.20.txt", "rerun @/e.20.txt"), &[]).0.len(), 1);
}

#[test]
fn a_check_that_ends_early_keeps_what_it_found() {
    let deck = "@scene\nfxi 1 all nve\nlog @/f\ninclude @/f\nfxi 2 all nve\n";
    let (errors, ended) = output_of(deck, &[]);
    assert!(ended);
    assert_eq!(errors, ["unknown command `fxi`"]);
}

#[test]
fn a_branch_that_may_not_be_taken_does_not_end_a_check() {
    let deck = "@scene\nlog @/f\nif \"$(c_thermo_temp) > 1\" then \"include @/f\"\nfxi 2 all nve\n";
    let (errors, ended) = output_of(deck, &[]);
    assert!(!ended);
    assert_eq!(errors, ["unknown command `fxi`"]);
}

#[test]
fn names_that_a_hidden_file_may_use_draw_no_warning() {
    let warnings = |deck: &str| {
        let (all, _) = check(deck, std::path::Path::new("."));
        all.iter().filter(|d| d.severity == Severity::Warning).count()
    };
    assert_eq!(warnings("variable depth equal 1\nlog f.no_such\n"), 1);
    assert_eq!(warnings("variable depth equal 1\nlog f.no_such\ninclude f.no_such\n"), 0);
}
