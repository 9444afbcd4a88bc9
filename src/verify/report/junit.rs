//! The report as JUnit XML, which test servers read.

use super::{Report, expected, number, part, source, what};
use crate::plot::escaped;
use crate::verify::running::{Outcome, Row, Verdict};
use std::fmt::Write;

/// A suite per case, a test per check; known deviations count as skipped, with their reason.
pub fn junit(report: &Report) -> String {
    let tests: usize = report.outcomes.iter().map(|o| o.rows.len()).sum();
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"perigrain verify\" tests=\"{tests}\" failures=\"{}\" skipped=\"{}\" time=\"{:.3}\">\n",
        report.count(Verdict::Failed),
        report.count(Verdict::Known),
        report.seconds
    );
    for outcome in &report.outcomes {
        let _ = writeln!(
            out,
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\" time=\"{:.3}\">",
            escaped(&outcome.case.name),
            outcome.rows.len(),
            outcome.count(Verdict::Failed),
            outcome.count(Verdict::Known),
            outcome.seconds
        );
        outcome.rows.iter().for_each(|r| out += &test(outcome, r));
        out += "  </testsuite>\n";
    }
    out + "</testsuites>\n"
}

fn test(outcome: &Outcome, row: &Row) -> String {
    let message = escaped(&format!(
        "{} instead of {}, off by {}, allowed {} ({})",
        number(row.ours),
        expected(row),
        part(row.deviation),
        part(row.tolerance),
        source(outcome, row)
    ));
    let inside = match (row.verdict, &row.check.known, &outcome.failure) {
        (Verdict::Passed, ..) => String::new(),
        (Verdict::Known, Some(known), _) => {
            format!("<skipped message=\"known deviation: {message}: {}\"/>", escaped(&known.reason))
        }
        (_, _, Some(failure)) => {
            format!("<failure message=\"the deck failed\">{}</failure>", escaped(failure))
        }
        _ => format!("<failure message=\"{message}\"/>"),
    };
    let name = escaped(&outcome.case.name).replace('/', ".");
    let what = escaped(&what(outcome, row));
    match inside.is_empty() {
        true => format!("    <testcase classname=\"{name}\" name=\"{what}\"/>\n"),
        false => format!("    <testcase classname=\"{name}\" name=\"{what}\">{inside}</testcase>\n"),
    }
}
