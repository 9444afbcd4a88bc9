//! What a verification found, as text for people, JSON and JUnit XML for programs, a web page and a page of the manual.

mod html;
mod json;
mod junit;
mod markdown;
mod text;

pub use html::html;
pub use json::json;
pub use junit::junit;
pub use markdown::markdown;
pub use text::{list, of_case, summary};

use super::case::Expected;
use super::running::{Outcome, Row, Verdict};

/// All outcomes, and where they come from.
pub struct Report {
    /// The cases in their order.
    pub outcomes: Vec<Outcome>,
    /// Processor, cores, system.
    pub machine: String,
    /// Cases run at a time.
    pub workers: usize,
    /// Time from the first to the last [s].
    pub seconds: f64,
}

impl Report {
    /// The number of checks that ended so.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.outcomes.iter().map(|o| o.count(verdict)).sum()
    }

    /// Whether nothing failed.
    pub fn is_well(&self) -> bool {
        self.count(Verdict::Failed) == 0
    }

    /// The verdict in one line.
    pub fn verdict(&self) -> String {
        format!(
            "{} checks of {} cases: {} passed, {} known deviations, {} failed",
            self.outcomes.iter().map(|o| o.rows.len()).sum::<usize>(),
            self.outcomes.len(),
            self.count(Verdict::Passed),
            self.count(Verdict::Known),
            self.count(Verdict::Failed)
        )
    }

    /// Program, version and machine in one line.
    pub fn origin(&self) -> String {
        origin(&self.machine)
    }
}

/// Program, version and a machine in one line.
pub fn origin(machine: &str) -> String {
    let kind = if cfg!(debug_assertions) { ", debug build" } else { "" };
    format!("perigrain {}{kind}, {machine}", env!("CARGO_PKG_VERSION"))
}

/// The machine in a few words.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':'));
    let model = model.map_or(std::env::consts::ARCH, |(_, model)| model.trim());
    format!("{model}, {cores} cores, {}", std::env::consts::OS)
}

/// A number with the digits that matter here.
fn number(value: f64) -> String {
    if value != 0.0 && value.is_finite() && !(1e-3..1e6).contains(&value.abs()) {
        let text = format!("{value:.6e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    // Seven digits in all.
    let digits = if value == 0.0 { 1 } else { (6.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize };
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// A deviation or tolerance.
fn part(value: f64) -> String {
    format!("{value:.1e}")
}

/// What was expected, with its unit.
fn expected(row: &Row) -> String {
    let value = match row.check.expected {
        Some(Expected::Range([low, high])) => format!("{} to {}", number(low), number(high)),
        _ => number(row.expected),
    };
    format!("{value} {}", row.check.unit).trim_end().to_string()
}

/// What was measured, and at which point of a curve.
fn what(outcome: &Outcome, row: &Row) -> String {
    let curve = row.check.curve.as_ref().and_then(|name| outcome.case.curve.iter().find(|c| c.name == *name));
    match (row.at, curve) {
        (Some(at), Some(curve)) => {
            let axis = curve.x.split(',').next().unwrap_or_default();
            format!("{} (worst of {} points, at {axis} = {})", row.check.what, row.points, number(at))
        }
        _ => row.check.what.clone(),
    }
}

/// Where the expected number of a row stands.
fn source<'a>(outcome: &'a Outcome, row: &'a Row) -> &'a str {
    row.check.source.as_deref().unwrap_or(&outcome.case.source)
}

#[cfg(test)]
mod tests;
