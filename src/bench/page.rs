//! The suite's findings as a page of the manual, with pictures beside it.

use super::suite::{Case, Manner};
use super::{Bench, Found, picture, table};
use crate::plot::Chart;
use crate::verify::report::{machine, origin};
use perigrain_base::math::cformat::general;
use std::fmt::Write;

/// A case that was run.
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Its runs and their results; an error if they could not be made.
    pub found: Result<(Bench, Found), String>,
}

/// A picture's file name and the picture.
pub type Picture = (String, Chart);

/// The page, and the pictures that it shows from the folder `pictures`.
pub fn markdown(outcomes: &[Outcome], manner: &Manner, pictures: &str) -> (String, Vec<Picture>) {
    let lammps = manner.lammps.as_ref().map(|_| version(outcomes).unwrap_or_else(|| "LAMMPS".into()));
    let beside = lammps.map_or(String::new(), |version| format!(" Beside it {version} on the same decks."));
    let many = match manner.repeat {
        Some(1) => "once".into(),
        Some(n) => format!("{n} times, the least time counts"),
        None => format!("until its runs have taken {:.0} ms, the least time counts", 1e3 * super::LEAST),
    };
    let mut out = format!(
        "# Benchmarks\n\nWall time against error over time steps, spacings, horizons and lengths of steps, as `perigrain bench -suite` \
         wrote it: [what the command does](styles/bench.md).\n\n{}, {} thread{}, one run at a time, each {many}. \
         Seconds are the wall time of the steps, setups not included. An error with a star is on the Pareto front: no other setting is both faster and \
         nearer. Orders are observed over a line and the two before along a knob, positive where the error falls; that a reference run has an error, too, is \
         reckoned with, and `~` marks an order whose two halves differ by more than a half.{beside}\n",
        origin(&machine()),
        manner.threads,
        if manner.threads == 1 { "" } else { "s" },
    );
    let mut drawn = vec![];
    for outcome in outcomes {
        out += &of_case(outcome, manner, pictures, &mut drawn);
    }
    (out, drawn)
}

fn of_case(outcome: &Outcome, manner: &Manner, pictures: &str, drawn: &mut Vec<Picture>) -> String {
    let case = &outcome.case;
    let mut out = format!(
        "\n## {}\n\n{} (`{}`)\n\nTheory: {}\n\n",
        plain(&case.title),
        plain(&case.about),
        case.name,
        plain(&case.theory)
    );
    let (bench, found) = match &outcome.found {
        Ok(found) => found,
        Err(why) => {
            let _ = writeln!(out, "It could not be run: {}", plain(why));
            return out;
        }
    };
    let against: Vec<String> = bench
        .measures
        .iter()
        .map(|m| format!("{} against {}, norm {}", plain(&m.name), m.against.describe(), m.norm.name()))
        .collect();
    let _ = write!(out, "Errors: {}.\n\n", against.join("; "));
    let (head, rows) = table::cells(bench, found);
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|c| plain(c)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    out += &line(&head);
    let _ = writeln!(out, "|{}", "---|".repeat(head.len()));
    rows.iter().for_each(|row| out += &line(row));
    for (k, chart) in picture::charts(bench, found).into_iter().enumerate() {
        let Some(chart) = chart else { continue };
        let name = format!("{}-{}.svg", case.name, k + 1);
        let _ = write!(out, "\n![{}]({pictures}/{name})\n", plain(&chart.title));
        drawn.push((name, chart));
    }
    out += "\n";
    out += &match (&case.lammps.no, case.has_lammps(manner)) {
        (Some(why), _) => format!("LAMMPS cannot run this deck: {}.\n", plain(why)),
        (None, true) => beside(bench, found),
        (None, false) => "LAMMPS can run this deck (`-lammps PATH`).\n".into(),
    };
    let failures = found.failures.iter().map(String::as_str);
    let problems: Vec<&str> = found.problems.0.iter().map(|d| d.message.as_str()).chain(failures).collect();
    if !problems.is_empty() {
        let _ = write!(out, "\nWhat went wrong:\n\n```text\n{}\n```\n", problems.join("\n"));
    }
    out
}

/// How LAMMPS' numbers and times compare, setting by setting.
pub fn beside(bench: &Bench, found: &Found) -> String {
    let half = found.points.len() / 2;
    let (ours, theirs) = found.points.split_at(half);
    let times = ours.iter().zip(theirs).filter_map(|(a, b)| Some(b.seconds? / a.seconds?));
    let ends = times.map(|r| (r, r)).reduce(|(a, b), (r, _)| (a.min(r), b.max(r)));
    let mut out = match ends {
        Some((least, most)) => {
            let [least, most] = [least, most].map(|r| general(r, 2));
            format!("LAMMPS takes {least} to {most} times as long for the same settings.")
        }
        None => return "LAMMPS gave no numbers.\n".into(),
    };
    let difference = |k: usize| {
        let pairs =
            ours.iter().zip(theirs).filter_map(|(a, b)| Some((a.errors[k].value?, b.errors[k].value?)));
        pairs.map(|(a, b)| (a - b).abs() / a.abs().max(f64::MIN_POSITIVE)).reduce(f64::max)
    };
    let differences: Vec<String> = bench
        .measures
        .iter()
        .enumerate()
        .filter_map(|(k, m)| Some(format!("{:.0e} of {}", difference(k)?, plain(&m.name))))
        .collect();
    if !differences.is_empty() {
        let _ = write!(out, " Values at the end differ by at most {}.", differences.join(", "));
    }
    out + "\n"
}

/// The first line of a LAMMPS' log.
fn version(outcomes: &[Outcome]) -> Option<String> {
    let benches = outcomes.iter().filter_map(|o| o.found.as_ref().ok());
    let run =
        benches.flat_map(|(b, _)| (0..b.settings()).filter(|k| b.is_lammps(*k)).map(move |k| (b, k))).next();
    let (bench, job) = run?;
    let log = crate::sweep::home_of(&bench.sweep, job).join("log.lammps");
    Some(std::fs::read_to_string(log).ok()?.lines().next()?.trim().to_owned())
}

/// A text with the signs that Markdown would take for its own.
fn plain(text: &str) -> String {
    text.replace('|', "\\|").replace('*', "\\*").replace('_', "\\_").replace('\n', " ")
}
