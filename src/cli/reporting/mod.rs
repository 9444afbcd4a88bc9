//! `-report FILE`, `report`: what a run was, as one web page.

pub mod reading;
mod recording;

pub use recording::Recorder;

use super::args::{Deck, Options};
use super::deck;
use crate::report::film::{Film, taken};
use crate::report::{self, Ended, Report, Text, Weight};
use crate::session::{Ending, Session, threads};
use crate::verify::report::{machine, origin};
use perigrain_base::diag::{Diagnostics, Result, Severity, render};
use perigrain_output::file::trouble;
use perigrain_plan::explain;
use std::fs::File;
use std::io::{Seek, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// A file that a page will be written to, opened before the run begins.
pub struct Sheet {
    path: PathBuf,
    file: File,
    begin: Instant,
    since: SystemTime,
}

/// What a page is about.
pub struct Subject<'a> {
    /// The command line.
    pub options: &'a Options,
    /// The deck's text.
    pub text: String,
    /// The session that has run it.
    pub session: &'a Session,
    /// How that ended.
    pub outcome: &'a Result<Ending>,
    /// What was seen of the particles.
    pub film: Film,
    /// The rows of step tables.
    pub log: &'a perigrain_output::log::Log,
}

impl Sheet {
    /// Opens the file of a command line. Its content stays there until the page is written.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn of(o: &Options) -> Result<Option<Self>> {
        let Some(path) = o.report.clone() else { return Ok(None) };
        Self::open(path).map(Some)
    }

    /// Opens a file.
    ///
    /// # Errors
    /// As above.
    pub fn open(path: PathBuf) -> Result<Self> {
        let file = File::options().write(true).create(true).truncate(false).open(&path);
        let file = file.map_err(|e| trouble("write the report", &path, &e))?;
        // Clocks of files may be coarser than the system's.
        let since = SystemTime::now() - Duration::from_secs(2);
        Ok(Self { path, file, begin: Instant::now(), since })
    }

    /// Writes a run's page.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, subject: Subject) -> Result<()> {
        let page = report::html(&of_run(subject, self.begin.elapsed(), self.since));
        self.put(&page)
    }

    /// Writes a page.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn put(&mut self, page: &str) -> Result<()> {
        let outcome = self.file.set_len(0).and_then(|()| self.file.rewind());
        let outcome = outcome.and_then(|()| self.file.write_all(page.as_bytes()));
        outcome.map_err(|e| trouble("write the report", &self.path, &e).into())
    }

    /// The message once it is written.
    pub fn message(&self) -> String {
        format!("Report in {}", self.path.display())
    }
}

/// What a page about a deck's run is called.
pub(super) fn title(deck: &Deck) -> String {
    match deck {
        Deck::File(path) => {
            path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
        }
        Deck::Stdin => "a deck from standard input".into(),
    }
}

/// The report about a run.
fn of_run(subject: Subject, wall: Duration, since: SystemTime) -> Report {
    let (o, s) = (subject.options, subject.session);
    let name = deck::name(&o.deck);
    let mut r = Report::new(title(&o.deck));
    r.ended = match subject.outcome {
        Ok(ending) if ending.interrupted => Ended::Interrupted,
        Ok(_) => Ended::Well,
        Err(problems) => Ended::Failed(render::plain(problems, &s.sources)),
    };
    r.origin = format!("{}; {}", origin(&machine()), day(SystemTime::now()));
    r.figures = figures(s, wall);
    r.facts = facts(o, s);
    r.deck = Some(Text { what: "Deck", name, text: subject.text.clone() });
    r.tables = subject.log.tables(|t| t.clone());
    let mut names: Vec<&String> = r.tables.0.iter().flat_map(|t| &t.columns).collect();
    names.dedup();
    r.columns = names.into_iter().filter_map(|name| Some((name.clone(), s.column_is(name)?))).collect();
    r.messages = s.notes.0.iter().map(|d| weighed(d, s)).collect();
    r.parts = s.spent().parts.clone();
    r.plan = s.plan.as_ref().map(|plan| explain::text(plan, true));
    r.gallery = report::gathered(s.spent().pictures.iter().map(String::as_str), since);
    let (number, took) = (subject.film.seen, subject.film.took().as_secs_f64());
    r.facts.push(("snapshots".into(), format!("{number} in {}", span(took))));
    let last = taken(&s.world, subject.film.last());
    r.film = subject.film.finish(last);
    r.film.retain(|frame| !frame.is_empty());
    r
}

fn weighed(d: &perigrain_base::diag::Diagnostic, s: &Session) -> (Weight, String) {
    let weight = if d.severity == Severity::Note { Weight::Note } else { Weight::Warning };
    (weight, render::plain(&Diagnostics(vec![d.clone()]), &s.sources))
}

/// What is shown large.
fn figures(s: &Session, wall: Duration) -> Vec<(String, String)> {
    let worked = s.worked();
    let mut out = vec![
        ("particles".to_string(), grouped(s.world.n() as f64)),
        ("steps".into(), grouped(worked.steps as f64)),
        ("wall time".into(), span(wall.as_secs_f64())),
    ];
    if worked.steps > 0 && worked.seconds > 0.0 {
        out.push(("steps per second".into(), grouped(worked.steps as f64 / worked.seconds)));
    }
    out
}

/// What is shown small.
fn facts(o: &Options, s: &Session) -> Vec<(String, String)> {
    let (w, worked) = (&s.world, s.worked());
    let mut out = vec![
        ("threads".to_string(), threads().to_string()),
        ("time in steps".into(), span(worked.seconds)),
        ("units".into(), w.settings.units.name().into()),
        ("atom style".into(), w.particles.style.name().into()),
    ];
    if let Some(d) = &*w.domain {
        let sides = d.lengths().map(|l| perigrain_base::math::cformat::general(l, 4));
        out.push(("box at the end".into(), sides.join(" × ")));
        // Both faces of a side are mostly alike.
        let faces = d.boundary.letters();
        let faces = faces.split(' ').map(|f| if ["pp", "ff", "ss", "mm"].contains(&f) { &f[..1] } else { f });
        out.push(("boundary".into(), faces.collect::<Vec<_>>().join(" ")));
    }
    out.push(("time simulated".into(), perigrain_base::math::cformat::general(w.clock.time(), 6)));
    if o.compat.is_chosen() {
        out.push(("compat".into(), o.compat.name().into()));
    }
    let vars = o.vars.iter().map(|(name, values)| (format!("variable {name}"), values.join(" ")));
    out.extend(vars);
    out
}

/// A number in groups of three digits; of small ones three digits in all.
pub(super) fn grouped(value: f64) -> String {
    if value.fract() != 0.0 && value.abs() < 100.0 {
        return perigrain_base::math::cformat::general(value, 3);
    }
    let digits = format!("{value:.0}");
    let mut out = String::new();
    for (k, c) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && !out.ends_with('-') {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// Seconds in words.
pub(super) fn span(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{} s", perigrain_base::math::cformat::general(s, 3)),
        s if s < 6000.0 => format!("{:.0} min {:02.0} s", (s / 60.0).floor(), s % 60.0),
        s => format!("{:.0} h {:02.0} min", (s / 3600.0).floor(), (s / 60.0).floor() % 60.0),
    }
}

/// Day and minute, UTC.
fn day(now: SystemTime) -> String {
    let seconds = now.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_secs());
    // Days since 1 March of the year 0, of which each 400 years have 146 097 (Hinnant's civil_from_days).
    let days = seconds / 86_400 + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * of_year + 2) / 153;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    format!("{year}-{month:02}-{day:02} {:02}:{:02} UTC", seconds / 3600 % 24, seconds / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_times_and_days_are_readable() {
        assert_eq!(
            ["216000", "-1234", "0.0234", "99.94", "123.4"].map(|n| grouped(n.parse().unwrap())),
            ["216\u{202f}000", "-1\u{202f}234", "0.0234", "99.9", "123"]
        );
        assert_eq!([0.1234, 75.0, 754.0, 9000.0].map(span), ["0.123 s", "75 s", "12 min 34 s", "2 h 30 min"]);
        // By `date -u -d @N`.
        for (seconds, text) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_767_225_599, "2025-12-31 23:59 UTC"),
        ] {
            assert_eq!(day(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
    }
}
