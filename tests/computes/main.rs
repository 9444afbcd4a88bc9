//! Computes in small decks against LAMMPS' numbers.
//!
//! `golden/NAME.txt` holds the thermo table that LAMMPS 22Jul2025 prints for `NAME.in`, 15 digits per number.
#![allow(clippy::unwrap_used)] // a test fails by panicking

use std::fs;
use std::path::Path;

use perigrain::out::log::Log;
use perigrain::session::{Options, Session, set_threads};

/// Differences, as shares of the largest number of a column, that the order of additions explains: some thousand
/// terms per sum, and some tens of steps that carry a few ulp on.
const TOLERANCE: f64 = 1e-12;

/// Runs a deck and returns its thermo table, header first.
fn run(name: &str, deck: &str, compat: bool) -> Vec<Vec<String>> {
    run_in(tempfile::tempdir().unwrap().path(), name, deck, compat)
}

/// As `run`; files of the deck go to a folder.
fn run_in(folder: &Path, name: &str, deck: &str, compat: bool) -> Vec<Vec<String>> {
    let path = folder.join("log");
    let log = Log::silent();
    log.open(&path, false).unwrap();
    let dir = folder.to_str().unwrap().to_string();
    let vars = vec![("dir".into(), vec![dir])];
    let options = Options { compat, log: log.clone(), vars, ..Options::default() };
    if let Err(e) = Session::new(options).unwrap().run_text(name, deck) {
        panic!("{name}: {e}");
    }
    log.close().unwrap();
    table(&fs::read_to_string(path).unwrap())
}

/// The rows of all thermo tables of a log, the header once.
fn table(log: &str) -> Vec<Vec<String>> {
    let (mut rows, mut inside): (Vec<Vec<String>>, bool) = (vec![], false);
    for line in log.lines() {
        let words: Vec<String> = line.split_whitespace().map(String::from).collect();
        let numbers = words.iter().all(|w| w.parse::<f64>().is_ok()) && !words.is_empty();
        match words.first().map(String::as_str) {
            Some("Step") => {
                inside = true;
                if rows.is_empty() {
                    rows.push(words);
                }
            }
            _ if inside && numbers => rows.push(words),
            _ => inside = false,
        }
    }
    rows
}

fn agrees(name: &str) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/computes");
    let deck = fs::read_to_string(here.join(format!("{name}.in"))).unwrap();
    let golden = table(&fs::read_to_string(here.join(format!("golden/{name}.txt"))).unwrap());
    let ours = run(name, &deck, true);
    assert_eq!((ours.len(), &ours[0]), (golden.len(), &golden[0]), "{name}");
    for (k, column) in golden[0].iter().enumerate() {
        let numbers =
            |t: &[Vec<String>]| -> Vec<f64> { t[1..].iter().map(|r| r[k].parse().unwrap()).collect() };
        let (ours, golden) = (numbers(&ours), numbers(&golden));
        let largest = golden.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        for (row, (a, b)) in ours.iter().zip(&golden).enumerate() {
            assert!((a - b).abs() <= TOLERANCE * largest, "{name}, {column}, row {row}: {a} is not {b}");
        }
    }
}

#[test]
fn profiles_are_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/computes/golden/profiles");
    run_in(folder.path(), "profiles", include_str!("profiles.in"), true);
    let mut files = 0;
    for entry in fs::read_dir(golden).unwrap() {
        let entry = entry.unwrap();
        let ours = fs::read_to_string(folder.path().join(entry.file_name())).unwrap();
        assert_eq!(ours, fs::read_to_string(entry.path()).unwrap(), "{:?}", entry.file_name());
        files += 1;
    }
    assert_eq!(files, 10);
    agrees("profiles");
}

// A run cut inside an average goes on with it.
#[test]
fn a_profile_of_a_run_cut_in_two_is_that_of_one() {
    let last = |runs: &str| {
        let folder = tempfile::tempdir().unwrap();
        run_in(folder.path(), "cut", &include_str!("profiles.in").replace("run 40", runs), false);
        ["1.txt", "2.txt", "4.txt", "9.txt"].map(|f| fs::read_to_string(folder.path().join(f)).unwrap())
    };
    assert_eq!(last("run 40"), last("run 17\nrun 23"));
}

#[test]
fn chunks_agree() {
    agrees("chunks");
}

#[test]
fn a_gas_agrees() {
    agrees("gas");
}

#[test]
fn threads_leave_every_bit_as_it_is() {
    let deck = include_str!("gas.in").replace("%.15g", "%.17g");
    set_threads(1);
    let one = run("one", &deck, false);
    set_threads(3);
    assert_eq!(one, run("three", &deck, false));
}

#[test]
fn contacts_agree() {
    agrees("contacts");
}
