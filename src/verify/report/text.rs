//! The report for a terminal.

use super::{Report, expected, number, part, what};
use crate::verify::case::Case;
use crate::verify::running::{Outcome, Verdict};
use std::fmt::Write;

/// The cases, a line each.
pub fn list(cases: &[Case]) -> String {
    let wide = cases.iter().map(|c| c.name.len()).max().unwrap_or(0);
    cases.iter().map(|c| format!("{:<wide$}  {}\n", c.name, c.title)).collect()
}

/// One case with its checks.
pub fn of_case(outcome: &Outcome) -> String {
    let case = &outcome.case;
    let mut text = format!("{}: {} ({:.1} s)\n", case.name, case.title, outcome.seconds);
    for row in &outcome.rows {
        let _ = writeln!(
            text,
            "  {:<15} {}: {} for {}, off by {}, allowed {}",
            row.verdict.word(),
            what(outcome, row),
            number(row.ours),
            expected(row),
            part(row.deviation),
            part(row.tolerance)
        );
        if let (Verdict::Known, Some(known)) = (row.verdict, &row.check.known) {
            let _ = writeln!(text, "                  {}", known.reason);
        }
    }
    if let Some(failure) = &outcome.failure {
        failure.lines().for_each(|line| text += &format!("    {line}\n"));
    }
    text
}

/// The last lines: what was found, on what.
pub fn summary(report: &Report) -> String {
    format!(
        "\n{}\n{:.1} s, {} at a time; {}\n",
        report.verdict(),
        report.seconds,
        report.workers,
        report.origin()
    )
}
