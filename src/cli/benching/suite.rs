//! `perigrain bench -suite`: the benches that the program carries.

use crate::bench::page::{self, Outcome};
use crate::bench::suite::{Case, DECKS, Manner};
use crate::bench::{Bench, table};
use crate::cli::args::{Options, Usage};
use crate::cli::sweeping::{listen, serve};
use crate::cli::{FAILED, INTERRUPTED, OK, cases, deck, ranks, show};
use crate::sweep::ranks::Ranks;
use crate::sweep::starter::Starter;
use perigrain_base::diag::Sources;
use perigrain_output::file::replace;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The words of the suite.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Parser)]
#[command(name = "perigrain bench")]
pub struct Wanted {
    /// Run the benches that the program carries
    #[arg(long)]
    pub suite: bool,
    /// Print the cases instead of running them
    #[arg(long)]
    pub list: bool,
    /// Run the cases whose name or title holds PATTERN
    #[arg(long, value_name = "PATTERN")]
    pub only: Option<String>,
    /// Print the deck of each case instead of running it
    #[arg(long)]
    pub deck: bool,
    /// Let this LAMMPS run the decks too, where it can
    #[arg(long, value_name = "PATH")]
    pub lammps: Option<PathBuf>,
    /// Threads of each run (1)
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Run each setting N times, the least time counts (until its runs have taken 50 ms)
    #[arg(long, value_name = "N")]
    pub repeat: Option<usize>,
    /// Where the runs are (bench.suite)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Discard earlier runs there
    #[arg(long)]
    pub anew: bool,
    /// Share the runs out to N processes of this machine, as `mpirun -n N` does
    #[arg(long, value_name = "N")]
    pub ranks: Option<usize>,
    /// Write the findings as a page, with its pictures in a folder of its name
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

/// Runs the chosen cases; the exit code shows whether every run went well.
///
/// # Errors
/// A pattern that no case has, a missing LAMMPS, a file that cannot be written, ranks that cannot be joined.
pub fn perform(wanted: &Wanted) -> Result<u8, Usage> {
    let options = Options { ranks: wanted.ranks, ..Options::default() };
    ranks::shared_out(&options, |ranks| first(wanted, ranks), serve)
}

fn first(wanted: &Wanted, ranks: Option<Ranks>) -> Result<u8, Usage> {
    let pattern = wanted.only.as_deref().unwrap_or_default();
    let cases: Vec<Case> = cases::named(DECKS, pattern, "perigrain bench -suite -list")?;
    if wanted.list {
        let wide = cases.iter().map(|c| c.name.len()).max().unwrap_or(0);
        cases.iter().for_each(|c| show(&format!("{:<wide$}  {}\n", c.name, c.title)));
        return Ok(OK);
    }
    if wanted.deck {
        cases.iter().for_each(|case| show(&case.deck));
        return Ok(OK);
    }
    let manner = Manner { ranks, ..manner(wanted)? };
    if let Some(ranks) = &manner.ranks {
        show(&format!("the runs are shared out to {}\n", ranks.describe()));
    }
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop);
    let (mut outcomes, mut well) = (vec![], true);
    let n = cases.len();
    for (k, case) in cases.into_iter().enumerate() {
        show(&format!("\n{} of {n}  {}: {}\n", k + 1, case.name, case.title));
        match one(&case, &manner, wanted.anew, &stop) {
            Ok(None) => {
                show("interrupted: the same command continues\n");
                return Ok(INTERRUPTED);
            }
            Ok(Some((bench, found, fine))) => {
                well &= fine;
                outcomes.push(Outcome { case, found: Ok((bench, found)) });
            }
            Err(problems) => {
                deck::print(&problems, &Sources::default());
                well = false;
                let why = problems.0.first().map_or(String::new(), |d| d.message.clone());
                outcomes.push(Outcome { case, found: Err(why) });
            }
        }
    }
    if let Some(file) = &wanted.markdown {
        write(file, &outcomes, &manner)?;
    }
    Ok(if well { OK } else { FAILED })
}

fn manner(wanted: &Wanted) -> Result<Manner, Usage> {
    let lammps =
        wanted.lammps.as_ref().map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone()));
    if let Some(path) = lammps.as_ref().filter(|path| !path.is_file()) {
        return Err(Usage::new(format!("there is no LAMMPS `{}`", path.display()))
            .help("give the path of its program"));
    }
    let program =
        Starter::itself().map_err(|e| Usage::new(format!("the program does not find itself: {e}")))?;
    Ok(Manner {
        folder: wanted.out.clone().unwrap_or_else(|| "bench.suite".into()),
        threads: wanted.threads.unwrap_or(1).max(1),
        repeat: wanted.repeat.map(|n| n.max(1)),
        lammps,
        program,
        reports_progress: std::io::stderr().is_terminal(),
        ranks: None,
    })
}

type Ran = Option<(Bench, crate::bench::Found, bool)>;

/// Runs a case and shows its table; `None` if it was interrupted. The last value is whether all went well.
fn one(case: &Case, manner: &Manner, anew: bool, stop: &AtomicBool) -> perigrain_base::diag::Result<Ran> {
    let bench = case.bench(manner)?;
    let (results, found) = super::measured(&bench, anew, false, stop)?;
    let Some(found) = found else { return Ok(None) };
    table::write(&bench, &found)?;
    show(&format!("\n{}", table::text(&bench, &found, 160, 60)));
    if case.has_lammps(manner) {
        show(&page::beside(&bench, &found));
    } else if let (Some(why), true) = (&case.lammps.no, manner.lammps.is_some()) {
        show(&format!("LAMMPS cannot run this deck: {why}\n"));
    }
    super::complain(&found);
    let fine = found.is_whole() && results.all_ok();
    Ok(Some((bench, found, fine)))
}

/// Writes the page and its pictures.
fn write(file: &Path, outcomes: &[Outcome], manner: &Manner) -> Result<(), Usage> {
    let beside = file.with_extension("");
    let folder = beside.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let (text, pictures) = page::markdown(outcomes, manner, &folder);
    let fault = |e: &dyn std::fmt::Display| Usage::new(format!("cannot write `{}`: {e}", file.display()));
    std::fs::create_dir_all(&beside).map_err(|e| fault(&e))?;
    for (name, chart) in &pictures {
        let svg = chart.svg();
        replace(&beside.join(name), |w| w.write_all(svg.as_bytes())).map_err(|e| fault(&e))?;
    }
    replace(file, |w| w.write_all(text.as_bytes())).map_err(|e| fault(&e))
}
