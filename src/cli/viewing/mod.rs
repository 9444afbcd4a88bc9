//! `-view [PORT]`: the page of a run on the loopback address during the run, with pause, step and stop.

mod live;
mod server;

pub use live::Live;

use super::args::Options;
use super::deck::name;
use super::reporting::title;
use crate::report::film::{packed_one, taken};
use crate::report::{self, Report, Text};
use crate::session::Session;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_output::log::Log;
use server::{Answer, Question, Server, token};
use std::io::ErrorKind;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long the end of a run waits for its reader.
const FAREWELL: Duration = Duration::from_secs(3);
/// Rows that one answer holds at most.
const ROWS: usize = 2000;

/// Opens the page of a command line, and prints its address.
///
/// # Errors
/// A port that is not available.
pub fn open(o: &Options, text: &str, log: &Log) -> Result<Option<Arc<Live>>> {
    let Some(port) = o.view else { return Ok(None) };
    let server = Server::on(port, token()).map_err(|e| refused(port, &e))?;
    let live = Arc::new(Live::default());
    let mut report = Report::new(title(&o.deck));
    report.deck = Some(Text { what: "Deck", name: name(&o.deck), text: text.to_string() });
    report.live = true;
    let page = report::html(&report);
    log.keep_rows();
    eprintln!("The run is shown at {}", server.url());
    let (shared, log) = (live.clone(), log.clone());
    std::thread::spawn(move || server.serve(|question| answer(question, &shared, &page, &log)));
    Ok(Some(live))
}

fn refused(port: u16, e: &std::io::Error) -> Diagnostic {
    let d = Diagnostic::error(Code::NO_FILE, None, format!("`-view {port}`: the port cannot be had: {e}"));
    match e.kind() {
        ErrorKind::AddrInUse => d.help("another program has it: leave the number out, or name another port"),
        ErrorKind::PermissionDenied => d.help("ports below 1024 are the system's: leave the number out"),
        _ => d.help("leave the number out, and any free port is taken"),
    }
}

fn answer(question: &Question, live: &Live, page: &str, log: &Log) -> Option<Answer> {
    live.heard();
    if question.acts {
        live.act(&question.path).then(|| json("{}".into()))
    } else {
        match question.path.as_str() {
            "/" => Some(Answer { kind: "text/html; charset=utf-8", body: page.into() }),
            "/state" => Some(json(state(live, log, question.since))),
            "/frame" => {
                let body = live.frame(question.since).map_or(vec![], |(id, frame)| packed_one(id, &frame));
                Some(Answer { kind: "application/octet-stream", body })
            }
            _ => None,
        }
    }
}

fn json(text: String) -> Answer {
    Answer { kind: "application/json", body: text.into() }
}

/// Where the run stands, and the rows of the step table from some row on.
fn state(live: &Live, log: &Log, since: usize) -> String {
    let rows: Vec<String> = log.tables(|tables| {
        let all = tables.0.iter().flat_map(|t| t.rows.iter().map(move |row| (&t.columns, row)));
        all.skip(since).take(ROWS).map(|(columns, row)| report::row_json(columns, row)).collect()
    });
    // Read after the rows, so that a run that is over has delivered all of them.
    format!("{{{},\"rows\":[{}]}}", live.state_json(), rows.join(","))
}

/// Shows how it ended, and waits until a present reader has seen it.
pub fn farewell(live: &Live, session: &Session) {
    live.end(taken(&session.world, None));
    let begin = Instant::now();
    while begin.elapsed() < FAREWELL && live.is_awaited() {
        std::thread::sleep(Duration::from_millis(50));
    }
}
