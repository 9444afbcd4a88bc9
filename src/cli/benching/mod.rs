//! `perigrain bench`: a deck over its knobs, wall time against error.

pub mod args;
pub mod scaling;
pub mod suite;

use super::args::{Target, Usage};
use super::pager::width;
use super::progress::{Tally, colors_wanted};
use super::sweeping::show::Show;
use super::sweeping::{axes, counts, exit_code, idle, listen, of_deck, prepared, serve, status, usage};
use super::{FAILED, INTERRUPTED, OK, deck, ranks};
use crate::bench::norm::Norm;
use crate::bench::{Bench, Found, Measure, picture, table};
use crate::session::Swept;
use crate::sweep;
use crate::sweep::ranks::Ranks;
use args::Request;
use perigrain_base::diag::{Code, Diagnostics, Result, Sources, Span};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What the folder of a deck's bench ends in.
const ENDING: &str = "bench";
/// Rows of the table that are shown.
const SHOWN: usize = 60;
/// Characters of its lines.
const WIDTH: usize = 160;

/// Makes the runs and shows their results; the exit code. Of several ranks the first one does so, and the others make runs for
/// it.
///
/// # Errors
/// Lists of values that make no sense, ranks that cannot be joined.
pub fn perform(request: &Request) -> std::result::Result<u8, Usage> {
    ranks::shared_out(&request.sweep.options, |ranks| first(request, ranks), serve)
}

fn first(request: &Request, ranks: Option<Ranks>) -> std::result::Result<u8, Usage> {
    if request.sweep.status {
        return Ok(exit_code(status(&request.sweep.folder(ENDING)), &Sources::default()));
    }
    let mut sources = Sources::default();
    let given = match axes(&request.sweep, &mut sources) {
        Ok(axes) => Swept { axes, report: vec![] },
        Err(problems) if problems.0.iter().all(|d| d.span.is_none() && d.code != Code::NO_FILE) => {
            return Err(usage(problems));
        }
        Err(problems) => return Ok(exit_code(Err(problems), &sources)),
    };
    let prepared = deck::read(&request.sweep.options.deck)
        .and_then(|(_, text)| Ok((of_deck(&request.sweep, given, &text, &mut sources)?, text)))
        .and_then(|(swept, text)| bench(request, swept, text));
    let mut bench = match prepared {
        Ok(bench) => bench,
        Err(problems) => return Ok(exit_code(Err(problems), &sources)),
    };
    bench.sweep.ranks = ranks;
    if bench.axes.is_empty() {
        let usage = Usage::new("a bench needs a knob to turn");
        return Err(usage.help("as `-each dt 4e-6 2e-6 1e-6` for a variable of the deck, or `-threads 1 2`"));
    }
    let left_out = match leave_out(request, &mut bench) {
        Ok(left_out) => left_out,
        Err((problems, sources)) => return Ok(exit_code(Err(problems), &sources)),
    };
    if bench.measures.is_empty() || bench.axes.is_empty() {
        return Ok(FAILED);
    }
    Ok(exit_code(run(request, &bench, left_out), &Sources::default()))
}

/// The bench of the words of the command line.
fn bench(request: &Request, mut swept: Swept, text: String) -> Result<Bench> {
    let mut axes = request.own_axes();
    axes.append(&mut swept.axes);
    let norm = request.norm.as_deref().and_then(Norm::named);
    let norm = norm.or(Norm::named("rel")).unwrap_or_default();
    let measure = |(k, word): (usize, &String)| Measure {
        word: word.clone(),
        against: request.against(k),
        norm,
        name: word.clone(),
    };
    let measures = request.measures.iter().enumerate().map(measure).collect();
    let swept = Swept { axes: axes.clone(), report: vec![] };
    let mut sweep = prepared(&request.sweep, swept, text)?;
    // Runs beside each other would disturb each other's times.
    sweep.at_once = request.sweep.jobs.unwrap_or(1);
    sweep.folder = request.sweep.folder(ENDING);
    Bench::new(sweep, axes, request.repeat, measures)
}

/// Leaves out knobs that the deck does not read and measures that it does not have, with a note; whether there were any.
///
/// # Errors
/// A deck that is refused.
fn leave_out(request: &Request, bench: &mut Bench) -> std::result::Result<bool, (Diagnostics, Sources)> {
    let mut ahead = sweep::look_ahead(&bench.sweep);
    if !ahead.problems.has_errors() {
        return Ok(false);
    }
    if ahead.unused.is_empty() && ahead.unknown.is_empty() {
        return Err((ahead.problems, ahead.sources));
    }
    let typed = ahead.sources.add("command line", request.typed.as_str());
    let named = ahead.problems.0.iter_mut().filter(|d| d.span.is_none());
    for (d, name) in named.zip(&ahead.unused) {
        let word = format!("{name} ");
        let place = request.typed.find(&format!(" -each {word}")).map(|at| at + " -each ".len());
        d.span = place.map(|at| Span::new(typed, at, at + name.len()));
        d.help.push("this knob is left out, the others stay".into());
    }
    deck::print(&ahead.problems, &ahead.sources);
    for axis in &mut bench.axes {
        let used: Vec<usize> =
            (0..axis.names.len()).filter(|k| !ahead.unused.contains(&axis.names[*k])).collect();
        axis.names = used.iter().map(|k| axis.names[*k].clone()).collect();
        axis.rows.iter_mut().for_each(|row| *row = used.iter().map(|k| row[*k].clone()).collect());
    }
    bench.axes.retain(|axis| !axis.names.is_empty());
    let has = |m: &Measure| match &m.against {
        crate::bench::reference::Against::Form(form) if ahead.unknown.contains(form) => false,
        _ => !ahead.unknown.contains(&m.word),
    };
    bench.measures.retain(has);
    bench.settle().map_err(|e| (e, ahead.sources))?;
    Ok(true)
}

/// Makes the runs, one after the other, and shows their results.
fn run(request: &Request, bench: &Bench, left_out: bool) -> Result<u8> {
    let quiet = request.sweep.options.screen == Target::None;
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop);
    if let Some(idle_ranks) = bench.sweep.ranks.as_ref().and_then(|ranks| idle(ranks, bench.sweep.jobs.len()))
        && !quiet
    {
        super::show(&format!("{idle_ranks}\n"));
    }
    let (results, found) = measured(bench, request.sweep.anew, quiet, &stop)?;
    let Some(found) = found else {
        if !quiet {
            super::show(&format!("{}\ninterrupted: the same command continues\n", counts(&results)));
        }
        return Ok(INTERRUPTED);
    };
    let pictures = table::write(bench, &found)?;
    if !quiet {
        super::show(&summary(bench, &found, &pictures));
    }
    complain(&found);
    Ok(if found.is_whole() && results.all_ok() && !left_out { OK } else { FAILED })
}

/// The runs of a bench, short ones repeated, and their results: `None` if they were interrupted.
///
/// # Errors
/// Folders and journals that cannot be read or written.
fn measured(
    bench: &Bench,
    anew: bool,
    quiet: bool,
    stop: &AtomicBool,
) -> Result<(sweep::Results, Option<Found>)> {
    let make = |runs: &sweep::Sweep, quiet: bool| {
        let mut show = Show { jobs: &runs.jobs, quiet, tally: Tally::default() };
        let results = sweep::execute(runs, anew, &mut show, stop);
        show.tally.clear();
        results
    };
    let results = make(&bench.sweep, quiet)?;
    if results.interrupted {
        return Ok((results, None));
    }
    let mut again = vec![];
    if let Some(more) = bench.again(&results.outcomes) {
        if !quiet {
            let least = 1e3 * crate::bench::LEAST;
            super::show(&format!("{} short runs again: {least:.0} ms for each setting\n", more.jobs.len()));
        }
        let repeated = make(&more, true)?;
        if repeated.interrupted {
            return Ok((repeated, None));
        }
        again = more.jobs.into_iter().zip(repeated.outcomes).filter_map(|(j, o)| Some((j, o?))).collect();
    }
    let found = bench.found(&results.outcomes, &again);
    Ok((results, Some(found)))
}

/// Prints what is missing.
fn complain(found: &Found) {
    deck::print(&found.problems, &Sources::default());
    found.failures.iter().for_each(|text| eprintln!("failed: {text}"));
}

/// The other load on the machine while a run was timed.
fn beside(runs: &sweep::Sweep) -> String {
    let at_once = runs.at_once;
    match &runs.ranks {
        Some(ranks) => {
            let each = if at_once == 1 { "one run".into() } else { format!("{at_once} runs") };
            format!(", {}, {each} at once on each, which disturb each other on one host", ranks.describe())
        }
        None if at_once > 1 => format!(", {at_once} runs at once, which disturb each other"),
        None => String::new(),
    }
}

/// Table, pictures and where they are.
fn summary(bench: &Bench, found: &Found, pictures: &[String]) -> String {
    let mut text = table::text(bench, found, width(WIDTH), SHOWN);
    let colours = std::io::stdout().is_terminal() && colors_wanted();
    for k in 0..bench.measures.len() {
        if let Some(picture) = picture::text(bench, found, k, colours) {
            text += &format!("\n{picture}");
        }
    }
    let folder = bench.sweep.folder.display();
    text += &format!("\n{folder}/{}: seconds are the wall time of the steps", table::TABLE);
    let runs = found.points.iter().map(|point| point.runs);
    match (runs.clone().min(), runs.max()) {
        (Some(few), Some(many)) if many > few => text += &format!(", the least of {few} to {many}"),
        (_, Some(many)) if many > 1 => text += &format!(", the least of {many}"),
        _ => {}
    }
    text += &beside(&bench.sweep);
    text.push('\n');
    for picture in pictures {
        text += &format!("{folder}/{picture}.svg, .png\n");
    }
    text
}
