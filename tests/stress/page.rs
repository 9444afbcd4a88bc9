//! The page on stability, of the rows of a long run.

use super::running::{Form, Row};
use super::table::{Figure, How, Section};
use std::fmt::Write;

/// Where nothing is measured.
const REFUSED: &str = "refused";

/// A bound in words.
fn bound(f: &Figure) -> String {
    match (f.least, f.most) {
        (Some(a), Some(b)) => format!("{a} … {b}"),
        (Some(a), None) => format!("≥ {a}"),
        (None, Some(0.0)) => "0".to_string(),
        (None, Some(b)) => format!("≤ {b:.1e}"),
        (None, None) => "is a number".to_string(),
    }
}

/// Numbers near one with digits, others with powers.
fn number(v: f64) -> String {
    match v.abs() {
        0.0 => "0".to_string(),
        0.01..1000.0 => format!("{v:.4}"),
        _ => format!("{v:.1e}"),
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// What a line of the page is known by: case, figure and bound, without what was measured.
pub fn key(line: &str) -> String {
    let cells: Vec<&str> = line.split(" | ").collect();
    let at = |k: usize| cells.get(k).map_or("", |c| c.trim_matches([' ', '|']));
    [at(0), at(1), at(3)].join(" · ")
}

/// The keys of all lines that the page must have.
pub fn keys(sections: &[Section]) -> Vec<String> {
    let mut all = vec![];
    for s in sections {
        all.push(key(HEAD));
        for case in &s.case {
            all.extend(s.figures(case).iter().map(|f| key(&row(&case.name, &f.name, "", &bound(f)))));
            if case.how == How::Refused {
                let words = format!("`{}`", case.prints.join("`, `"));
                all.push(key(&row(&case.name, REFUSED, "", &words)));
            }
        }
    }
    all
}

const HEAD: &str = "| case | figure | measured | bound | |";

fn row(case: &str, figure: &str, measured: &str, bound: &str) -> String {
    format!("| {} | {figure} | {} | {bound} |", cell(case), cell(measured))
}

/// The whole page.
pub fn markdown(sections: &[Section], rows: &[Vec<Row>], form: Form) -> String {
    let length = if form == Form::Long { "the long form" } else { "the short form, of few steps," };
    let count: usize = sections.iter().map(|s| s.case.len()).sum();
    let failed = rows.iter().flatten().filter(|r| !r.met).count();
    let mut text = format!(
        "# Stability\n\nWhat becomes of runs at their limits, as {length} of `./check --stress` measured it: {count} cases, {failed} \
         figures outside their bounds. A run that cannot be right ends with a named error; where it \
         does not yet, the reason says so. Decks: `tests/stress/scenes`, cases: \
         `tests/stress/tables`.\n"
    );
    for (s, rows) in sections.iter().zip(rows) {
        let _ = write!(text, "\n## {}\n\n{}\n\n{HEAD}\n|---|---|---|---|---|\n", s.title, s.about.trim());
        for r in rows {
            let case = s.case.iter().find(|c| c.name == r.case).unwrap();
            let (figure, measured, limit) = match &r.figure {
                Some(f) => (f.name.as_str(), r.value.map_or("none".into(), number), bound(f)),
                None => (REFUSED, r.printed.clone(), format!("`{}`", case.prints.join("`, `"))),
            };
            let flag = if r.met { "" } else { "**not met**" };
            let _ = writeln!(text, "{} {flag} |", row(&r.case, figure, &measured, &limit));
        }
        let mut lines: Vec<String> = vec![];
        let _ = writeln!(text);
        for f in s.case.iter().flat_map(|c| s.figures(c)) {
            let line = format!("- {}, {}: {}", f.name, bound(&f), f.why);
            if !lines.contains(&line) {
                let _ = writeln!(text, "{line}");
                lines.push(line);
            }
        }
    }
    text
}
