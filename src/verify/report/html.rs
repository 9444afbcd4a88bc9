//! The report as one web page that needs nothing else, with its curves.

use super::{Report, expected, number, part, source, what};
use crate::plot::{escaped, page};
use crate::verify::running::{Outcome, Row, Verdict};
use std::fmt::Write;

const STYLE: &str = "\
h2{margin-top:3rem;border-bottom:1px solid var(--line);text-transform:capitalize}h3{margin:2.2rem 0 .3rem}\
section td:first-child{width:32%}section td:nth-child(5){min-width:16rem}\
.verdict{font-size:1.2rem;font-weight:600}.source{color:var(--soft);font-size:.9rem}\
figure{display:inline-block;width:48%;min-width:20rem;margin:1rem .5rem 0 0;vertical-align:top}\
svg{width:100%;height:auto;border:1px solid var(--line)}details summary{font-size:.9rem}nav a{text-decoration:none}";

/// The page.
pub fn html(report: &Report) -> String {
    let mut out = format!(
        "<h1>perigrain verify</h1>\n<p class=\"verdict {}\">{}</p>\n<p class=\"small\">{}; {:.1} s, {} at a time</p>\n",
        if report.is_well() { "passed" } else { "failed" },
        escaped(&report.verdict()),
        escaped(&report.origin()),
        report.seconds,
        report.workers
    );
    out += "<nav><table>\n<tr><th>case</th><th>checks</th><th>worst deviation, as a part of what is allowed</th><th></th></tr>\n";
    report.outcomes.iter().for_each(|o| out += &line(o));
    out += "</table></nav>\n";
    let mut group = "";
    for outcome in &report.outcomes {
        if outcome.case.group() != group {
            group = outcome.case.group();
            let _ = writeln!(out, "<h2>{}</h2>", escaped(group));
        }
        out += &case(outcome);
    }
    page("perigrain verify", STYLE, "", &out)
}

/// Name of the style of a verdict.
fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Known => "known",
        Verdict::Failed => "failed",
    }
}

/// The worst of a case's verdicts.
fn overall(outcome: &Outcome) -> Verdict {
    [Verdict::Failed, Verdict::Known].into_iter().find(|v| outcome.count(*v) > 0).unwrap_or(Verdict::Passed)
}

/// A case in the table at the top.
fn line(outcome: &Outcome) -> String {
    let used = |row: &Row| row.deviation.abs() / row.tolerance;
    let most = outcome.rows.iter().map(used).fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
    format!(
        "<tr><td><a href=\"#{0}\">{1}</a></td><td class=\"n\">{2}</td><td class=\"n\">{3}</td><td class=\"{4}\">{5}</td></tr>\n",
        escaped(&outcome.case.name),
        escaped(&outcome.case.title),
        outcome.rows.len(),
        if most.is_nan() { "no number".into() } else { format!("{most:.2}") },
        class(overall(outcome)),
        overall(outcome).word()
    )
}

fn case(outcome: &Outcome) -> String {
    let case = &outcome.case;
    let mut out = format!(
        "<section id=\"{}\">\n<h3>{}</h3>\n<p>{}</p>\n<p class=\"source\">{} <span class=\"small\">({}, {:.1} s)</span></p>\n\
         <table>\n<tr><th></th><th>expected</th><th>perigrain</th><th>off by</th><th>allowed</th><th></th></tr>\n",
        escaped(&case.name),
        escaped(&case.title),
        escaped(&case.about),
        escaped(&case.source),
        escaped(&case.name),
        outcome.seconds
    );
    outcome.rows.iter().for_each(|r| out += &row(outcome, r));
    out += "</table>\n";
    if let Some(failure) = &outcome.failure {
        let _ = writeln!(out, "<pre class=\"failed\">{}</pre>", escaped(failure));
    }
    for (curve, points) in case.curve.iter().zip(&outcome.points).filter(|(_, points)| !points.is_empty()) {
        let _ = writeln!(
            out,
            "<figure>{}<figcaption>{}</figcaption></figure>",
            curve.chart(points).svg(),
            escaped(&curve.title)
        );
    }
    let _ =
        writeln!(out, "<details><summary>the deck</summary><pre>{}</pre></details>", escaped(&case.lines()));
    out + "</section>\n"
}

fn row(outcome: &Outcome, row: &Row) -> String {
    let own = row
        .check
        .source
        .is_some()
        .then(|| format!("<br><span class=\"small\">{}</span>", escaped(source(outcome, row))));
    let reason = match (row.verdict, &row.check.known) {
        (Verdict::Known, Some(known)) => {
            format!("<br><span class=\"small\">{}</span>", escaped(&known.reason))
        }
        _ => String::new(),
    };
    format!(
        "<tr><td>{}{reason}</td><td class=\"n\">{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td>{}<br><span class=\"small\">{}</span></td><td class=\"{}\">{}</td></tr>\n",
        escaped(&what(outcome, row)),
        escaped(&expected(row)),
        own.unwrap_or_default(),
        number(row.ours),
        part(row.deviation),
        part(row.tolerance),
        escaped(&row.check.why),
        class(row.verdict),
        row.verdict.word()
    )
}
