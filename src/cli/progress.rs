//! The live line of a run: steps done, time, thermo columns, speed and time left on a terminal, nothing otherwise;
//! the only user of indicatif.

pub(super) use crate::plot::short;
use crate::session::Made;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use perigrain_out::log::Log;
use std::io::{IsTerminal, Stderr, Write, stderr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often the line's words are made anew; indicatif draws no faster.
const PAUSE: Duration = Duration::from_millis(200);

/// Thermo columns beside step and time that find room in the line.
const COLUMNS: usize = 4;

/// A line on standard error, hidden when that is no terminal.
#[derive(Clone)]
pub struct Progress {
    bar: ProgressBar,
    /// Whether it is never seen; to ask the line takes as long as to move a few particles.
    hidden: bool,
    /// Whose thermo columns are shown.
    log: Option<Log>,
    shown: Arc<Mutex<Option<Instant>>>,
}

impl Progress {
    /// A line that shows itself at the first step, with the latest thermo values of `log` if there is one.
    pub fn new(log: Option<Log>) -> Self {
        let target = if stderr().is_terminal() {
            ProgressDrawTarget::stderr_with_hz(5)
        } else {
            ProgressDrawTarget::hidden()
        };
        if let Some(log) = log.as_ref().filter(|_| !target.is_hidden()) {
            log.keep_rows();
        }
        Self::on(target, log)
    }

    fn on(target: ProgressDrawTarget, log: Option<Log>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) =
            ProgressStyle::with_template("{bar:20} {pos}/{len}  {wide_msg} {per_sec}, {eta} left")
        {
            bar.set_style(style);
        }
        Self { hidden: bar.is_hidden(), bar, log, shown: Arc::default() }
    }

    /// A step of the present run is made.
    pub fn step(&self, made: &Made) {
        if self.hidden {
            return;
        }
        if made.done <= 1 {
            self.bar.set_length(made.total.max(0) as u64);
            self.bar.reset();
        }
        self.bar.set_position(made.done.max(0) as u64);
        if made.done >= made.total {
            self.bar.finish_and_clear();
            return;
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.is_none_or(|t| t.elapsed() >= PAUSE) {
            *shown = Some(Instant::now());
            self.bar.set_message(words(made, self.log.as_ref()));
        }
    }

    /// Takes the line away, for instance before a message.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// A writer for the terminal that steps around the line.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        Around { bar: self.bar.clone(), inner }
    }
}

/// The line of many runs: a bar of those that have ended and some words, hidden when standard error is no terminal.
pub struct Tally {
    bar: ProgressBar,
}

impl Default for Tally {
    /// A line that shows itself when there is something to show.
    fn default() -> Self {
        let target = if stderr().is_terminal() {
            ProgressDrawTarget::stderr_with_hz(5)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {pos}/{len} runs  {wide_msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl Tally {
    /// Shows how many of how many have ended, and some words.
    pub fn show(&self, done: usize, of: usize, words: &str) {
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(words.to_owned());
    }

    /// Takes the line away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Does something with the line out of the way.
    pub fn suspend(&self, what: impl FnOnce()) {
        self.bar.suspend(what);
    }

    /// A writer for the terminal that steps around the line.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        Around { bar: self.bar.clone(), inner }
    }
}

/// Step, time, step size and the latest thermo row, as `step 120  t 1.2e-6  dt 1e-8  pe 0.31`.
fn words(made: &Made, log: Option<&Log>) -> String {
    let mut text = format!("step {}  t {}  dt {}", made.step, short(made.time), short(made.dt));
    let row = log.and_then(|log| log.tables(|t| t.last().map(|(c, r)| (c.to_vec(), r.values.clone()))));
    let (columns, values) = row.unwrap_or_default();
    let own = |c: &str| ["step", "time", "dt"].contains(&c);
    for (column, value) in columns.iter().zip(values).filter(|(c, _)| !own(c)).take(COLUMNS) {
        text += &format!("  {column} {}", short(value));
    }
    text
}

/// Writes with the line out of the way, so that table lines and live line do not run into each other.
pub struct Around<W> {
    bar: ProgressBar,
    inner: W,
}

impl<W: Write> Write for Around<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let inner = &mut self.inner;
        self.bar.suspend(|| inner.write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}

/// Whether colours are welcome on standard error: a terminal, and `NO_COLOR` is not set.
pub fn colors(stderr: &Stderr) -> bool {
    stderr.is_terminal() && colors_wanted()
}

/// Whether `NO_COLOR` leaves colours in.
pub fn colors_wanted() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_out::rows::Row;

    const MADE: Made = Made { done: 1, total: 10, step: 121, time: 1.21e-6, dt: 1e-8 };

    #[test]
    fn without_a_terminal_the_line_is_silent_and_text_passes_unchanged() {
        let progress = Progress::on(ProgressDrawTarget::hidden(), None);
        let mut out = vec![];
        progress.step(&MADE);
        progress.around(&mut out).write_all(b"Step Temp\n").unwrap();
        progress.step(&Made { done: 10, ..MADE });
        assert_eq!(out, b"Step Temp\n");
    }

    #[test]
    fn the_line_shows_the_latest_row() {
        let log = Log::silent();
        log.keep_rows();
        let columns = || ["step", "pe", "v_speed"].map(String::from).to_vec();
        log.row(|| (columns(), Row { step: 120, time: 1.2e-6, values: vec![120.0, 0.31257, 7.5e6] }));
        assert_eq!(words(&MADE, Some(&log)), "step 121  t 1.210e-6  dt 1.000e-8  pe 0.3126  v_speed 7.500e6");
        assert_eq!(words(&MADE, None), "step 121  t 1.210e-6  dt 1.000e-8");
    }
}
