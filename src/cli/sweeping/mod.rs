//! `perigrain sweep`: many runs of one deck, each with other values of variables, and one table.

pub mod args;
pub(super) mod show;

use super::args::{Deck, Target, Usage};
use super::pager::width;
use super::progress::Tally;
use super::{FAILED, INTERRUPTED, OK, deck, ranks, signals};
use crate::human::duration;
use crate::session::axes::{Axis, combined, zip};
use crate::session::{Mode, Swept, folder_of};
use crate::sweep::ranks::Ranks;
use crate::sweep::starter::Starter;
use crate::sweep::{self, Job, Results, Settings, Standing, Sweep, table};
use args::{List, Request};
use perigrain_base::diag::{Code, Diagnostics, Result, Sources, fail};
use perigrain_base::letters;
use perigrain_output::log::Log;
use show::Show;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the folder of a deck's sweep ends in.
const ENDING: &str = "sweep";
/// Rows of the table that are shown at the end.
const SHOWN: usize = 40;
/// Characters of its lines where no terminal has fewer.
const WIDTH: usize = 160;

/// Makes the runs, or prints their state; the exit code. Of several ranks the first one does so, and the others make runs for it.
///
/// # Errors
/// Lists of values that make no sense, ranks that cannot be joined.
pub fn perform(request: &Request) -> std::result::Result<u8, Usage> {
    ranks::shared_out(&request.options, |ranks| first(request, ranks), serve)
}

/// Makes runs for the first rank until it sends this one home; the exit code.
pub(super) fn serve(ranks: &Ranks) -> u8 {
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop);
    sweep::ranks::serve(ranks, &stop)
}

fn first(request: &Request, ranks: Option<Ranks>) -> std::result::Result<u8, Usage> {
    if request.status {
        return Ok(exit_code(status(&request.folder(ENDING)), &Sources::default()));
    }
    let mut sources = Sources::default();
    let axes = match axes(request, &mut sources) {
        Ok(axes) => Swept { axes, report: vec![] },
        Err(problems) if problems.0.iter().all(|d| d.span.is_none() && d.code != Code::NO_FILE) => {
            return Err(usage(problems));
        }
        Err(problems) => return Ok(exit_code(Err(problems), &sources)),
    };
    let text = match deck::read(&request.options.deck) {
        Ok((_, text)) => text,
        Err(problems) => return Ok(exit_code(Err(problems), &sources)),
    };
    let swept = match of_deck(request, axes, &text, &mut sources) {
        Ok(swept) => swept,
        Err(problems) => return Ok(exit_code(Err(problems), &sources)),
    };
    if swept.axes.is_empty() {
        let usage = Usage::new("a sweep needs values to go through");
        return Err(usage.help(
            "as `-each v 10 20 30`, a table of runs, `-table runs.csv`, or a `sweep` line in the deck",
        ));
    }
    let sweep = match prepared(request, swept, text) {
        Ok(sweep) => Sweep { ranks, ..sweep },
        Err(problems) => return Ok(exit_code(Err(problems), &Sources::default())),
    };
    let ahead = sweep::look_ahead(&sweep);
    if ahead.problems.has_errors() {
        return Ok(exit_code(Err(ahead.problems), &ahead.sources));
    }
    Ok(exit_code(run(request, &sweep), &Sources::default()))
}

/// The first of some problems, as one of the command line.
pub(super) fn usage(problems: Diagnostics) -> Usage {
    let first = problems.0.into_iter().next();
    first.map_or_else(
        || Usage::new("no runs"),
        |d| Usage { message: d.message, help: d.help.into_iter().next() },
    )
}

/// The exit code; problems are printed.
pub(super) fn exit_code(outcome: Result<u8>, sources: &Sources) -> u8 {
    outcome.unwrap_or_else(|problems| {
        deck::print(&problems, sources);
        FAILED
    })
}

/// The lists of values, tied by `-zip`.
pub(super) fn axes(request: &Request, sources: &mut Sources) -> Result<Vec<Axis>> {
    let mut axes = vec![];
    for list in &request.lists {
        axes.push(match list {
            List::Each(name, words) => Axis::each(name, words)?,
            List::Table(path) => {
                let text = match std::fs::read_to_string(path) {
                    Ok(text) => text,
                    Err(e) => {
                        let text = format!("cannot read the table `{}`: {e}", path.display());
                        return fail(Code::NO_FILE, None, text);
                    }
                };
                let name = path.display().to_string();
                // Spreadsheets begin their files with a byte order mark.
                let (text, odd) = letters::plain_data(text);
                if let Some(note) = letters::note_of_file(&name, &text, &odd) {
                    deck::print(&note.into(), sources);
                }
                let file = sources.add(name, text.as_str());
                Axis::table(&text, file)?
            }
        });
    }
    for names in &request.zips {
        zip(&mut axes, names)?;
    }
    combined(&axes)?;
    Ok(axes)
}

/// What the deck's own `sweep` line adds: its lists if the command line has none, and what it reports.
pub(super) fn of_deck(request: &Request, given: Swept, text: &str, sources: &mut Sources) -> Result<Swept> {
    let mut swept = given;
    if text.lines().any(|line| line.split_whitespace().next() == Some("sweep")) {
        let mut session = deck::begin(&request.options, Mode::Check, &Log::silent())?;
        let checked = session.run_text(&deck::name(&request.options.deck), text);
        sources.clone_from(&session.sources);
        match session.swept() {
            Some(own) if swept.axes.is_empty() => swept = own.clone(),
            Some(own) => swept.report.clone_from(&own.report),
            None => drop(checked?),
        }
    }
    let more = request.report.iter().filter(|word| !swept.report.contains(word)).cloned().collect::<Vec<_>>();
    swept.report.extend(more);
    Ok(swept)
}

/// The runs, with the deck as it is now.
pub(super) fn prepared(request: &Request, swept: Swept, text: String) -> Result<Sweep> {
    let o = &request.options;
    let name = deck::name(&o.deck);
    let beside = match &o.deck {
        Deck::Stdin => Default::default(),
        Deck::File(path) => folder_of(path),
    };
    let beside = if beside.as_os_str().is_empty() { Path::new(".").to_owned() } else { beside };
    let program = match Starter::itself() {
        Ok(program) => program,
        Err(e) => return fail(Code::NO_FILE, None, format!("the program does not find itself: {e}")),
    };
    Ok(Sweep {
        deck: sweep::Deck { name, text, folder: std::path::absolute(&beside).unwrap_or(beside) },
        jobs: Job::all(&swept.axes)?,
        report: swept.report,
        settings: Settings {
            vars: o.vars.clone(),
            compat: o.compat,
            force_list: o.list_layout,
            no_skipping: o.no_skipping,
            portable: o.portable,
            ..Settings::default()
        },
        folder: request.folder(ENDING),
        at_once: request.jobs.unwrap_or(0),
        threads: o.threads.unwrap_or(0),
        retry: request.retry,
        program,
        reports_progress: std::io::stderr().is_terminal() && o.screen != Target::None,
        ranks: None,
    })
}

fn run(request: &Request, sweep: &Sweep) -> Result<u8> {
    let quiet = request.options.screen == Target::None;
    let mut show = Show { jobs: &sweep.jobs, quiet, tally: Tally::default() };
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop);
    if let Some(idle_ranks) = sweep.ranks.as_ref().and_then(|ranks| idle(ranks, sweep.jobs.len())) {
        show.print(&idle_ranks);
    }
    let results = sweep::execute(sweep, request.anew, &mut show, &stop);
    show.tally.clear();
    let results = results?;
    if !quiet {
        super::show(&ending(sweep, &results));
    }
    Ok(match &results {
        r if r.interrupted => INTERRUPTED,
        r if r.all_ok() => OK,
        _ => FAILED,
    })
}

/// A line where ranks outnumber the runs.
pub(super) fn idle(ranks: &Ranks, runs: usize) -> Option<String> {
    let more = ranks.size().checked_sub(runs).filter(|more| *more > 0)?;
    let have = if more == 1 { "1 rank has".into() } else { format!("{more} ranks have") };
    Some(format!(
        "{}, {runs} run{}: {have} nothing to do",
        ranks.describe(),
        if runs == 1 { "" } else { "s" }
    ))
}

/// The first Ctrl-C or request to end stops all runs, the second one the program at once.
pub(super) fn listen(stop: &Arc<AtomicBool>) {
    let stop = stop.clone();
    let ask = move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    };
    signals::listen(ask.clone());
    // Without a handler Ctrl-C ends the program as it always did, and its runs with it.
    let _ = ctrlc::set_handler(ask);
}

/// The table and where it is.
fn ending(sweep: &Sweep, results: &Results) -> String {
    let mut text = table::text(&sweep.jobs, &sweep.report, &results.outcomes, width(WIDTH), SHOWN);
    let place = sweep.folder.join(table::TABLE);
    text += &format!("{}: {}\n", place.display(), counts(results));
    if results.interrupted {
        text += "interrupted: the same command continues\n";
    }
    text
}

/// `7 runs ok, 1 failed, 2 left`.
pub(super) fn counts(results: &Results) -> String {
    let ended = || results.outcomes.iter().flatten();
    let ok = ended().filter(|o| o.is_ok()).count();
    let (failed, left) = (ended().count() - ok, results.outcomes.len() - ended().count());
    let mut text = format!("{ok} run{} ok", if ok == 1 { "" } else { "s" });
    for (n, word) in [(failed, "failed"), (left, "left")] {
        if n > 0 {
            text += &format!(", {n} {word}");
        }
    }
    text
}

/// Prints the state of the sweep in a folder.
pub(super) fn status(folder: &Path) -> Result<u8> {
    let Standing { deck, jobs, report, results, running, left } = sweep::look(folder)?;
    let mut work = running.map_or("not at work".into(), |n| format!("at work on {n}"));
    if let Some(left) = left {
        work += &format!(", {} to go", duration(left.as_secs_f64()));
    }
    let mut text = table::text(&jobs, &report, &results.outcomes, width(WIDTH), SHOWN);
    text += &format!("{}: {deck}, {}, {work}\n", folder.display(), counts(&results));
    super::show(&text);
    Ok(OK)
}
