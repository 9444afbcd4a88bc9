//! What became of one run.

use super::record::{join, pairs, split, unpaired};
use std::path::PathBuf;

/// The outcome of one run, and its results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Why it failed, in one line; `None` if all went well.
    pub problem: Option<String>,
    /// Wall time from its start to its end [s].
    pub seconds: f64,
    /// Wall time of its steps, setups not included [s].
    pub loop_seconds: f64,
    /// Steps made, all runs of the deck together.
    pub steps: i64,
    /// Particles at the end.
    pub atoms: usize,
    /// Threads it had.
    pub threads: usize,
    /// The last row of the step table.
    pub row: Vec<(String, f64)>,
    /// What was to be reported, with the value as text.
    pub measures: Vec<(String, String)>,
    /// The files it has read, with their digests; its own are not among them.
    pub read: Vec<(PathBuf, String)>,
}

impl Outcome {
    /// A run of which nothing is known but why it failed.
    pub fn failed(problem: impl Into<String>, seconds: f64) -> Self {
        Self { problem: Some(problem.into()), seconds, ..Self::default() }
    }

    /// Whether all went well.
    pub fn is_ok(&self) -> bool {
        self.problem.is_none()
    }

    /// `ok` or `failed`.
    pub fn status(&self) -> &'static str {
        if self.is_ok() { "ok" } else { "failed" }
    }

    /// The value of a measure or of a column of the step table, if it is a number.
    pub fn value(&self, name: &str) -> Option<f64> {
        let measured = self.measures.iter().find(|(n, _)| n == name).and_then(|(_, v)| v.parse().ok());
        measured.or_else(|| self.row.iter().find(|(n, _)| n == name).map(|(_, v)| *v))
    }

    /// All of it as fields of a line.
    pub(super) fn fields(&self) -> Vec<String> {
        let row: Vec<_> = self.row.iter().map(|(n, v)| (n.clone(), format!("{v:?}"))).collect();
        let read: Vec<_> = self.read.iter().map(|(p, d)| (p.display().to_string(), d.clone())).collect();
        vec![
            self.status().into(),
            self.problem.clone().unwrap_or_default(),
            format!("{:?}", self.seconds),
            format!("{:?}", self.loop_seconds),
            self.steps.to_string(),
            self.atoms.to_string(),
            self.threads.to_string(),
            pairs(&row),
            pairs(&self.measures),
            pairs(&read),
        ]
    }

    /// What [`Outcome::fields`] wrote; `None` if it did not.
    pub(super) fn read(fields: &[String]) -> Option<Self> {
        let [status, problem, seconds, in_loops, steps, atoms, threads, row, measures, read] = fields else {
            return None;
        };
        let row = unpaired(row).into_iter().map(|(n, v)| Some((n, v.parse().ok()?)));
        Some(Self {
            problem: (status != "ok").then(|| problem.clone()),
            seconds: seconds.parse().ok()?,
            loop_seconds: in_loops.parse().ok()?,
            steps: steps.parse().ok()?,
            atoms: atoms.parse().ok()?,
            threads: threads.parse().ok()?,
            row: row.collect::<Option<_>>()?,
            measures: unpaired(measures),
            read: unpaired(read).into_iter().map(|(p, d)| (PathBuf::from(p), d)).collect(),
        })
    }
}

/// An outcome as the one line of a file that a worker leaves; `print` is the fingerprint of its run and sweep.
pub(super) fn sealed(print: &str, outcome: &Outcome) -> String {
    super::record::seal(&[print.to_owned(), join(&outcome.fields())])
}

/// The outcome that a worker left, if it is whole and of this run.
pub(super) fn opened(print: &str, line: &str) -> Option<Outcome> {
    match &super::record::open(line)?[..] {
        [of, fields] if of == print => Outcome::read(&split(fields)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_comes_back_to_the_bit() {
        let outcome = Outcome {
            problem: Some("in.x:3: no\ttab".into()),
            seconds: 0.1 + 0.2,
            loop_seconds: 1e-300,
            steps: 7,
            atoms: 3,
            threads: 2,
            row: vec![("step".into(), 7.0), ("pe".into(), f64::NAN)],
            measures: vec![("v_name".into(), "a b".into()), ("c_k".into(), "0.25".into())],
            read: vec![("/a/b".into(), "1-2".into())],
        };
        let back = opened("x", &sealed("x", &outcome)).unwrap();
        assert_eq!(format!("{back:?}"), format!("{outcome:?}"));
        assert_eq!(
            (back.value("c_k"), back.value("step"), back.value("v_name")),
            (Some(0.25), Some(7.0), None)
        );
        assert!(opened("y", &sealed("x", &outcome)).is_none());
        let fine = Outcome { problem: None, ..outcome };
        assert!(opened("x", &sealed("x", &fine)).unwrap().is_ok());
    }
}
