//! The live line of runs: how much of the whole deck is done, speed and time left as they have been so far, and the latest values;
//! and that of many runs side by side.

use super::live::{Around, Live};
use crate::human::{count, duration};
pub(super) use crate::plot::short;
use crate::session::{Ahead, Made, Options, steps_ahead};
use perigrain_output::log::Log;
use std::io::{IsTerminal, Stderr, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often the line is made anew; nothing is shown of a run that is over by then.
const PAUSE: Duration = Duration::from_millis(200);

/// How long a deck may be read for the number of its steps.
const PATIENCE: Duration = Duration::from_secs(20);

/// Characters that a terminal shows of a Ctrl-C, behind the line.
const KEY: usize = 2;

/// How much a new measurement of the speed counts against those before.
const NEWS: f64 = 0.2;

/// A line on standard error, hidden when that is no terminal.
#[derive(Clone, Default)]
pub struct Progress {
    live: Live,
    /// Whose thermo columns are shown.
    log: Option<Log>,
    state: Arc<Mutex<State>>,
}

/// Where the deck stands.
#[derive(Default)]
struct State {
    /// Steps of the whole deck, once they are known.
    deck: Arc<Mutex<Option<Ahead>>>,
    /// The flag that ends the look ahead, and when it began.
    looking: Option<(Arc<AtomicBool>, Instant)>,
    /// Steps requested for the runs that are over.
    before: i64,
    /// Steps of the present run: requested, those of its completed stretches, and those of the present one.
    requested: i64,
    stretches: i64,
    done: i64,
    /// Steps per second, learnt from the runs so far.
    rate: Option<f64>,
    /// When the line was made last; before that, when the first step was.
    drawn: Option<Instant>,
    /// Since when the present stretch is timed, and its steps then.
    mark: Option<(Instant, i64)>,
    /// Seconds and steps of stretches since the line was made last, setups not included.
    timed: (f64, i64),
}

impl Progress {
    /// A line that appears when a run has lasted for a while, with the latest thermo values of `log` if there is one.
    pub fn new(log: Option<Log>) -> Self {
        let live = Live::of_stderr();
        if let Some(log) = log.as_ref().filter(|_| !live.is_hidden()) {
            log.keep_rows();
        }
        Self { live, log, state: Arc::default() }
    }

    /// Reads the deck for the number of its steps, in the background.
    pub fn look_ahead(&self, options: &Options, name: &str, text: &str) {
        if self.live.is_hidden() {
            return;
        }
        let stop = Arc::new(AtomicBool::new(false));
        let mut state = self.state();
        state.looking = Some((stop.clone(), Instant::now()));
        let (deck, options, name, text) =
            (state.deck.clone(), options.clone(), name.to_owned(), text.to_owned());
        // It ends with the program.
        std::thread::spawn(move || {
            let ahead = steps_ahead(&options, &name, &text, &stop);
            *deck.lock().unwrap_or_else(PoisonError::into_inner) = ahead;
        });
    }

    /// A run of so many steps begins.
    pub fn requested(&self, steps: i64) {
        let mut state = self.state();
        state.before += state.requested;
        (state.requested, state.stretches, state.done, state.mark) = (steps, 0, 0, None);
    }

    /// A stretch of the run begins with its setup, which is left out of the speed of steps.
    pub fn begins(&self) {
        let mut state = self.state();
        state.stretches += state.done;
        (state.done, state.mark) = (0, Some((Instant::now(), 0)));
    }

    /// A step of the present run is made.
    pub fn step(&self, made: &Made) {
        if self.live.is_hidden() {
            return;
        }
        let now = Instant::now();
        let mut state = self.state();
        if made.done < state.done {
            state.stretches += state.done;
            state.mark = None;
        }
        state.done = made.done;
        let ends = made.done >= made.total;
        let due = now - *state.drawn.get_or_insert(now) >= PAUSE;
        if ends || due {
            state.time(now);
        }
        if ends && !state.is_running() {
            state.drawn = None;
            drop(state);
            return self.live.clear();
        }
        if !due {
            return;
        }
        state.drawn = Some(now);
        state.learn();
        if let Some((stop, _)) = state.looking.as_ref().filter(|(_, since)| since.elapsed() > PATIENCE) {
            stop.store(true, Ordering::Relaxed);
        }
        let text = state.line(made, self.log.as_ref(), self.live.width().saturating_sub(KEY));
        drop(state);
        self.live.draw(text);
    }

    /// Takes the line away, for instance before a message.
    pub fn clear(&self) {
        self.live.clear();
    }

    /// A Ctrl-C has been heard.
    pub fn heard(&self) {
        self.live.over_echo();
    }

    /// The program ends in the middle of something.
    pub fn leave(&self) {
        self.live.leave();
    }

    /// A writer for the terminal that steps around the line.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        self.live.around(inner)
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Adds up the time of the stretch since it was looked at last.
    fn time(&mut self, now: Instant) {
        if let Some((since, from)) = self.mark.replace((now, self.done)) {
            self.timed.0 += (now - since).as_secs_f64();
            self.timed.1 += self.done - from;
        }
    }

    /// Takes up a new measurement of the speed.
    fn learn(&mut self) {
        let (seconds, steps) = std::mem::take(&mut self.timed);
        if seconds > 0.0 {
            let rate = steps as f64 / seconds;
            self.rate = Some(self.rate.map_or(rate, |before| before + NEWS * (rate - before)));
        }
    }

    /// Whether it is known that further runs follow the present one.
    fn is_running(&self) -> bool {
        let deck = *self.deck.lock().unwrap_or_else(PoisonError::into_inner);
        deck.is_some_and(|all| self.before + self.stretches + self.done < all.steps)
    }

    /// Steps made and steps in all: those of the whole deck if they are known and fit what has been made, else those of the run,
    /// or of the present work if no run was requested; and the words around the second number.
    fn share(&self, made: &Made) -> (i64, i64, [&'static str; 2]) {
        let deck = *self.deck.lock().unwrap_or_else(PoisonError::into_inner);
        let in_run = self.stretches + self.done;
        let own = if self.before == 0 { ["", ""] } else { ["", " of this run"] };
        match deck {
            _ if in_run > self.requested => (made.done, made.total, ["", ""]),
            Some(all) if self.before + self.requested <= all.steps => {
                (self.before + in_run, all.steps, [if all.at_most { "up to " } else { "" }, ""])
            }
            _ => (in_run, self.requested, own),
        }
    }

    /// The line: bar, steps, and as much of speed, time left and the latest values as there is room for. The bar gives way to the
    /// steps.
    fn line(&self, made: &Made, log: Option<&Log>, width: usize) -> String {
        let (done, all, [most, of]) = self.share(made);
        let steps = format!("{} of {most}{} steps{of}", count(done as f64), count(all as f64));
        let (usual, room) =
            (if width < 100 { 10 } else { 20 }, width.saturating_sub(steps.chars().count() + 1));
        let wide = usual.min(room);
        let full = (wide as f64 * done as f64 / all.max(1) as f64).floor().clamp(0.0, wide as f64) as usize;
        let gap = if wide == 0 { "" } else { " " };
        let mut text = format!("{}{}{gap}{steps}", "█".repeat(full), "░".repeat(wide - full));
        let mut words = vec![];
        if let Some(rate) = self.rate.filter(|r| *r > 0.0) {
            let left = duration(((all - done) as f64 / rate).ceil());
            words.extend([format!(", {} steps/s", count(rate)), format!(", {left} left")]);
        }
        words.extend(values(made, log).iter().map(|value| format!("  {value}")));
        let mut long = text.chars().count();
        for word in words {
            long += word.chars().count();
            if long > width {
                break;
            }
            text += &word;
        }
        text
    }
}

/// Step, time, step size and the latest thermo row, as `step 120`, `t 1.2e-6`, `dt 1e-8`, `pe 0.31`.
fn values(made: &Made, log: Option<&Log>) -> Vec<String> {
    let mut words = vec![
        format!("step {}", made.step),
        format!("t {}", short(made.time)),
        format!("dt {}", short(made.dt)),
    ];
    let row = log.and_then(|log| log.tables(|t| t.last().map(|(c, r)| (c.to_vec(), r.values.clone()))));
    let (columns, values) = row.unwrap_or_default();
    let own = |c: &str| ["step", "time", "dt"].contains(&c);
    let shown = columns.iter().zip(values).filter(|(c, _)| !own(c));
    words.extend(shown.map(|(column, value)| format!("{column} {}", short(value))));
    words
}

/// The line of many runs: a bar of those that have ended and some words, hidden when standard error is no terminal.
pub struct Tally(Live);

impl Default for Tally {
    /// A line that shows itself when there is something to show.
    fn default() -> Self {
        Self(Live::of_stderr())
    }
}

impl Tally {
    /// Shows how many of how many have ended, and some words.
    pub fn show(&self, done: usize, of: usize, words: &str) {
        let full = (20 * done / of.max(1)).min(20);
        self.0.draw(format!("{}{} {done}/{of} runs  {words}", "█".repeat(full), "░".repeat(20 - full)));
    }

    /// Takes the line away.
    pub fn clear(&self) {
        self.0.clear();
    }

    /// Does something with the line out of the way.
    pub fn suspend(&self, what: impl FnOnce()) {
        self.0.aside(what);
    }

    /// A writer for the terminal that steps around the line.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        self.0.around(inner)
    }
}

/// Whether to use colours on standard error: a terminal, and `NO_COLOR` is not set.
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
    use perigrain_output::rows::Row;

    const MADE: Made = Made { done: 1, total: 10, step: 121, time: 1.21e-6, dt: 1e-8 };

    #[test]
    fn without_a_terminal_the_line_is_silent_and_text_passes_unchanged() {
        let progress = Progress::default();
        let mut out = vec![];
        progress.step(&MADE);
        progress.around(&mut out).write_all(b"Step Temp\n").unwrap();
        progress.step(&Made { done: 10, ..MADE });
        assert_eq!(out, b"Step Temp\n");
    }

    #[test]
    fn the_line_shows_the_latest_row_as_far_as_there_is_room() {
        let log = Log::silent();
        log.keep_rows();
        let columns = || ["step", "pe", "v_speed"].map(String::from).to_vec();
        log.row(|| (columns(), Row { step: 120, time: 1.2e-6, values: vec![120.0, 0.31257, 7.5e6] }));
        let all = ["step 121", "t 1.210e-6", "dt 1.000e-8", "pe 0.3126", "v_speed 7.500e6"];
        assert_eq!(values(&MADE, Some(&log)), all);
        assert_eq!(values(&MADE, None), all[..3]);
        let state = State { requested: 10, done: 1, rate: Some(3.0), ..State::default() };
        let line = |width| state.line(&MADE, Some(&log), width);
        assert_eq!(line(60), "█░░░░░░░░░ 1 of 10 steps, 3 steps/s, 3 s left  step 121");
        assert_eq!([25, 15, 14].map(line), ["█░░░░░░░░░ 1 of 10 steps", "░ 1 of 10 steps", "1 of 10 steps"]);
        assert!(line(94).ends_with("  step 121  t 1.210e-6  dt 1.000e-8  pe 0.3126"), "{}", line(94));
    }

    #[test]
    fn steps_are_those_of_the_whole_deck_once_they_are_known() {
        let progress = Progress::default();
        let share = || progress.state().share(&Made { done: 40, total: 50, ..MADE });
        progress.requested(100);
        progress.state().done = 40;
        progress.begins();
        progress.state().done = 40;
        assert_eq!(share(), (80, 100, ["", ""]));
        *progress.state().deck.lock().unwrap() = Some(Ahead { steps: 700, at_most: true });
        assert_eq!(share(), (80, 700, ["up to ", ""]));
        progress.requested(300);
        progress.state().done = 40;
        assert_eq!(share(), (140, 700, ["up to ", ""]));
        // The deck makes more than was foreseen, and then a minimization.
        progress.requested(500);
        assert_eq!(share(), (0, 500, ["", " of this run"]));
        progress.state().done = 501;
        assert_eq!(share(), (40, 50, ["", ""]));
    }
}
