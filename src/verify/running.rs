//! Cases at work: each deck in a session of its own, several at a time, and what came out beside what was to.

use super::case::{Case, Check, Expected, Size};
use crate::session::{Options, Session};
use perigrain_base::diag::render;
use perigrain_base::par::STACK;
use perigrain_output::log::{Buffer, Log};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within the tolerance.
    Passed,
    /// Outside of it, by as much as is known and explained.
    Known,
    /// Outside of it.
    Failed,
}

impl Verdict {
    /// Its word in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Known => "known deviation",
            Self::Failed => "FAILED",
        }
    }
}

/// A check with its numbers.
#[derive(Clone, Debug)]
pub struct Row {
    /// The check.
    pub check: Check,
    /// The expected number, the middle of a range; NaN where none came out.
    pub expected: f64,
    /// Ours.
    pub ours: f64,
    /// Their distance, in the terms of the tolerance; in a range from its middle, its end being 1.
    pub deviation: f64,
    /// How far it may be off.
    pub tolerance: f64,
    /// Which point of a curve this is.
    pub at: Option<f64>,
    /// Of how many it is the worst.
    pub points: usize,
    /// The outcome.
    pub verdict: Verdict,
}

/// A point of a curve: x, ours, expected.
pub type Point = (f64, f64, Option<f64>);

/// A case that was run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Its checks.
    pub rows: Vec<Row>,
    /// The points of its curves, in their order.
    pub points: Vec<Vec<Point>>,
    /// Why the deck did not come to its end.
    pub failure: Option<String>,
    /// Time taken [s].
    pub seconds: f64,
}

impl Outcome {
    /// The number of checks that ended so.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }
}

/// Runs cases, up to `workers` at a time; `report` receives each outcome as the case ends. Outcomes come in the order of the cases.
pub fn run_all(cases: Vec<Case>, workers: usize, report: impl Fn(&Outcome) + Sync) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Outcome)>> = Mutex::default();
    let work = || {
        while let Some((at, case)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            cases.get(at).map(|case| (at, case))
        } {
            let outcome = run(case);
            report(&outcome);
            done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((at, outcome));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            // Where the system grants no more threads, those that run do the rest.
            drop(std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work));
        }
    });
    work();
    let mut done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, outcome)| outcome).collect()
}

/// Runs a case; a deck that fails, or ends the code that runs it, fails all its checks.
pub fn run(case: &Case) -> Outcome {
    let begin = Instant::now();
    let attempt = catch_unwind(AssertUnwindSafe(|| measured(case)));
    let outcome =
        attempt.unwrap_or_else(|_| Err("the program ended itself here: a fault of perigrain".into()));
    let seconds = begin.elapsed().as_secs_f64();
    let nothing = |check: &Check| row(check, (f64::NAN, f64::NAN), None, 1.0);
    let (rows, points, failure) = match outcome {
        Ok((rows, points)) => (rows, points, None),
        Err(output) => {
            (case.check.iter().map(nothing).collect(), vec![vec![]; case.curve.len()], Some(output))
        }
    };
    Outcome { case: case.clone(), rows, points, failure, seconds }
}

type Measured = (Vec<Row>, Vec<Vec<Point>>);

/// Executes the deck and evaluates the numbers.
fn measured(case: &Case) -> Result<Measured, String> {
    let screen = Buffer::default();
    let log = Log::new(Some(Box::new(screen.clone())));
    let mut session = Session::new(Options { log, ..Options::default() }).map_err(|e| e.to_string())?;
    if let Err(e) = session.run_text(&format!("{}.in", case.name), &case.deck) {
        return Err(render::plain(&e, &session.sources));
    }
    let points = curves(case, &screen.text())?;
    let mut number = |formula: &str| -> Result<f64, String> {
        let value = session.measure(formula).map_err(|e| render::plain(&e, &session.sources))?;
        value.trim().parse().map_err(|_| format!("`{formula}` is no number"))
    };
    let mut rows = vec![];
    for check in &case.check {
        let curve = check.curve.as_ref().and_then(|name| case.curve.iter().position(|c| c.name == *name));
        if let Some(at) = curve {
            rows.push(worst(check, &points[at])?);
            continue;
        }
        let expected = match &check.expected {
            Some(Expected::Number(expected)) => *expected,
            Some(Expected::Range([low, high])) => 0.5 * (low + high),
            Some(Expected::Formula(formula)) => number(formula)?,
            None => return Err(format!("`{}` expects nothing", check.what)),
        };
        rows.push(row(check, (expected, number(&check.measure)?), None, 1.0));
    }
    Ok((rows, points))
}

/// The points of every curve, from the lines the deck printed.
fn curves(case: &Case, output: &str) -> Result<Vec<Vec<Point>>, String> {
    let mut all = vec![vec![]; case.curve.len()];
    for line in output.lines().filter_map(|line| line.strip_prefix("curve ")) {
        let mut words = line.split_whitespace();
        let name = words.next().unwrap_or_default();
        let Some(at) = case.curve.iter().position(|c| c.name == name) else {
            return Err(format!("`curve {line}` belongs to no curve"));
        };
        let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
        match numbers[..] {
            [x, ours] => all[at].push((x, ours, None)),
            [x, ours, expected] => all[at].push((x, ours, Some(expected))),
            _ => return Err(format!("`curve {line}` is no point")),
        }
    }
    Ok(all)
}

/// The row of the point of a curve that is farthest from what was expected.
fn worst(check: &Check, points: &[Point]) -> Result<Row, String> {
    let largest = points.iter().filter_map(|p| p.2).fold(0.0, |most: f64, e| most.max(e.abs()));
    let rows = points
        .iter()
        .filter_map(|&(x, ours, expected)| Some(row(check, (expected?, ours), Some(x), largest)));
    // A distance that is no number is the worst.
    let distance = |row: &Row| if row.deviation.is_nan() { f64::INFINITY } else { row.deviation.abs() };
    let count = rows.clone().count();
    let found = rows.max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let found = found.map(|worst| Row { points: count, ..worst });
    found.ok_or_else(|| format!("`{}`: the curve has no expected points", check.what))
}

/// Judges one number. `largest` is the largest expected number of a curve.
fn row(check: &Check, (expected, ours): (f64, f64), at: Option<f64>, largest: f64) -> Row {
    let size = match check.of {
        Size::Expected => expected.abs(),
        Size::Largest => largest,
        Size::One => 1.0,
    };
    let (size, tolerance) = match check.expected {
        Some(Expected::Range([low, high])) => (0.5 * (high - low), 1.0),
        _ => (size, check.tolerance),
    };
    let deviation = (ours - expected) / size;
    let is_known = check.known.as_ref().is_some_and(|k| (ours - k.ours).abs() <= k.within * k.ours.abs());
    let verdict = match (deviation.abs() <= tolerance, is_known) {
        (true, _) => Verdict::Passed,
        (false, true) => Verdict::Known,
        (false, false) => Verdict::Failed,
    };
    Row { check: check.clone(), expected, ours, deviation, tolerance, at, points: 1, verdict }
}

#[cfg(test)]
#[path = "running_tests.rs"]
mod tests;
