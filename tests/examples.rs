//! Every example, made small by `-var`, prints the numbers in its `expected.csv`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One row of an `expected.csv`: what a run with these arguments prints after this label.
struct Row {
    label: String,
    value: f64,
    tolerance: f64,
}

/// The tables of all examples.
fn tables() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut tables: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path().join("expected.csv"))
        .filter(|p| p.exists())
        .collect();
    tables.sort();
    tables
}

/// Every example's deck with the arguments that make it small.
pub fn short_forms() -> Vec<(PathBuf, String)> {
    let mut forms = vec![];
    for table in tables() {
        for (deck, args) in read(&table).into_keys() {
            forms.extend(variants(&args).into_iter().map(|args| (table.with_file_name(&deck), args)));
        }
    }
    forms
}

#[test]
fn examples_print_what_they_should() {
    for table in tables() {
        for ((deck, args), rows) in read(&table) {
            let printed: Vec<String> =
                variants(&args).iter().map(|args| run(&table.with_file_name(&deck), args)).collect();
            for row in rows {
                let numbers = printed.iter().map(|text| number_after(text, &row.label));
                let got = numbers.sum::<f64>() / printed.len() as f64;
                let off = (got - row.value).abs();
                let name = table.parent().unwrap().file_name().unwrap();
                assert!(
                    off <= row.tolerance,
                    "{name:?} {deck} {args}: `{}` is {got}, not {} within {}",
                    row.label,
                    row.value,
                    row.tolerance
                );
            }
        }
    }
}

/// Arguments with each of the words that `|` separates in one of them; what these runs print is averaged.
fn variants(args: &str) -> Vec<String> {
    let Some(word) = args.split_whitespace().find(|w| w.contains('|')) else { return vec![args.to_owned()] };
    word.split('|').map(|choice| args.replace(word, choice)).collect()
}

/// Rows by deck and arguments. Columns: deck, arguments, label, value, absolute tolerance; `#` begins a comment.
fn read(table: &Path) -> BTreeMap<(String, String), Vec<Row>> {
    let mut runs = BTreeMap::<_, Vec<Row>>::new();
    let text = fs::read_to_string(table).unwrap();
    for line in text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let [deck, args, label, value, tolerance] = cells[..] else {
            panic!("{}: five columns expected: {line}", table.display());
        };
        runs.entry((deck.to_owned(), args.to_owned())).or_default().push(Row {
            label: label.to_owned(),
            value: value.parse().unwrap(),
            tolerance: tolerance.parse().unwrap(),
        });
    }
    runs
}

/// What the deck prints, run in a folder of its own, with one thread: other tests run beside it.
fn run(deck: &Path, args: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .arg("-in")
        .arg(deck)
        .args(args.split_whitespace())
        .args(["-threads", "1"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(
        out.status.success(),
        "{} {args}:\n{text}\n{}",
        deck.display(),
        String::from_utf8_lossy(&out.stderr)
    );
    text
}

/// The first number behind the label, in the first line that begins with it.
fn number_after(printed: &str, label: &str) -> f64 {
    let line = printed.lines().map(str::trim).find(|l| l.starts_with(label));
    let line = line.unwrap_or_else(|| panic!("nothing printed begins with `{label}`:\n{printed}"));
    let found = line[label.len()..].split_whitespace().find_map(|w| w.parse().ok());
    found.unwrap_or_else(|| panic!("no number in `{line}`"))
}
