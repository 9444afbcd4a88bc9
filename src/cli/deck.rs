//! A deck given on the command line, worked off by a session.

use super::args::{Deck, Options, Target, Usage};
use super::progress::{self, Progress};
use super::{FAILED, OK};
use crate::diag::{Diagnostics, Severity, Sources, render};
use crate::graph::show;
use crate::out::log::{Echo, Log};
use crate::out::thermo::wall_time;
use crate::run::Watch;
use crate::session::{self, Mode, Session, folder_of};
use std::io::{IsTerminal, Read, Write};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Ended from outside (Ctrl-C).
const INTERRUPTED: u8 = 130;

/// Works a deck off in some mode; the exit code.
///
/// # Errors
/// A command line that cannot be obeyed.
pub fn work_off(o: &Options, mode: Mode) -> Result<u8, Usage> {
    let begin = Instant::now();
    let (name, text) = read(&o.deck)?;
    let threads = crate::par::set_threads(o.threads.unwrap_or(1));
    let progress = Progress::new();
    let log = open_log(o, mode, &progress)?;
    let options = session::Options {
        mode,
        log: log.clone(),
        compat: o.compat,
        force_list: o.list_layout,
        no_skipping: o.no_skipping,
        portable: o.portable,
        vars: o.vars.clone(),
        folder: folder_of(Path::new(&name)),
    };
    let mut session = match Session::new(options) {
        Ok(s) => s,
        Err(e) => {
            complain(&e, &Sources::default(), &log, mode);
            return Ok(FAILED);
        }
    };
    let stop = session.stop_flag();
    let twice = stop.clone();
    // A second Ctrl-C does not wait for the step's end.
    let _ = ctrlc::set_handler(move || {
        if twice.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    session.set_watch(Box::new(Bar(progress.clone())));
    if mode == Mode::Run || mode == Mode::Measure {
        let with = if o.compat { ", compat lammps" } else { "" };
        let _ = log.line(&format!("perigrain {} ({threads} thread(s){with})", env!("CARGO_PKG_VERSION")));
    }
    let outcome = session.run_text(&name, &text);
    progress.clear();
    let code = match &outcome {
        Ok(ending) if ending.interrupted => INTERRUPTED,
        Ok(ending) => ending.status.clamp(0, 255) as u8,
        Err(e) => {
            complain(e, &session.sources, &log, mode);
            FAILED
        }
    };
    if mode == Mode::Check {
        report(&session, outcome.is_ok());
    } else if mode == Mode::Run || mode == Mode::Measure {
        let _ = log.line(&wall_time(begin.elapsed().as_secs_f64()));
        let _ = log.flush();
    }
    Ok(code)
}

/// Prints a deck's command graph for graphviz.
///
/// # Errors
/// A deck that cannot be read.
pub fn draw(o: &Options) -> Result<u8, Usage> {
    let (name, text) = read(&o.deck)?;
    let options = session::Options {
        mode: Mode::Check,
        vars: o.vars.clone(),
        folder: folder_of(Path::new(&name)),
        ..session::Options::default()
    };
    let (log, mode) = (Log::silent(), Mode::Check);
    let mut session = match Session::new(options) {
        Ok(s) => s,
        Err(e) => {
            complain(&e, &Sources::default(), &log, mode);
            return Ok(FAILED);
        }
    };
    let outcome = session.run_text(&name, &text);
    super::show(&show::dot(&session.graph))?;
    if let Err(e) = outcome {
        complain(&e, &session.sources, &log, mode);
        return Ok(FAILED);
    }
    Ok(OK)
}

struct Bar(Progress);

impl Watch for Bar {
    fn step(&mut self, done: i64, total: i64) {
        self.0.step(done, total);
    }
}

fn read(deck: &Deck) -> Result<(String, String), Usage> {
    let mut bytes = vec![];
    let (name, outcome) = match deck {
        Deck::Stdin => ("<stdin>".to_string(), std::io::stdin().read_to_end(&mut bytes).map(|_| ())),
        Deck::File(path) => (path.display().to_string(), std::fs::read(path).map(|b| bytes = b)),
    };
    match outcome {
        Ok(()) => Ok((name, String::from_utf8_lossy(&bytes).into_owned())),
        Err(e) => Err(Usage { message: format!("cannot read the deck {name}: {e}"), help: None }),
    }
}

fn open_log(o: &Options, mode: Mode, progress: &Progress) -> Result<Log, Usage> {
    if mode == Mode::Check {
        return Ok(Log::silent());
    }
    let screen: Option<Box<dyn Write + Send>> = match &o.screen {
        Target::Usual if std::io::stdout().is_terminal() => {
            Some(Box::new(progress.around(std::io::stdout())))
        }
        Target::Usual => Some(Box::new(std::io::stdout())),
        Target::None => None,
        Target::File(path) => match std::fs::File::create(path) {
            Ok(f) => Some(Box::new(f)),
            Err(e) => {
                return Err(Usage { message: format!("cannot write {}: {e}", path.display()), help: None });
            }
        },
    };
    let log = Log::new(screen);
    let file = match &o.log {
        Target::Usual if mode == Mode::Run || mode == Mode::Measure => Some(Path::new("log.lammps")),
        Target::File(path) => Some(path.as_path()),
        _ => None,
    };
    if let Some(path) = file {
        log.open(path, false).map_err(|e| Usage { message: e.to_string(), help: None })?;
    }
    if let Some(word) = &o.echo {
        match Echo::parse(word) {
            Some(echo) => log.set_echo(echo),
            None => {
                let help = Some("none, screen, log or both".to_string());
                return Err(Usage { message: format!("-echo {word} is not known"), help });
            }
        }
    }
    Ok(log)
}

/// Problems go to standard error, and to the log without colours.
fn complain(e: &Diagnostics, sources: &Sources, log: &Log, mode: Mode) {
    let stderr = std::io::stderr();
    let text =
        if progress::colors(&stderr) { render::colored(e, sources) } else { render::plain(e, sources) };
    let _ = stderr.lock().write_all(text.as_bytes());
    if mode != Mode::Check {
        let _ = log.to_log(&render::plain(e, sources));
    }
}

/// What `perigrain check` says at the end.
fn report(session: &Session, clean: bool) {
    let warnings = session.notes.0.iter().filter(|d| d.severity == Severity::Warning).count();
    let stderr = std::io::stderr();
    let text = match progress::colors(&stderr) {
        true => render::colored(&session.notes, &session.sources),
        false => render::plain(&session.notes, &session.sources),
    };
    let _ = stderr.lock().write_all(text.as_bytes());
    if clean {
        let _ = super::show(&format!("no errors, {warnings} warning(s)\n"));
    }
}
