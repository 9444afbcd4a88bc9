//! The results of all runs: a table that programs read, the times beside it, and a text for people.

use super::{Job, Outcome};
use perigrain_base::diag::Result;
use perigrain_output::file::replace;
use std::fmt::Write;
use std::path::Path;

/// The table: the same bytes whenever and on however many cores its runs were made.
pub const TABLE: &str = "table.csv";
/// What runs took, which is different each time.
pub const TIMES: &str = "times.csv";

/// Columns that the runs have, each once in the order in which they come.
fn columns<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let mut out: Vec<&str> = vec![];
    for name in names {
        if !out.contains(&name.as_str()) {
            out.push(name);
        }
    }
    out
}

/// Column names and one row of cells per run: number, variables, status, steps, particles, last row of the step table, what was
/// reported, why it failed.
fn cells(jobs: &[Job], report: &[String], outcomes: &[Option<Outcome>]) -> (Vec<String>, Vec<Vec<String>>) {
    let vars = columns(jobs.iter().flat_map(|j| j.vars.iter().map(|v| &v.0)));
    let ended = || outcomes.iter().flatten();
    let mut row = columns(ended().flat_map(|o| o.row.iter().map(|r| &r.0)));
    row.retain(|name| !report.iter().any(|r| r == name));
    let mut head: Vec<String> = vec!["run".into()];
    head.extend(vars.iter().map(ToString::to_string));
    head.extend(["status", "steps", "atoms"].map(String::from));
    head.extend(row.iter().map(ToString::to_string));
    head.extend(report.iter().cloned());
    head.push("problem".into());
    let line =
        |(k, job): (usize, &Job)| {
            let mut cells = vec![(k + 1).to_string()];
            let of = |list: &[(String, String)], name: &str| {
                list.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()).unwrap_or_default()
            };
            cells.extend(vars.iter().map(|name| of(&job.vars, name)));
            let Some(o) = outcomes.get(k).and_then(Option::as_ref) else {
                cells.resize(head.len(), String::new());
                return cells;
            };
            cells.extend([o.status().to_string(), o.steps.to_string(), o.atoms.to_string()]);
            cells.extend(row.iter().map(|name| {
                o.row.iter().find(|(n, _)| n == name).map(|(_, v)| number(*v)).unwrap_or_default()
            }));
            cells.extend(report.iter().map(|name| of(&o.measures, name)));
            cells.push(o.problem.clone().unwrap_or_default());
            cells
        };
    let lines = jobs.iter().enumerate().map(line).collect();
    (head, lines)
}

/// A number with as few digits as mean it and no other.
fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), String::from)
}

/// Cells between commas, in quotes where they hold commas, quotes or line breaks.
pub fn line(cells: &[String]) -> String {
    let quoted = |c: &String| match c.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", c.replace('"', "\"\"")),
        false => c.clone(),
    };
    cells.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// The table as text, columns between commas.
pub fn csv(jobs: &[Job], report: &[String], outcomes: &[Option<Outcome>]) -> String {
    let (head, rows) = cells(jobs, report, outcomes);
    rows.iter().fold(line(&head), |text, row| text + &line(row))
}

/// What the runs took, columns between commas.
fn times(outcomes: &[Option<Outcome>]) -> String {
    let mut text = String::from("run,seconds,loop_seconds,threads\n");
    for (k, o) in outcomes.iter().enumerate().filter_map(|(k, o)| Some((k, o.as_ref()?))) {
        let _ = writeln!(text, "{},{:.3},{:.3},{}", k + 1, o.seconds, o.loop_seconds, o.threads);
    }
    text
}

/// Writes the table and the times into a folder; both are whole at any moment.
///
/// # Errors
/// Files that cannot be written.
pub fn write(folder: &Path, jobs: &[Job], report: &[String], outcomes: &[Option<Outcome>]) -> Result<()> {
    replace(&folder.join(TABLE), |w| w.write_all(csv(jobs, report, outcomes).as_bytes()))?;
    replace(&folder.join(TIMES), |w| w.write_all(times(outcomes).as_bytes()))
}

/// The table for people: columns that line up, with the seconds, no row of more than `width` characters and not more than `most` rows.
pub fn text(
    jobs: &[Job],
    report: &[String],
    outcomes: &[Option<Outcome>],
    width: usize,
    most: usize,
) -> String {
    let (mut head, mut rows) = cells(jobs, report, outcomes);
    let at = head.iter().position(|c| c == "atoms").unwrap_or(0);
    head.insert(at, "seconds".into());
    for (row, outcome) in rows.iter_mut().zip(outcomes) {
        row.insert(at, outcome.as_ref().map_or(String::new(), |o| format!("{:.2}", o.seconds)));
    }
    let problems = rows.iter().any(|r| r.last().is_some_and(|c| !c.is_empty()));
    let shown = head.len() - usize::from(!problems);
    aligned(&head[..shown], &rows, width, most)
}

/// Columns that line up on the right, no row of more than `width` characters and not more than `most` of them; cells beyond the
/// head are left out. What there is no room for is left out by whole columns, one at least being shown; only texts are cut.
pub fn aligned(head: &[String], rows: &[Vec<String>], width: usize, most: usize) -> String {
    let shown = || std::iter::once(head).chain(rows.iter().take(most).map(Vec::as_slice));
    let long = |c: usize| shown().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let mut lengths: Vec<usize> = (0..head.len()).map(long).collect();
    let (mut used, mut fit) = (0, 0);
    while fit < head.len() && (used + lengths[fit] + 2 <= width || fit == 0) {
        used += lengths[fit] + 2;
        fit += 1;
    }
    let is_text = |c: usize| shown().skip(1).any(|r| !r[c].is_empty() && r[c].parse::<f64>().is_err());
    if fit < head.len() && is_text(fit) && width >= used + 2 + SHORTEST {
        lengths[fit] = width - used - 2;
        fit += 1;
    }
    let mut out = String::new();
    for row in shown() {
        let mut words = String::new();
        for (cell, &length) in row[..fit.min(row.len())].iter().zip(&lengths) {
            match cell.chars().count() > length {
                true => words.extend("  ".chars().chain(cell.chars().take(length - 1)).chain(['…'])),
                false => _ = write!(words, "  {cell:>length$}"),
            }
        }
        let _ = writeln!(out, "{}", words.trim_end());
    }
    if rows.len() > most {
        let _ = writeln!(out, "  … {} more", rows.len() - most);
    }
    if fit < head.len() {
        let _ =
            writeln!(out, "  ({} columns more than fit here: {})", head.len() - fit, head[fit..].join(" "));
    }
    out
}

/// The fewest characters of a text that is cut.
const SHORTEST: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_cut_between_columns_and_within_texts_alone() {
        let words = |line: &str| line.split(' ').map(String::from).collect::<Vec<_>>();
        let (head, rows) = (words("run v pe"), [words("1 20.25 0.123456789")]);
        let table = |width| aligned(&head, &rows, width, 9);
        assert_eq!(
            table(23),
            "  run      v           pe\n    1  20.25  0.123456789\n"
                .replace("           pe", "")
                .replace("  0.123456789", "")
                + "  (1 columns more than fit here: pe)\n"
        );
        assert_eq!(table(25).lines().nth(1), Some("    1  20.25  0.123456789"));
        let rows = [vec!["1".into(), "2".into(), "a long story of what went wrong".into()]];
        assert_eq!(aligned(&head, &rows, 24, 9).lines().nth(1), Some("    1  2  a long story …"));
    }

    #[test]
    fn every_run_has_its_row_whether_it_has_ended_or_not() {
        let job = |v: &str| Job { vars: vec![("v".into(), v.into()), ("w".into(), "a,b".into())] };
        let jobs = [job("1"), job("2"), job("3")];
        let fine = Outcome {
            steps: 10,
            atoms: 5,
            row: vec![("step".into(), 10.0), ("pe".into(), 1e-7)],
            measures: vec![("c_k".into(), "0.5".into())],
            seconds: 2.0,
            ..Outcome::default()
        };
        let report = ["c_k".to_string()];
        let outcomes = [Some(fine), None, Some(Outcome::failed("no \"x\"", 0.5))];
        let wanted = "run,v,w,status,steps,atoms,step,pe,c_k,problem\n\
                      1,1,\"a,b\",ok,10,5,10,1e-7,0.5,\n\
                      2,2,\"a,b\",,,,,,,\n\
                      3,3,\"a,b\",failed,0,0,,,,\"no \"\"x\"\"\"\n";
        assert_eq!(csv(&jobs, &report, &outcomes), wanted);
        assert_eq!(times(&outcomes), "run,seconds,loop_seconds,threads\n1,2.000,0.000,0\n3,0.500,0.000,0\n");
        let text = text(&jobs, &report, &outcomes, 40, 2);
        assert!(text.lines().count() == 5 && text.contains("… 1 more"), "{text}");
        assert!(text.lines().take(4).all(|l| l.chars().count() <= 40), "{text}");
    }
}
