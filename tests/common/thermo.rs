//! Runs small decks in this process and compares their step tables with those that LAMMPS printed.

use perigrain::output::log::Log;
use perigrain::session::{Options, Session};
use perigrain::world::Compat;
use std::fs;
use std::path::Path;

/// A step table, header first.
pub type Table = Vec<Vec<String>>;

/// Runs a deck and returns the session and its table. The variable `dir` names the folder, for files of the deck.
pub fn run_in(folder: &Path, name: &str, deck: &str, compat: bool) -> (Session, Table) {
    let path = folder.join("log");
    let log = Log::silent();
    log.open(&path, false).unwrap();
    let dir = folder.to_str().unwrap().to_string();
    let vars = vec![("dir".into(), vec![dir])];
    let compat = if compat { Compat::Lammps2025 } else { Compat::Perigrain };
    let options = Options { compat, log: log.clone(), vars, ..Options::default() };
    let mut session = Session::new(options).unwrap();
    if let Err(e) = session.run_text(name, deck) {
        panic!("{name}: {e}");
    }
    log.close().unwrap();
    (session, table(&fs::read_to_string(path).unwrap()))
}

/// As `run_in`, in a folder that is gone afterwards.
pub fn run(name: &str, deck: &str, compat: bool) -> (Session, Table) {
    run_in(tempfile::tempdir().unwrap().path(), name, deck, compat)
}

/// The rows of all tables of a log, the header once.
fn table(log: &str) -> Table {
    let (mut rows, mut inside): (Table, bool) = (vec![], false);
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

/// Compares the table of `tests/PLACE/NAME.in`, as `execute` makes it of the deck's text, with LAMMPS' in
/// `tests/PLACE/golden/NAME.txt`, each column to a share of its largest number.
pub fn agrees(place: &str, name: &str, tolerance: f64, execute: impl FnOnce(&str) -> Table) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(place);
    let ours = execute(&fs::read_to_string(here.join(format!("{name}.in"))).unwrap());
    let golden = table(&fs::read_to_string(here.join(format!("golden/{name}.txt"))).unwrap());
    assert_eq!((ours.len(), &ours[0]), (golden.len(), &golden[0]), "{name}");
    for (k, column) in golden[0].iter().enumerate() {
        let numbers =
            |t: &[Vec<String>]| -> Vec<f64> { t[1..].iter().map(|r| r[k].parse().unwrap()).collect() };
        let (ours, golden) = (numbers(&ours), numbers(&golden));
        let largest = golden.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        for (row, (a, b)) in ours.iter().zip(&golden).enumerate() {
            assert!((a - b).abs() <= tolerance * largest, "{name}, {column}, row {row}: {a} is not {b}");
        }
    }
}
