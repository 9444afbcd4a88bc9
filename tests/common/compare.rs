//! Compares a run's log, dump or table with golden numbers, column by column.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// One line of a table, by column name.
pub type Row = BTreeMap<String, f64>;

/// How a table is to be compared.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rule {
    /// Allowed deviation relative to the largest golden magnitude in the column.
    pub rtol: f64,
    /// What LAMMPS itself changes under perturbations that should not matter; relative like `rtol`.
    pub intrinsic: f64,
    /// Absolute allowance on top, by column.
    pub columns: BTreeMap<String, f64>,
    /// How many rows come before the chaotic phase; all of them when absent.
    pub tight_rows: Option<usize>,
    /// Allowed deviation in the chaotic phase.
    pub late_rtol: Option<f64>,
    /// Columns that mean nothing in the chaotic phase.
    pub late_skip: Vec<String>,
    /// Only the mean and the standard deviation count, relative to the column's range.
    pub stat: bool,
    /// The rule for the final state, where it differs from the one for the thermo table.
    #[serde(rename = "final")]
    pub last: Option<Box<Rule>>,
}

/// Reads a table from a LAMMPS log (all thermo tables, numbered in a column `run`), a CSV, or a dump (its last snapshot).
pub fn read(text: &str) -> Vec<Row> {
    if text.lines().take(2000).any(|l| l.starts_with("ITEM: ATOMS")) {
        return read_dump(text);
    }
    let first = text.lines().find(|l| !l.trim().is_empty()).unwrap_or("");
    let is_table = first.contains(',') && matches!(first.split(',').next(), Some("run" | "id" | "Step"));
    if is_table { read_csv(text) } else { read_log(text) }
}

fn read_log(text: &str) -> Vec<Row> {
    let (mut rows, mut header, mut run) = (vec![], None::<Vec<&str>>, 0.0);
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match &header {
            None if words.first() == Some(&"Step") && words.iter().all(|w| w.parse::<f64>().is_err()) => {
                header = Some(words);
                run += 1.0;
            }
            Some(_) if line.starts_with("Loop time") || line.starts_with("ERROR") => header = None,
            Some(names) if names.len() == words.len() => {
                if let Some(mut row) = numbers(names, &words) {
                    row.insert("run".into(), run);
                    rows.push(row);
                }
            }
            _ => {}
        }
    }
    rows
}

fn read_csv(text: &str) -> Vec<Row> {
    let (mut rows, mut header) = (vec![], vec![]);
    for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#')) {
        let words: Vec<&str> = line.split(',').map(str::trim).collect();
        if words[0].parse::<f64>().is_err() {
            header = words; // it may change between runs
        } else {
            rows.extend(numbers(&header, &words));
        }
    }
    rows
}

fn read_dump(text: &str) -> Vec<Row> {
    let Some(start) = text.rfind("ITEM: ATOMS") else { return vec![] };
    let mut lines = text[start..].lines();
    let header: Vec<&str> = lines.next().unwrap_or("").split_whitespace().skip(2).collect();
    lines
        .take_while(|l| !l.starts_with("ITEM:"))
        .filter_map(|l| numbers(&header, &l.split_whitespace().collect::<Vec<_>>()))
        .collect()
}

/// A row of numbers; `None` when the line does not hold exactly one number per column.
fn numbers(names: &[&str], words: &[&str]) -> Option<Row> {
    if names.len() != words.len() {
        return None;
    }
    names.iter().zip(words).map(|(n, w)| Some((n.to_string(), w.parse().ok()?))).collect()
}

/// Compares thermo tables (rows matched by `run` and `Step`) or final states (matched by `id`).
/// Returns the largest deviation relative to its column's scale, or a report of what is wrong.
pub fn compare(result: &[Row], golden: &[Row], rule: &Rule) -> Result<f64, String> {
    let key =
        |r: &Row| -> [u64; 3] { ["run", "Step", "id"].map(|k| r.get(k).copied().unwrap_or(0.0).to_bits()) };
    if golden.is_empty() || result.is_empty() {
        return Err(format!("no table: {} rows, golden {}", result.len(), golden.len()));
    }
    let by_key: BTreeMap<_, _> = result.iter().map(|r| (key(r), r)).collect();
    let pairs: Vec<(Option<&Row>, &Row)> = golden.iter().map(|g| (by_key.get(&key(g)).copied(), g)).collect();
    let mut report = String::new();
    let missing = pairs.iter().filter(|p| p.0.is_none()).count();
    if missing > 0 || result.len() != golden.len() {
        let (have, want) = (result.len(), golden.len());
        let _ = writeln!(report, "{have} rows, golden {want}; {missing} golden rows missing");
    }
    let mut worst: f64 = 0.0;
    for column in golden[0].keys().filter(|c| !matches!(c.as_str(), "run" | "Step" | "id")) {
        let values: Vec<(f64, f64)> = pairs
            .iter()
            .filter_map(|(r, g)| {
                Some((r.map_or(f64::NAN, |r| *r.get(column).unwrap_or(&f64::NAN)), *g.get(column)?))
            })
            .collect();
        let verdict = if rule.stat { statistics(&values, rule) } else { values_of(column, &values, rule) };
        worst = worst.max(verdict.deviation);
        if let Some(row) = verdict.bad_row {
            let (have, want) = values[row];
            let at = pairs[row].1.get("Step").or(pairs[row].1.get("id")).copied().unwrap_or(0.0);
            let _ = writeln!(
                report,
                "{column:14} deviation {:.2e} of the column's scale; first at step/id {at}: {have:.15e}, golden {want:.15e}",
                verdict.deviation
            );
        }
    }
    if report.is_empty() { Ok(worst) } else { Err(report) }
}

struct Verdict {
    deviation: f64,
    bad_row: Option<usize>,
}

fn values_of(column: &str, values: &[(f64, f64)], rule: &Rule) -> Verdict {
    let scale = values.iter().map(|v| v.1.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let tight = rule.tight_rows.unwrap_or(values.len());
    let late = rule.late_rtol.unwrap_or(rule.rtol);
    let atol = rule.columns.get(column).copied().unwrap_or(0.0);
    let mut verdict = Verdict { deviation: 0.0, bad_row: None };
    for (row, &(have, want)) in values.iter().enumerate() {
        let same = have == want || (have.is_nan() && want.is_nan());
        let deviation = if same { 0.0 } else { (have - want).abs() };
        let rtol = if row < tight { rule.rtol } else { late };
        let counts = row < tight || !rule.late_skip.iter().any(|c| c == column);
        let within = deviation <= atol + rtol * scale; // false for a NaN
        if counts && !within {
            verdict.bad_row.get_or_insert(row);
        }
        let relative = if scale > 0.0 { deviation / scale } else { deviation };
        if row < tight {
            verdict.deviation =
                verdict.deviation.max(if relative.is_nan() { f64::INFINITY } else { relative });
        }
    }
    verdict
}

fn statistics(values: &[(f64, f64)], rule: &Rule) -> Verdict {
    let moments = |x: &dyn Fn(&(f64, f64)) -> f64| {
        let n = values.len() as f64;
        let mean = values.iter().map(x).sum::<f64>() / n;
        (mean, (values.iter().map(|v| (x(v) - mean).powi(2)).sum::<f64>() / n).sqrt())
    };
    let (have, want) = (moments(&|v| v.0), moments(&|v| v.1));
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v.1), h.max(v.1)));
    let range = if high > low { high - low } else { high.abs() };
    let deviation = (have.0 - want.0).abs().max((have.1 - want.1).abs()) / range.max(f64::MIN_POSITIVE);
    let within = deviation <= rule.rtol; // false for a NaN
    Verdict { deviation, bad_row: (!within).then_some(0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "Step PotEng c_d[1]\n 0 1.0 0\nWARNING: something\n 10 2.0 -0.5\nLoop time of 1\n\
                       Step PotEng c_d[1]\n 10 2.0 -0.5\nLoop time of 2\n";

    fn rule(rtol: f64) -> Rule {
        Rule { rtol, ..Rule::default() }
    }

    #[test]
    fn log_csv_and_dump_are_read_alike() {
        let log = read(LOG);
        assert_eq!(log.len(), 3);
        assert_eq!(log[2]["run"], 2.0);
        let csv = read("run,Step,PotEng,c_d[1]\n1,0,1,0\n1,10,2,-0.5\n2,10,2,-0.5\n");
        assert_eq!(compare(&log, &csv, &rule(0.0)), Ok(0.0));
        let dump = read("ITEM: ATOMS id x\n1 5\nITEM: TIMESTEP\n3\nITEM: ATOMS id x\n1 7\n2 8\n");
        assert_eq!(compare(&dump, &read("id,x\n2,8\n1,7\n"), &rule(0.0)), Ok(0.0));
    }

    #[test]
    fn deviation_is_relative_to_the_columns_largest_value() {
        let golden = read("id,x\n1,1e-9\n2,10\n");
        assert!(compare(&read("id,x\n1,2e-9\n2,10\n"), &golden, &rule(1e-9)).is_ok());
        let report = compare(&read("id,x\n1,0.1\n2,10\n"), &golden, &rule(1e-9)).unwrap_err();
        assert!(report.contains("step/id 1"), "{report}");
    }

    #[test]
    fn missing_rows_columns_and_nan_fail() {
        let golden = read("id,x,y\n1,1,2\n2,10,3\n");
        assert!(compare(&read("id,x,y\n1,1,2\n"), &golden, &rule(1.0)).is_err());
        assert!(compare(&read("id,x\n1,1\n2,10\n"), &golden, &rule(1.0)).is_err());
        assert!(compare(&read("id,x,y\n1,nan,2\n2,10,3\n"), &golden, &rule(1.0)).is_err());
        assert!(compare(&[], &golden, &rule(1.0)).is_err());
    }

    #[test]
    fn late_rows_and_statistics_are_looser() {
        let golden = read("run,Step,ke\n1,0,1\n1,1,2\n1,2,4\n");
        let have = read("run,Step,ke\n1,0,1\n1,1,2\n1,2,4.1\n");
        assert!(compare(&have, &golden, &rule(1e-6)).is_err());
        let late = Rule { tight_rows: Some(2), late_rtol: Some(0.05), ..rule(1e-6) };
        assert_eq!(compare(&have, &golden, &late), Ok(0.0));
        let stat = Rule { stat: true, ..rule(0.1) };
        let (a, b) = (read("id,x\n1,0\n2,1\n"), read("id,x\n1,1\n2,0\n"));
        assert_eq!(compare(&a, &b, &stat), Ok(0.0));
    }
}
