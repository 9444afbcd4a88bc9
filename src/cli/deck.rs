//! Execution of a deck given on the command line, by a session.

use super::args::{Deck, Options, Target, Usage};
use super::progress::{self, Progress};
use super::reporting::{Recorder, Sheet, Subject};
use super::{FAILED, INTERRUPTED, OK, partitions, signals, viewing};
use crate::session::{self, Made, Mode, Session, Watch, folder_of};
use console::Term;
use perigrain_base::comm::{self, Alone};
use perigrain_base::diag::{Code, Diagnostics, Result, Sources, fail, render};
use perigrain_base::{gate, memory};
use perigrain_output::file::trouble;
use perigrain_output::log::{Echo, Log};
use perigrain_output::thermo::wall_time;
use perigrain_world::World;
use std::io::{IsTerminal, LineWriter, Read, Write, stderr, stdin, stdout};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// Runs a deck in some mode; the exit code.
pub fn execute(o: &Options, mode: Mode) -> u8 {
    let begin = Instant::now();
    let log = Log::silent();
    let progress = if comm::is_first() { Progress::new(Some(log.clone())) } else { Progress::default() };
    report_lack_of_memory(&log);
    let mut sources = Sources::default();
    let outcome = attempt(o, mode, &progress, &log, &mut sources);
    progress.clear();
    let code = outcome.unwrap_or_else(|problems| {
        complain(&problems, &sources, &log);
        FAILED
    });
    if runs(mode) {
        let _ = log.line(&wall_time(begin.elapsed().as_secs_f64()));
        let _ = log.flush();
    }
    code
}

fn attempt(o: &Options, mode: Mode, progress: &Progress, log: &Log, sources: &mut Sources) -> Result<u8> {
    let (name, text) = read(&o.deck)?;
    open(log, o, mode, progress)?;
    // Found out before the run whether it can be written.
    let mut sheet = Sheet::of(o)?;
    if sheet.is_some() {
        log.keep_rows();
    }
    let settled = settled(o, mode, log)?;
    progress.look_ahead(&settled, &name, &text);
    let mut session = Session::new(settled)?;
    let live = viewing::open(o, &text, log)?;
    let recorder = Recorder::new(progress.clone(), sheet.is_some(), live.clone(), session.stop_flag());
    let film = recorder.film();
    match sheet.is_some() || live.is_some() {
        true => session.set_watch(Box::new(recorder)),
        false => session.set_watch(Box::new(Bar(progress.clone()))),
    }
    catch_interrupt(&session, progress);
    if runs(mode) {
        let with = o.compat.describe();
        let threads = session::threads();
        let version = env!("CARGO_PKG_VERSION");
        let ranks = super::ranks::describe();
        let _ = log.line(&format!("perigrain {version} ({ranks}{threads} thread(s){with})"));
    }
    let outcome = session.run_text(&name, &text);
    sources.clone_from(&session.sources);
    let mut written = Ok(());
    if let Some(sheet) = &mut sheet {
        let film = std::mem::take(&mut *film.lock().unwrap_or_else(PoisonError::into_inner));
        let subject =
            Subject { options: o, text: text.clone(), session: &session, outcome: &outcome, film, log };
        // The first rank reads the scene without the others.
        written = comm::run_as(Arc::new(Alone), || sheet.write(subject));
        if written.is_ok() {
            log.to_screen(&sheet.message());
        }
    }
    if let Some(live) = live {
        viewing::farewell(&live, &session);
    }
    let ending = outcome?;
    written?;
    Ok(if ending.interrupted { INTERRUPTED } else { ending.status.clamp(0, 255) as u8 })
}

/// Prints a deck's command graph for graphviz.
pub fn draw(o: &Options) -> u8 {
    let mut sources = Sources::default();
    let outcome = read(&o.deck).and_then(|(name, text)| {
        let mut session = begin(o, Mode::Check, &Log::silent())?;
        let outcome = session.run_text(&name, &text);
        sources.clone_from(&session.sources);
        super::show(&session.dot());
        outcome
    });
    match outcome {
        Ok(_) => OK,
        Err(problems) => {
            print(&problems, &sources);
            FAILED
        }
    }
}

/// A session with the options of the switches.
///
/// # Errors
/// Variables of the command line that cannot be set.
pub(super) fn begin(o: &Options, mode: Mode, log: &Log) -> Result<Session> {
    Session::new(settled(o, mode, log)?)
}

/// The session options of the switches; applies threads and the gate.
///
/// # Errors
/// A missing folder.
pub(super) fn settled(o: &Options, mode: Mode, log: &Log) -> Result<session::Options> {
    session::set_threads(o.threads.or_else(openmp_threads_allowed).unwrap_or(0));
    let folder = match &o.deck {
        Deck::Stdin => Default::default(),
        Deck::File(path) => folder_of(path),
    };
    if let Some(limits) = o.safe {
        // What the command line itself names has been opened before.
        gate::close(&folder, limits).map_err(|e| trouble("find the deck's folder", &folder, &e))?;
    }
    Ok(session::Options {
        mode,
        log: log.clone(),
        compat: o.compat,
        force_list: o.list_layout,
        no_skipping: o.no_skipping,
        portable: o.portable,
        vars: o.vars.clone(),
        folder,
        partition: partitions::of(o),
        overlay: Default::default(),
        tables: Default::default(),
        limit: o.timeout.map(|time| session::Limit { time, restart: last_restart(o) }),
    })
}

/// The restart file for a deck that `-timeout` ends, in the folder where the deck was started.
fn last_restart(o: &Options) -> String {
    let name = match &o.deck {
        Deck::Stdin => None,
        Deck::File(path) => path.file_name().and_then(|name| name.to_str()),
    };
    let name = name.unwrap_or("stdin").replace(['*', '%'], "_");
    let partition = o.world.as_ref().map_or(String::new(), |w| format!(".{}", w.number));
    format!("{name}{partition}.*.restart")
}

/// A session for a program that hosts it, with the options of a command line; the screen is the host's unless an option sets it.
///
/// # Errors
/// Words that are not understood or concern a program of its own, files that cannot be written.
pub fn host(words: Vec<String>, screen: Box<dyn Write + Send>) -> std::result::Result<Session, Usage> {
    super::ranks::refuse("each Python would run a scene of its own")?;
    let (o, decks) = super::args::parse_many(words)?;
    if !decks.is_empty() {
        let usage = Usage::new("a deck on the command line is not executed here");
        return Err(usage.help("leave it out, and hand it over with `file(PATH)`"));
    }
    let alone = [
        (o.report.is_some(), "-report"),
        (o.view.is_some(), "-view"),
        (o.safe.is_some(), "-safe"),
        (!o.partition.is_empty(), "-partition"),
        (o.ranks.is_some(), "-ranks"),
        (o.help, "-help"),
        (o.version, "-version"),
        (o.world.is_some(), "-world"),
    ];
    if let Some((_, switch)) = alone.iter().find(|(given, _)| *given) {
        let usage =
            Usage::new(format!("`{switch}` concerns a whole process, which is not perigrain's own here"));
        return Err(usage.help("leave it out, or start the program `perigrain`"));
    }
    let log = Log::silent();
    let opened = match &o.screen {
        Target::Usual | Target::Full => {
            log.set_screen(Some(screen));
            Ok(())
        }
        _ => open_screen(&log, &o, &Progress::new(None)),
    };
    let begun = opened.and_then(|()| open_log(&log, &o, Mode::Run)).and_then(|()| begin(&o, Mode::Run, &log));
    begun.map_err(|e| Usage::new(e.to_string()))
}

/// The threads that `OMP_NUM_THREADS` allows: batch systems set it to the cores that were given.
pub(super) fn openmp_threads_allowed() -> Option<usize> {
    let value = std::env::var("OMP_NUM_THREADS").ok()?;
    let threads = openmp_threads(&value);
    if threads.is_none() && !value.trim().is_empty() {
        eprintln!("warning: OMP_NUM_THREADS is `{value}`, not a number of threads; all cores are used");
    }
    threads
}

/// The first of the numbers that OpenMP takes, one per level of loops within loops.
fn openmp_threads(value: &str) -> Option<usize> {
    value.split(',').next()?.trim().parse().ok().filter(|&n| n > 0)
}

/// Whether steps are made and files written.
fn runs(mode: Mode) -> bool {
    matches!(mode, Mode::Run | Mode::Measure)
}

/// The first Ctrl-C or request to end ends the run at a whole step, the second one the program at once.
fn catch_interrupt(session: &Session, progress: &Progress) {
    let (stop, progress) = (session.stop_flag(), progress.clone());
    let ask = move || {
        if stop.swap(true, Ordering::Relaxed) {
            progress.leave();
            // There may be no reader.
            let _ = writeln!(stderr(), "ended at once: the last lines of files may be missing");
            std::process::exit(i32::from(INTERRUPTED));
        }
        progress.heard();
    };
    signals::listen(ask.clone());
    // Without a handler, Ctrl-C ends the program as it always did.
    let _ = ctrlc::set_handler(ask);
}

/// Ctrl-C ends the present work at a whole step, however often it comes.
pub(super) fn catch_interrupts(session: &Session, progress: &Progress) {
    let (stop, progress) = (session.stop_flag(), progress.clone());
    let _ = ctrlc::set_handler(move || {
        progress.heard();
        if stop.swap(true, Ordering::Relaxed) {
            let notice = "stopping at the end of this step; Ctrl-\\ ends at once";
            let _ = writeln!(progress.around(stderr()), "{notice}");
        }
    });
}

/// Shows each step in the live line.
pub(super) struct Bar(pub Progress);

impl Watch for Bar {
    fn requested(&mut self, steps: i64) {
        self.0.requested(steps);
    }

    fn begins(&mut self, _w: &World) {
        self.0.begins();
    }

    fn step(&mut self, made: &Made) {
        self.0.step(made);
    }
}

/// The deck's name and text; bytes that are no UTF-8 become the replacement character and are refused where they matter.
pub(super) fn read(deck: &Deck) -> Result<(String, String)> {
    let outcome = gate::first(|| match deck {
        Deck::Stdin => {
            let mut bytes = vec![];
            stdin().read_to_end(&mut bytes).map(|_| bytes)
        }
        Deck::File(path) => std::fs::read(path),
    });
    let name = name(deck);
    match outcome {
        Ok(bytes) => Ok((name, String::from_utf8_lossy(&bytes).into_owned())),
        Err(e) => fail(Code::NO_FILE, None, format!("cannot read the deck `{name}`: {e}")),
    }
}

/// What a deck is called in messages.
pub(super) fn name(deck: &Deck) -> String {
    match deck {
        Deck::Stdin => "<stdin>".into(),
        Deck::File(path) => path.display().to_string(),
    }
}

/// Opens screen and log file. A plan leaves no log unless one is requested.
fn open(log: &Log, o: &Options, mode: Mode, progress: &Progress) -> Result<()> {
    open_screen(log, o, progress)?;
    open_log(log, o, mode)
}

fn open_log(log: &Log, o: &Options, mode: Mode) -> Result<()> {
    match &o.log {
        Target::Usual if runs(mode) => log.open(Path::new("log.lammps"), false)?,
        Target::File(path) => log.open(path, false)?,
        _ => {}
    }
    if let Some(echo) = o.echo.as_deref().and_then(Echo::parse) {
        log.set_echo(echo);
    }
    Ok(())
}

/// Opens the screen.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn open_screen(log: &Log, o: &Options, progress: &Progress) -> Result<()> {
    let terminal = stdout().is_terminal();
    log.set_screen(match &o.screen {
        Target::None => None,
        Target::Usual | Target::Full if terminal => {
            Some(Box::new(LineWriter::new(progress.around(stdout()))))
        }
        Target::Usual | Target::Full => Some(Box::new(stdout())),
        Target::File(path) => match std::fs::File::create(path) {
            Ok(file) => Some(Box::new(file)),
            Err(e) => return fail(Code::NO_FILE, None, format!("cannot write `{}`: {e}", path.display())),
        },
    });
    if terminal && o.screen == Target::Usual {
        log.be_brief(|| Term::stdout().size_checked().map_or(80, |(_, columns)| columns.into()));
    }
    Ok(())
}

/// Problems go to standard error, and to the log without colours.
/// Where memory is not there, or `-limit memory` does not allow it, the program ends with a message in place of an abort.
pub(super) fn report_lack_of_memory(log: &Log) {
    let log = log.clone();
    memory::speaks(move |problem| {
        let mut sources = Sources::default();
        let problem = sources.adopt(problem.into());
        log.last_words(render::plain(&problem, &sources).trim_end());
        print(&problem, &sources);
    });
}

fn complain(problems: &Diagnostics, sources: &Sources, log: &Log) {
    // When the log cannot be written the terminal has it all the same.
    let _ = log.to_log(render::plain(problems, sources).trim_end());
    match comm::is_first() {
        true => print(problems, sources),
        false => super::ranks::keep(&render::plain(problems, sources)),
    }
}

/// Problems on standard error, with colours on a terminal.
pub(super) fn print(problems: &Diagnostics, sources: &Sources) {
    let err = stderr();
    let text = if progress::colors(&err) {
        render::colored(problems, sources)
    } else {
        render::plain(problems, sources)
    };
    let _ = err.lock().write_all(text.as_bytes());
}
