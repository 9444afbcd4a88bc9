//! The decks of all examples, made small.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Variables as `-var` gives them.
pub type Vars = Vec<(String, Vec<String>)>;

/// The decks of all examples, small by the variables of their first row in `expected.csv`.
pub fn examples() -> Vec<(PathBuf, Vars)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut all = vec![];
    for table in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path().join("expected.csv")) {
        let text = fs::read_to_string(&table).unwrap_or_default();
        let mut seen = BTreeSet::new();
        for line in text.lines().filter(|l| !l.starts_with('#') && l.contains(',')) {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            if !seen.insert((cells[0], cells[1])) {
                continue;
            }
            let vars = cells[1].split("-var ").filter(|v| !v.trim().is_empty());
            let vars = vars.map(|v| {
                let mut words = v.split_whitespace().map(|w| w.split('|').next().unwrap().to_string());
                (words.next().unwrap(), words.collect())
            });
            all.push((table.with_file_name(cells[0]), vars.collect()));
        }
    }
    all.sort();
    all
}
