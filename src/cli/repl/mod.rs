//! The interactive session: lines are read, executed, inspected and taken back.

mod alone;
mod colon;
mod habits;
pub mod hinting;
pub mod painting;
mod picture;
mod reading;
mod saving;
mod slicing;
pub mod undoing;

use super::args::{Deck, Options, Target};
use super::progress::{self, Progress};
use super::{FAILED, OK, deck, manual, pager};
use crate::human::duration;
use crate::session::{Heard, Known, Mode, Session};
use habits::Meant;
use perigrain_base::diag::{Diagnostics, Result, render};
use perigrain_lang::is_unfinished;
use perigrain_output::log::{Echo, Log};
use reading::{Read, Reader};
use saving::{Line, Stopped};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Instant;
use undoing::Undo;

/// The greeting of the prompt.
const GREETING: &str = "Lines of a deck are executed as you type them. Tab completes, `help` (or `?`) and `:help` explain more, \
                        Ctrl-C stops a run, Ctrl-D leaves.";

/// An interactive session.
struct Repl {
    session: Session,
    log: Log,
    progress: Progress,
    undo: Undo,
    /// The lines that count.
    lines: Vec<Line>,
    /// Lines of a deck that do what the switches did.
    switches: Vec<String>,
    known: Rc<RefCell<Known>>,
    /// Texts evaluated so far, for messages.
    count: usize,
    failed: bool,
}

/// Runs an interactive session; the exit code.
pub fn run(o: &Options) -> u8 {
    let log = Log::silent();
    let known = Rc::new(RefCell::new(Known::default()));
    let mut repl = match begin(o, &log, known.clone()) {
        Ok(repl) => repl,
        Err(problems) => {
            deck::print(&problems, &Default::default());
            return FAILED;
        }
    };
    let mut reader = Reader::new(known, std::path::Path::new("."));
    if reader.is_terminal() {
        println!("perigrain {}", env!("CARGO_PKG_VERSION"));
        super::show(&pager::fitted(GREETING));
    }
    let mut status = None;
    if let Deck::File(path) = &o.deck {
        status = repl.text(&format!("include \"{}\"", path.display()));
    }
    while status.is_none() {
        match reader.read() {
            Read::Text(text) => status = repl.text(&text),
            Read::Again => {}
            Read::End => break,
        }
    }
    let outcome = if repl.failed && !reader.is_terminal() { FAILED } else { OK };
    status.filter(|s| *s != 0).map_or(outcome, |s| s.clamp(0, 255) as u8)
}

fn begin(o: &Options, log: &Log, known: Rc<RefCell<Known>>) -> Result<Repl> {
    let progress = Progress::new(Some(log.clone()));
    deck::open_screen(log, o, &progress)?;
    if let Target::File(path) = &o.log {
        log.open(path, false)?;
    }
    if let Some(echo) = o.echo.as_deref().and_then(Echo::parse) {
        log.set_echo(echo);
    }
    log.keep_rows();
    let mut session = deck::begin(o, Mode::Run, log)?;
    session.set_watch(Box::new(deck::Bar(progress.clone())));
    deck::catch_interrupts(&session, &progress);
    let mut switches: Vec<String> =
        o.vars.iter().map(|(name, values)| format!("variable {name} index {}", values.join(" "))).collect();
    switches.extend(o.compat.is_chosen().then(|| format!("compat {}", o.compat.name())));
    let repl = Repl {
        session,
        log: log.clone(),
        progress,
        undo: Undo::new(undoing::LIMIT),
        lines: vec![],
        switches,
        known,
        count: 0,
        failed: false,
    };
    *repl.known.borrow_mut() = repl.session.known();
    Ok(repl)
}

impl Repl {
    /// Executes typed or pasted text, one logical line after the other; the exit status once it is over.
    fn text(&mut self, text: &str) -> Option<i32> {
        let mut rest = text.trim_end_matches('\n');
        while !rest.is_empty() {
            let ends = rest.match_indices('\n').map(|(k, _)| k).chain([rest.len()]);
            let end = ends.into_iter().find(|&k| !is_unfinished(&rest[..k])).unwrap_or(rest.len());
            let status = self.line(&rest[..end]);
            if status.is_some() {
                return status;
            }
            rest = rest.get(end + 1..).unwrap_or("");
        }
        None
    }

    fn line(&mut self, line: &str) -> Option<i32> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first() {
            None => return None,
            Some(w) if w.starts_with('#') => return None,
            Some(&":quit") => return Some(0),
            Some(_) => {}
        }
        match habits::meant(line) {
            Meant::Leave => return Some(0),
            Meant::Help(about) => match self.help(&about) {
                Ok(text) => pager::page(&text),
                outcome => self.show_outcome(outcome),
            },
            Meant::Hint(text) => self.show_outcome(Err(text)),
            Meant::Timed(rest) => {
                let begin = Instant::now();
                let status = self.line(&rest);
                self.print(&format!("(that took {})", duration(begin.elapsed().as_secs_f64())));
                return status;
            }
            Meant::Deck if line.trim_start().starts_with(':') => {
                let outcome = self.colon(&words);
                self.show_outcome(outcome);
            }
            Meant::Deck => return self.deck_line(line),
        }
        None
    }

    /// A line of a deck: it counts wholly or not at all.
    fn deck_line(&mut self, line: &str) -> Option<i32> {
        let before = self.undo.look(&self.session);
        let (mark, first) = (self.log.tables(|t| t.mark()), self.session.world.clock.step);
        self.count += 1;
        let outcome = self.session.eval(&format!("line {}", self.count), line);
        self.progress.clear();
        let heard = match (outcome, before) {
            (Ok(heard), Some(state)) => {
                let dropped = self.undo.push(line, state, mark);
                if dropped > 0 {
                    self.print(&format!(
                        "({dropped} line(s) can no longer be undone: snapshots may take 1 GiB)"
                    ));
                }
                heard
            }
            (Ok(heard), None) => {
                self.undo.forget();
                self.print(
                    "(the scene is too large for snapshots of 1 GiB: nothing before here can be undone)",
                );
                heard
            }
            (Err(problems), state) => {
                self.complain(&problems);
                match state {
                    Some(state) => {
                        self.session.restore(&state);
                        self.log.tables(|t| t.back_to(mark));
                    }
                    None => self.print(
                        "(the scene is too large for a snapshot: what the line did before it failed stays)",
                    ),
                }
                return None;
            }
        };
        self.accept(line, heard, first);
        heard.quit
    }

    fn accept(&mut self, line: &str, heard: Heard, first: i64) {
        *self.known.borrow_mut() = self.session.known();
        if heard.quit.is_none() {
            let step = self.session.world.clock.step;
            let stopped = heard.interrupted.then_some(Stopped { first, step });
            self.lines.push(Line { text: line.to_string(), stopped });
        }
    }

    /// `help`, `help fix nve`.
    fn help(&self, words: &[String]) -> std::result::Result<String, String> {
        if words.is_empty() {
            return Ok(format!(
                "{}\n{}`help NAME` shows a page, as `help fix nve`.\n",
                manual::list(),
                colon::list()
            ));
        }
        manual::page(&words.join(" ")).map_err(|u| match u.help {
            Some(help) => format!("{}\n  = help: {help}", u.message),
            None => u.message,
        })
    }

    fn show_outcome(&mut self, outcome: std::result::Result<String, String>) {
        match outcome {
            Ok(text) => super::show(&text),
            Err(text) => {
                self.failed = true;
                // What the renderer has written is a whole message already.
                match text.starts_with("error") {
                    true => eprint!("{text}"),
                    false => eprintln!("error: {text}"),
                }
            }
        }
    }

    fn print(&self, text: &str) {
        self.log.to_screen(text);
    }

    fn complain(&mut self, problems: &Diagnostics) {
        self.failed = true;
        let sources = &self.session.sources;
        // A log file that cannot be written has been reported by the session.
        let _ = self.log.to_log(render::plain(problems, sources).trim_end());
        let _ = self.log.flush();
        deck::print(problems, sources);
    }
}

/// Whether standard output takes colours.
fn colours() -> bool {
    std::io::IsTerminal::is_terminal(&std::io::stdout()) && progress::colors_wanted()
}
