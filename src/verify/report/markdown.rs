//! The report as a page of the manual.

use super::{Report, expected, number, part, source, what};
use crate::verify::running::{Outcome, Verdict};
use std::fmt::Write;

/// The page: what was found where, and a table per case.
pub fn markdown(report: &Report) -> String {
    let mut out = format!(
        "# Verification\n\nPublished cases and closed forms beside perigrain's numbers, as `perigrain verify -markdown docs/verification.md` wrote \
         them: [what the command does](styles/verify.md).\n\n{}, in {:.0} s, {} at a time: **{}**.\n",
        report.origin(),
        report.seconds,
        report.workers,
        report.verdict()
    );
    let mut group = "";
    for outcome in &report.outcomes {
        if outcome.case.group() != group {
            group = outcome.case.group();
            let _ = write!(out, "\n## {group}\n");
        }
        out += &case(outcome);
    }
    out
}

/// A text with the signs that Markdown would take for its own.
fn plain(text: &str) -> String {
    text.replace('|', "\\|").replace('*', "\\*").replace('_', "\\_").replace('\n', " ")
}

fn case(outcome: &Outcome) -> String {
    let case = &outcome.case;
    let mut out = format!(
        "\n### {}\n\n{} Source: {}. (`{}`, {:.1} s)\n\n| | expected | perigrain | off by | allowed, and why | |\n|---|---|---|---|---|---|\n",
        plain(&case.title),
        plain(&case.about),
        plain(&case.source),
        case.name,
        outcome.seconds
    );
    for row in &outcome.rows {
        let own = row.check.source.is_some().then(|| format!(" ({})", source(outcome, row)));
        let verdict = match (row.verdict, &row.check.known) {
            (Verdict::Known, Some(known)) => format!("known deviation: {}", known.reason),
            (verdict, _) => verdict.word().to_string(),
        };
        let _ = writeln!(
            out,
            "| {} | {}{} | {} | {} | {}: {} | {} |",
            plain(&what(outcome, row)),
            expected(row),
            plain(&own.unwrap_or_default()),
            number(row.ours),
            part(row.deviation),
            part(row.tolerance),
            plain(&row.check.why),
            plain(&verdict)
        );
    }
    if let Some(failure) = &outcome.failure {
        let _ = write!(out, "\nThe deck failed:\n\n```text\n{}\n```\n", failure.trim());
    }
    out
}
