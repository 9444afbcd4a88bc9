//! The report for programs.

use super::{Report, source};
use crate::json::{number, quoted};
use crate::verify::running::{Outcome, Point, Row, Verdict};

/// The whole report as a JSON object.
pub fn json(report: &Report) -> String {
    let cases: Vec<String> = report.outcomes.iter().map(case).collect();
    let [passed, known, failed] =
        [Verdict::Passed, Verdict::Known, Verdict::Failed].map(|verdict| report.count(verdict));
    format!(
        "{{\"program\": \"perigrain\", \"version\": {}, \"debug\": {}, \"machine\": {}, \"workers\": {}, \"seconds\": {}, \
         \"passed\": {passed}, \"known\": {known}, \"failed\": {failed},\n\"cases\": [\n{}\n]}}\n",
        quoted(env!("CARGO_PKG_VERSION")),
        cfg!(debug_assertions),
        quoted(&report.machine),
        report.workers,
        number(report.seconds),
        cases.join(",\n")
    )
}

fn case(outcome: &Outcome) -> String {
    let rows: Vec<String> = outcome.rows.iter().map(|r| row(outcome, r)).collect();
    let curves = outcome.case.curve.iter().zip(&outcome.points).map(|(curve, points)| {
        format!(
            "{{\"title\": {}, \"x\": {}, \"y\": {}, \"expected_is\": {}, \"points\": [{}]}}",
            quoted(&curve.title),
            quoted(&curve.x),
            quoted(&curve.y),
            quoted(&curve.expected),
            points.iter().map(point).collect::<Vec<_>>().join(", ")
        )
    });
    format!(
        " {{\"name\": {}, \"title\": {}, \"source\": {}, \"seconds\": {}, \"failure\": {},\n  \"checks\": [\n   {}\n  ],\n  \"curves\": [{}]}}",
        quoted(&outcome.case.name),
        quoted(&outcome.case.title),
        quoted(&outcome.case.source),
        number(outcome.seconds),
        outcome.failure.as_ref().map_or("null".into(), |failure| quoted(failure)),
        rows.join(",\n   "),
        curves.collect::<Vec<_>>().join(",\n   ")
    )
}

fn row(outcome: &Outcome, row: &Row) -> String {
    let check = &row.check;
    format!(
        "{{\"what\": {}, \"verdict\": \"{}\", \"expected\": {}, \"ours\": {}, \"unit\": {}, \"at\": {}, \"deviation\": {}, \
         \"tolerance\": {}, \"why\": {}, \"source\": {}, \"known\": {}}}",
        quoted(&check.what),
        match row.verdict {
            Verdict::Passed => "passed",
            Verdict::Known => "known",
            Verdict::Failed => "failed",
        },
        number(row.expected),
        number(row.ours),
        quoted(&check.unit),
        row.at.map_or("null".into(), number),
        number(row.deviation),
        number(row.tolerance),
        quoted(&check.why),
        quoted(source(outcome, row)),
        check.known.as_ref().map_or("null".into(), |known| quoted(&known.reason))
    )
}

/// x, ours, and what was expected if there is something.
fn point(&(x, ours, expected): &Point) -> String {
    let all: Vec<String> = [Some(x), Some(ours), expected].into_iter().flatten().map(number).collect();
    format!("[{}]", all.join(", "))
}
