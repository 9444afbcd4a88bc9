//! Runs that a LAMMPS makes of the same deck, and the content of its log.

use super::worker::OUTPUT;
use super::{Outcome, series};
use perigrain_output::rows::{Row, Tables};
use perigrain_output::thermo::KEYWORDS;
use std::path::Path;
use std::process::{Command, Stdio};

/// The value of a run's `-program` that selects it.
pub const PROGRAM: &str = "lammps";
/// What LAMMPS writes in the folder of the run.
const LOG: &str = "log.lammps";

/// The command that makes a run in the working folder.
pub(super) fn command(
    program: &Path,
    deck: &Path,
    vars: &[(String, Vec<String>)],
    threads: usize,
) -> Command {
    let mut command = Command::new(program);
    command.args(["-log", LOG, "-screen", "none"]).arg("-in").arg(deck);
    for (name, values) in vars {
        command.arg("-var").arg(name).args(values);
    }
    if threads > 1 {
        command.args(["-suffix", "omp", "-package", "omp", &threads.to_string()]);
    }
    command.env("OMP_NUM_THREADS", threads.to_string()).stdin(Stdio::null());
    command
}

/// The content of a log of LAMMPS, or of perigrain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogContent {
    /// The step tables, columns by the words of `thermo_style`.
    pub tables: Tables,
    /// Wall time of the steps [s].
    pub loop_seconds: f64,
    /// Steps made.
    pub steps: i64,
    /// Particles at the end.
    pub atoms: usize,
    /// Its first error.
    pub error: Option<String>,
}

/// Reads a log with step tables of one line per row.
pub fn read(text: &str) -> LogContent {
    let mut content = LogContent::default();
    let mut columns: Option<Vec<String>> = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.first() == Some(&"Step") {
            columns = Some(words.iter().map(|w| word_of(w)).collect());
        } else if line.starts_with("Loop time of ") {
            columns = None;
            let number = |k: usize| words.get(k).and_then(|w| w.parse::<f64>().ok()).unwrap_or(0.0);
            content.loop_seconds += number(3);
            content.steps += number(8) as i64;
            content.atoms = number(11) as usize;
        } else if line.starts_with("ERROR") && content.error.is_none() {
            content.error = Some(line.trim().to_owned());
        } else if let Some(columns) = &columns {
            let values: Vec<f64> = words.iter().map_while(|w| w.parse().ok()).collect();
            if values.len() == columns.len() && words.len() == columns.len() {
                content.tables.push(columns.clone(), row(columns, values));
            }
        }
    }
    content
}

/// The word of `thermo_style` below whose heading a column stands.
fn word_of(heading: &str) -> String {
    let found = KEYWORDS.iter().find(|k| k.header == heading);
    found.map_or(heading, |k| k.name).to_owned()
}

/// A row; without a time in the table, the time is not a number.
fn row(columns: &[String], values: Vec<f64>) -> Row {
    let of = |name: &str| columns.iter().position(|c| c == name).map(|k| values[k]);
    Row { step: of("step").unwrap_or(0.0) as i64, time: of("time").unwrap_or(f64::NAN), values }
}

/// The outcome of a run in its folder, with the words that were to be reported.
pub(super) fn outcome(home: &Path, report: &[String], seconds: f64, threads: usize) -> Outcome {
    let text = std::fs::read_to_string(home.join(LOG)).unwrap_or_default();
    let content = read(&text);
    let mut out = Outcome {
        seconds,
        threads,
        loop_seconds: content.loop_seconds,
        steps: content.steps,
        atoms: content.atoms,
        ..Outcome::default()
    };
    if let Some((columns, row)) = content.tables.last() {
        out.row = columns.iter().cloned().zip(row.values.iter().copied()).collect();
    }
    let output = || std::fs::read_to_string(home.join(OUTPUT)).unwrap_or_default();
    let last = || output().lines().rev().map(str::trim).find(|l| !l.is_empty()).map(String::from);
    out.problem = match (content.error, text.contains("Total wall time")) {
        (Some(error), _) => Some(format!("LAMMPS: {error}")),
        (None, true) => None,
        (None, false) => {
            let why = last().unwrap_or_else(|| "its log has no end".into());
            Some(format!("LAMMPS did not come to the deck's end: {why}"))
        }
    };
    for word in report {
        let value = out.row.iter().find(|(name, _)| name == word).map(|(_, value)| format!("{value:?}"));
        out.measures.extend(value.map(|value| (word.clone(), value)));
    }
    if let Err(e) = series::write(&home.join(series::FILE), &content.tables, report) {
        out.problem.get_or_insert(e.to_string());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_has_tables_times_and_errors() {
        let text = "LAMMPS (22 Jul 2025)\n   Step          Time          KinEng         v_x      \n\
                    WARNING: something\n         0   0              1.5            2\n        10   0.1            1.25           3\n\
                    Loop time of 0.5 on 1 procs for 10 steps with 7 atoms\nStep Time KinEng v_x\n10 0.1 1.25 3\n20 0.2 1 4\n\
                    Loop time of 0.25 on 1 procs for 10 steps with 8 atoms\nERROR: no (src/x.cpp:1)\n";
        let content = read(text);
        assert_eq!((content.loop_seconds, content.steps, content.atoms), (0.75, 20, 8));
        let ke = series::Series::of(&content.tables, "ke").unwrap();
        assert_eq!((ke.times, ke.values), (vec![0.0, 0.1, 0.2], vec![1.5, 1.25, 1.0]));
        assert_eq!(content.error.as_deref(), Some("ERROR: no (src/x.cpp:1)"));
    }
}
