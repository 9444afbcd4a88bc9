//! Text dumps against LAMMPS' own files, byte for byte.
//!
//! `golden/` holds what LAMMPS 22Jul2025 writes for `in.dumps` (`lmp -in in.dumps -var dir golden`), where `g.dump`
//! began with the line `before`. Formats show at most eight digits: the last ones of a double depend on the order of
//! additions into forces.
#![allow(clippy::unwrap_used)] // a test fails by panicking

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use perigrain::session::{Options, Session};

/// All files of a folder by name.
fn files(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read_to_string(e.path()).unwrap())).collect()
}

#[test]
fn the_same_bytes_as_lammps() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/dumps");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("g.dump"), "before\n").unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    // LAMMPS' unfolded fractions carry the rounding of its image offset: an artefact of compat.
    let options = Options { compat: true, vars: vec![("dir".into(), vec![dir])], ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let deck = fs::read_to_string(here.join("in.dumps")).unwrap();
    session.run_text("in.dumps", &deck).unwrap();
    let (ours, theirs) = (files(folder.path()), files(&here.join("golden")));
    assert_eq!(ours.keys().collect::<Vec<_>>(), theirs.keys().collect::<Vec<_>>());
    for (name, text) in &ours {
        for (k, (a, b)) in text.lines().zip(theirs[name].lines()).enumerate() {
            assert_eq!(a, b, "{name}, line {}", k + 1);
        }
        assert_eq!(text, &theirs[name], "{name}");
    }
}

#[test]
fn check_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap().to_string();
    let mode = perigrain::session::Mode::Check;
    let mut session =
        Session::new(Options { mode, vars: vec![("dir".into(), vec![dir])], ..Options::default() }).unwrap();
    session.run_text("in.dumps", include_str!("in.dumps")).unwrap();
    assert!(files(folder.path()).is_empty());
}
