//! The subcommand `verify`: published cases, run here, with a verdict.

use super::args::Usage;
use super::{FAILED, OK, cases, show};
use crate::session;
use crate::verify::DECKS;
use crate::verify::case::Case;
use crate::verify::report::{self, Report};
use crate::verify::running::run_all;
use std::path::PathBuf;
use std::time::Instant;

/// The words of `verify`.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct Wanted {
    /// Print the cases instead of running them
    #[arg(long)]
    pub list: bool,
    /// Run the cases whose name or title holds PATTERN
    #[arg(long, value_name = "PATTERN")]
    pub only: Option<String>,
    /// Print the deck of each case instead of running it
    #[arg(long)]
    pub deck: bool,
    /// Run N cases at a time (all cores)
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Write the report as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write it as JUnit XML, for test servers
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write it as a web page with curves
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write it as Markdown
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

/// Runs the chosen cases; the exit code shows whether every number agrees with its source.
///
/// # Errors
/// A pattern that no case has, a file that cannot be written.
pub fn verify(wanted: &Wanted) -> Result<u8, Usage> {
    let pattern = wanted.only.as_deref().unwrap_or_default();
    let cases = cases::named(DECKS, pattern, "perigrain verify -list")?;
    if wanted.list {
        show(&report::list(&cases));
        return Ok(OK);
    }
    if wanted.deck {
        cases.iter().for_each(|case| show(&case.deck));
        return Ok(OK);
    }
    judged(cases, wanted)
}

/// Runs cases, shows and writes the results; the exit code shows whether anything failed.
fn judged(cases: Vec<Case>, wanted: &Wanted) -> Result<u8, Usage> {
    // Cases are small: several side by side are faster than one on several threads.
    let workers = session::set_threads(wanted.threads.unwrap_or(0));
    session::set_threads(1);
    let begin = Instant::now();
    let outcomes = run_all(cases, workers, |outcome| show(&report::of_case(outcome)));
    let report =
        Report { outcomes, machine: report::machine(), workers, seconds: begin.elapsed().as_secs_f64() };
    show(&report::summary(&report));
    write(wanted, &report)?;
    Ok(if report.is_well() { OK } else { FAILED })
}

/// Writes the requested reports.
fn write(wanted: &Wanted, report: &Report) -> Result<(), Usage> {
    type Make = fn(&Report) -> String;
    let all: [(&Option<PathBuf>, Make); 4] = [
        (&wanted.json, report::json),
        (&wanted.junit, report::junit),
        (&wanted.html, report::html),
        (&wanted.markdown, report::markdown),
    ];
    for (file, make) in all {
        let Some(file) = file else { continue };
        std::fs::write(file, make(report))
            .map_err(|e| Usage { message: format!("cannot write `{}`: {e}", file.display()), help: None })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::Headed;

    #[test]
    fn a_wrong_expectation_is_the_exit_code() {
        let wanted = Wanted { threads: Some(1), ..Wanted::default() };
        let expecting = |number: &str| {
            let head = "#| title = \"t\"\n#| about = \"a\"\n#| source = \"s\"\n#| [[check]]\n#| what = \"seven\"\n\
                        #| measure = \"v_seven\"\n#| tolerance = 1e-6\n#| why = \"w\"\n";
            let deck = format!("{head}#| expected = {number}\nvariable seven equal 7\n");
            Case::read("tests/planted", &deck).unwrap()
        };
        assert_eq!(judged(vec![expecting("7.0")], &wanted), Ok(OK));
        assert_eq!(judged(vec![expecting("7.0"), expecting("7.1")], &wanted), Ok(FAILED));
    }
}
