//! `perigrain report`: a page about a run that is over, from its log and its dumps.

use super::{Sheet, day, grouped, span};
use crate::cli::args::Usage;
use crate::cli::{FAILED, OK, deck};
use crate::report::film::{Film, dump};
use crate::report::{self, Report, Text};
use perigrain_base::diag::{Code, Diagnostic, Result, Sources, fail, render};
use perigrain_output::file::trouble;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The words of `report`.
#[derive(Clone, Debug, PartialEq, Eq, clap::Args)]
pub struct Wanted {
    /// The run's log, and its text dumps
    #[arg(value_name = "LOG | DUMP", value_hint = clap::ValueHint::FilePath)]
    pub files: Vec<PathBuf>,
    /// The page
    #[arg(long = "out", alias = "o", value_name = "FILE", default_value = "report.html", value_hint = clap::ValueHint::FilePath)]
    pub out: PathBuf,
}

/// Writes the page.
///
/// # Errors
/// A page that would be written over what it is made from.
pub fn report(wanted: &Wanted) -> std::result::Result<u8, Usage> {
    if wanted.files.is_empty() {
        let usage = Usage::new("no log and no dump: there is nothing to report");
        return Err(usage.help("write `perigrain report log.lammps DUMP -o run.html`"));
    }
    let same = |file: &PathBuf| {
        let [a, b] = [file, &wanted.out].map(|p| p.canonicalize().ok());
        a.is_some() && a == b
    };
    if let Some(file) = wanted.files.iter().find(|file| same(file)) {
        let usage = Usage::new(format!("the page would be written over `{}`", file.display()));
        return Err(usage.help("name another file behind `-o`"));
    }
    match made(wanted) {
        Ok(()) => Ok(OK),
        Err(problems) => {
            deck::print(&problems, &Sources::default());
            Ok(FAILED)
        }
    }
}

fn made(wanted: &Wanted) -> Result<()> {
    let mut sheet = Sheet::open(wanted.out.clone())?;
    let page = report::html(&report_of(&wanted.files)?);
    sheet.put(&page)?;
    crate::cli::show(&format!("{}\n", sheet.message()));
    Ok(())
}

/// The report of these files.
fn report_of(files: &[PathBuf]) -> Result<Report> {
    let name = files[0].file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let mut r = Report::new(name);
    let mut film = Film::default();
    let (mut logs, mut dumps) = (0, vec![]);
    for file in files {
        if is_dump(file)? {
            add_dump(file, &mut film, &mut r)?;
            dumps.push(file);
        } else {
            add_log(file, &mut r)?;
            logs += 1;
        }
    }
    r.film = film.into_frames();
    let rows = || r.tables.0.iter().flat_map(|t| &t.rows);
    let times: HashMap<i64, f64> = rows().filter(|r| r.time.is_finite()).map(|r| (r.step, r.time)).collect();
    let span = (rows().map(|r| r.step).min(), rows().map(|r| r.step).max());
    let among = |step: i64| span.0.is_some_and(|a| step >= a) && span.1.is_some_and(|b| step <= b);
    let strange = span.0.is_some() && !r.film.is_empty() && !r.film.iter().any(|f| among(f.step));
    if strange {
        r.remarks
            .push("No snapshot is of a step that the log has: the dump seems to be of another run.".into());
    }
    for frame in &mut r.film {
        frame.time = times.get(&frame.step).copied();
    }
    if logs == 0 {
        r.remarks.push("No log was given: there are no curves.".into());
    } else if r.tables.0.is_empty() {
        r.remarks.push(
            "The log has no step table that could be read: tables of one line per row with `Step` first are."
                .into(),
        );
    }
    if dumps.is_empty() {
        r.remarks.push("No dump was given: there are no particles to show.".into());
    }
    r.facts.push(("page made".into(), day(SystemTime::now())));
    Ok(r)
}

/// Whether a file is a dump: it begins like one, or its name says that it is packed.
fn is_dump(path: &Path) -> Result<bool> {
    let name = path.to_string_lossy();
    if [".gz", ".bin", ".lammpsbin"].iter().any(|e| name.ends_with(e)) {
        return Ok(true);
    }
    let mut start = [0; 5];
    let file = std::fs::File::open(path).map_err(|e| trouble("read", path, &e))?;
    let read = std::io::Read::read(&mut { file }, &mut start).map_err(|e| trouble("read", path, &e))?;
    Ok(&start[..read] == b"ITEM:")
}

fn add_log(path: &Path, r: &mut Report) -> Result<()> {
    let bytes = std::fs::read(path).map_err(|e| trouble("read the log", path, &e))?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let log = report::log::read(&text);
    r.tables.0.extend(log.tables.0);
    r.messages.extend(log.messages);
    r.ended = log.ended;
    if !log.origin.is_empty() {
        r.origin = log.origin;
    }
    r.figures = vec![
        ("particles".to_string(), grouped(log.atoms as f64)),
        ("steps".into(), grouped(log.steps as f64)),
    ];
    if log.seconds > 0.0 {
        r.figures.push(("time in steps".into(), span(log.seconds)));
        r.figures.push(("steps per second".into(), grouped(log.steps as f64 / log.seconds)));
    }
    r.remarks.extend(log.remark.map(|remark| format!("{}: {remark}", path.display())));
    r.deck = Some(Text { what: "Log", name: path.display().to_string(), text });
    Ok(())
}

fn add_dump(path: &Path, film: &mut Film, r: &mut Report) -> Result<()> {
    let before = film.seen;
    if let Some((text, problems)) = dump::add(path, film)? {
        let problems = problems.within(&text);
        let plain = render::plain(&problems, &Sources::default());
        if film.seen == before {
            return Err(problems);
        }
        let d = Diagnostic::warning(
            Code::BAD_FILE,
            None,
            format!("`{}` can be read up to snapshot {} only", path.display(), film.seen - before),
        );
        deck::print(&d.into(), &Sources::default());
        r.remarks.push(format!("{} can be read up to some snapshot only:\n{plain}", path.display()));
    }
    if film.seen == before {
        return fail(Code::BAD_FILE, None, format!("the dump `{}` has no snapshot", path.display()));
    }
    Ok(())
}
