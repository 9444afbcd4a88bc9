//! The content of a log, LAMMPS' or perigrain's.

use super::{Ended, Weight};
use crate::sweep::lammps;
use perigrain_output::rows::Tables;

/// So many lines a message has at most.
const LINES: usize = 14;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct LogContent {
    /// The step tables.
    pub tables: Tables,
    /// Program and threads.
    pub origin: String,
    /// How it ended.
    pub ended: Ended,
    /// Warnings and notes.
    pub messages: Vec<(Weight, String)>,
    /// Steps made.
    pub steps: i64,
    /// Time that they took [s].
    pub seconds: f64,
    /// Particles at the end.
    pub atoms: usize,
    /// What is odd about it.
    pub remark: Option<String>,
}

/// Reads a log.
pub fn read(text: &str) -> LogContent {
    let content = lammps::read(text);
    let lines: Vec<&str> = text.lines().collect();
    let known = |line: &&&str| line.starts_with("perigrain ") || line.starts_with("LAMMPS (");
    let origin = lines.iter().take(3).find(known).map_or(String::new(), |l| l.trim().to_string());
    let (mut messages, mut error) = (vec![], None);
    for (k, line) in lines.iter().enumerate() {
        let begins = |words: &[&str]| words.iter().any(|w| line.starts_with(w));
        if begins(&["warning[", "WARNING"]) {
            messages.push((Weight::Warning, message(&lines[k..])));
        } else if begins(&["note["]) {
            messages.push((Weight::Note, message(&lines[k..])));
        } else if begins(&["error[", "ERROR"]) && error.is_none() {
            error = Some(message(&lines[k..]));
        }
    }
    let whole = text.contains("Total wall time:");
    let interrupted = lines.iter().any(|l| l.starts_with("Interrupted at step "));
    let remark = (error.is_none() && !whole)
        .then(|| "it has no end: the run is still in progress, or was broken off".to_string());
    let ended = match error {
        Some(why) => Ended::Failed(why),
        None if interrupted => Ended::Interrupted,
        None if whole => Ended::Well,
        None => Ended::Unknown,
    };
    let (steps, seconds, atoms) = (content.steps, content.loop_seconds, content.atoms);
    LogContent { tables: content.tables, origin, ended, messages, steps, seconds, atoms, remark }
}

/// A message with the lines that belong to it: perigrain's ends with an empty one, LAMMPS' has one.
fn message(lines: &[&str]) -> String {
    let first = lines[0];
    if !first.contains("[PG") {
        return first.to_string();
    }
    // The lines of the deck have numbers, all others are indented.
    let numbered =
        |line: &str| line.trim_start().split_once(" |").is_some_and(|(n, _)| n.parse::<u64>().is_ok());
    let belongs = |line: &&&str| !line.trim().is_empty() && (line.starts_with(' ') || numbered(line));
    std::iter::once(&first)
        .chain(lines[1..].iter().take(LINES).take_while(belongs))
        .copied()
        .collect::<Vec<_>>()
        .join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_has_its_end_and_its_warnings() {
        let text = "LAMMPS (22 Jul 2025)\nWARNING: odd\n   Step          KinEng\n  0  1.5\n  10  1.25\n\
                    Loop time of 0.5 on 1 procs for 10 steps with 7 atoms\nTotal wall time: 0:00:01\n";
        let content = read(text);
        assert_eq!(
            (content.ended, content.origin.as_str(), content.remark),
            (Ended::Well, "LAMMPS (22 Jul 2025)", None)
        );
        assert_eq!(
            (content.atoms, content.steps, content.messages),
            (7, 10, vec![(Weight::Warning, "WARNING: odd".into())])
        );
        let text = "perigrain 0.1.0 (2 thread(s))\nwarning[PG0301]: w\n --> in.a:1:2\n\nerror[PG0102]: no\n  = help: h\n\nmore\n";
        let content = read(text);
        assert_eq!(content.ended, Ended::Failed("error[PG0102]: no\n  = help: h".into()));
        assert_eq!(content.messages, [(Weight::Warning, "warning[PG0301]: w\n --> in.a:1:2".into())]);
        let content = read("Step KinEng\n0 1\n1 2\n");
        assert_eq!((content.ended, content.tables.0[0].rows.len()), (Ended::Unknown, 2));
        assert!(content.remark.unwrap().contains("no end"));
        assert!(read("").tables.0.is_empty());
    }
}
