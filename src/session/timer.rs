//! `timer`: how much is printed about time, and the time limit for runs.

use super::{Session, refuse};
use perigrain_base::diag::{Code, Result};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Each, Kind, Value, Words};
use std::time::{Duration, Instant};

/// The settings of `timer`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timer {
    style: &'static str,
    mode: &'static str,
    limit: Option<Duration>,
}

impl Default for Timer {
    fn default() -> Self {
        Self { style: "normal", mode: "nosync", limit: None }
    }
}

impl Timer {
    /// Whether runs end with tables of where the time went.
    pub fn tables(&self) -> bool {
        matches!(self.style, "normal" | "full")
    }
}

/// The words of a `timer` line; of those that exclude each other the last one counts.
#[derive(Words)]
pub struct TimerLine {
    #[word(flatten)]
    settings: Each<Setting>,
}

/// A setting.
#[derive(Words)]
#[word(keywords)]
enum Setting {
    /// No tables follow a run.
    #[word(once)]
    Off,
    /// No tables follow a run.
    #[word(once)]
    Loop,
    /// Tables of time and neighbours follow a run.
    #[word(once)]
    Normal,
    /// Tables of time and neighbours follow a run.
    #[word(once)]
    Full,
    /// Read for LAMMPS' processes; there is one here.
    #[word(once)]
    Sync,
    /// Read for LAMMPS' processes; there is one here.
    #[word(once)]
    Nosync,
    /// The time after which runs end, counted from this line; `off` takes the limit back.
    #[word(once)]
    Timeout(#[word(name = "H:MM:SS|off")] TimeLimit),
    /// Runs end at a step that is a multiple of it.
    #[word(once)]
    Every(#[word(name = "N", what = "the steps between two readings of the clock", from = 1)] i64),
}

/// A limit of time, or none.
struct TimeLimit(Option<Duration>);

impl Value for TimeLimit {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        limit(args.expect("a time such as 2:00:00, or off")?).map(Self)
    }
}

/// A limit of time for all runs of a session, and what is left behind where it ends one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limit {
    /// How long the session may make steps, from its beginning on.
    pub time: Duration,
    /// The restart file that is written then, unless the deck has its own; `*` stands for the step.
    pub restart: String,
}

impl Session {
    /// Sets the limit that the session was given.
    pub(super) fn limit_time(&mut self) {
        let Some(limit) = &self.options.limit else { return };
        let settings = &mut self.world.settings;
        (settings.deadline, settings.limit_every) = (Some(self.born + limit.time), 1);
    }

    /// Reports that a time limit has ended a run, and which files continue from there if the session was given the limit.
    ///
    /// # Errors
    /// A log that cannot be written.
    pub(super) fn report_timeout(&self) -> Result<()> {
        let (step, log) = (self.world.clock.step, self.options.log.clone());
        log.line(&format!("Wall time limit reached at step {step}"))?;
        let Some(limit) = &self.options.limit else { return Ok(()) };
        let mut names = self.graph.restarts.names();
        if names.is_empty() {
            names.push(limit.restart.replacen('*', &step.to_string(), 1));
        }
        log.line(&format!("  to continue from: {}", names.join(" or ")))
    }

    /// The `timer` command.
    ///
    /// # Errors
    /// Unknown words, limits that are no times.
    pub(super) fn timer(&mut self, line: TimerLine) -> Result<()> {
        let (mut timer, mut every) = (self.timer, self.world.settings.limit_every);
        let mut restart = false;
        for given in line.settings.0 {
            match given.value {
                Setting::Off => timer.style = "off",
                Setting::Loop => timer.style = "loop",
                Setting::Normal => timer.style = "normal",
                Setting::Full => timer.style = "full",
                Setting::Sync => timer.mode = "sync",
                Setting::Nosync => timer.mode = "nosync",
                Setting::Timeout(TimeLimit(limit)) => (timer.limit, restart) = (limit, true),
                Setting::Every(steps) => every = steps,
            }
        }
        self.timer = timer;
        let settings = &mut self.world.settings;
        settings.limit_every = every;
        if restart {
            settings.deadline = timer.limit.map(|l| Instant::now() + l);
            self.world.clock.halt = perigrain_world::Halt::No;
        }
        if self.checking() {
            return Ok(());
        }
        let shown = timer.limit.map_or("off".to_owned(), |l| clock(l.as_secs()));
        self.options
            .log
            .line(&format!("New timer settings: style={}  mode={}  timeout={shown}", timer.style, timer.mode))
    }
}

/// `SS`, `MM:SS` or `H:MM:SS`; `off` and `unlimited` for none.
fn limit(word: &Word) -> Result<Option<Duration>> {
    if ["off", "unlimited"].contains(&word.text.as_str()) {
        return Ok(None);
    }
    match time(&word.text) {
        Some(time) => Ok(Some(time)),
        None => refuse(
            Code::BAD_VALUE,
            word.span,
            format!("`{}` is no time: write seconds, MM:SS, H:MM:SS or off", word.text),
        ),
    }
}

/// `SS`, `MM:SS` or `H:MM:SS` as a time.
pub fn time(text: &str) -> Option<Duration> {
    let parts: Option<Vec<u64>> = text.split(':').map(|p| p.parse().ok().filter(|n| *n < 1 << 32)).collect();
    let parts = parts.filter(|p| p.len() <= 3)?;
    Some(Duration::from_secs(parts.into_iter().fold(0, |s, p| 60 * s + p)))
}

/// Seconds as HH:MM:SS.
pub(super) fn clock(seconds: u64) -> String {
    format!("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}
