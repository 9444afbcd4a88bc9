//! One line at the bottom of a terminal that is drawn anew and taken away; nothing where there is no terminal.

use console::{Term, measure_text_width};
use std::io::{IsTerminal, Write, stderr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How soon the line comes back behind text that was printed above it.
const SOON: Duration = Duration::from_millis(50);

/// The line, on standard error.
#[derive(Clone, Default)]
pub struct Live(Option<Arc<Mutex<Inner>>>);

struct Inner {
    term: Term,
    text: String,
    seen: bool,
    drawn: Instant,
}

impl Live {
    /// A line that is not seen yet; never where standard error is no terminal or one that cannot take a line back.
    pub fn of_stderr() -> Self {
        if !stderr().is_terminal() || std::env::var_os("TERM").is_some_and(|t| t == "dumb") {
            return Self(None);
        }
        let (term, text, drawn) = (Term::stderr(), String::new(), Instant::now());
        Self(Some(Arc::new(Mutex::new(Inner { term, text, seen: false, drawn }))))
    }

    /// Whether it is never seen.
    pub fn is_hidden(&self) -> bool {
        self.0.is_none()
    }

    /// How many characters it may have.
    pub fn width(&self) -> usize {
        self.with(|line| usize::from(line.term.size().1).saturating_sub(1)).unwrap_or(0)
    }

    /// Draws it, cut where the screen ends.
    pub fn draw(&self, text: String) {
        self.with(|line| {
            line.text = text;
            line.draw();
        });
    }

    /// Takes it away.
    pub fn clear(&self) {
        self.with(|line| {
            line.hide();
            line.text.clear();
        });
    }

    /// What the terminal shows of a key (`^C`) does not stay behind the line; without one, the next text begins on a line of its own.
    pub fn over_echo(&self) {
        self.with(|line| match line.seen {
            true => line.draw(),
            false => drop(line.term.write_line("")),
        });
    }

    /// Removes it as the program ends, unless another thread holds it and perhaps never lets go.
    pub fn leave(&self) {
        let Some(mut line) = self.0.as_ref().and_then(|inner| inner.try_lock().ok()) else { return };
        match line.seen {
            true => line.hide(),
            false => drop(line.term.write_line("")),
        }
    }

    /// Does something with the line out of the way.
    pub fn aside<T>(&self, what: impl FnOnce() -> T) -> T {
        let Some(inner) = &self.0 else { return what() };
        let mut line = inner.lock().unwrap_or_else(PoisonError::into_inner);
        line.hide();
        let out = what();
        if !line.text.is_empty() && line.drawn.elapsed() >= SOON {
            line.draw();
        }
        out
    }

    fn with<T>(&self, what: impl FnOnce(&mut Inner) -> T) -> Option<T> {
        let mut line = self.0.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        Some(what(&mut line))
    }

    /// A writer for the terminal that steps around the line.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        Around { live: self.clone(), inner }
    }
}

impl Inner {
    fn draw(&mut self) {
        self.hide();
        let width = usize::from(self.term.size().1).saturating_sub(1);
        let text = match measure_text_width(&self.text) > width {
            true => console::truncate_str(&self.text, width, ""),
            false => self.text.as_str().into(),
        };
        // A terminal that has gone needs no line.
        let _ = self.term.write_str(&text);
        let _ = self.term.flush();
        (self.seen, self.drawn) = (true, Instant::now());
    }

    fn hide(&mut self) {
        if std::mem::take(&mut self.seen) {
            let _ = self.term.clear_line();
        }
    }
}

/// Writes with the line out of the way, so that table lines and live line do not run into each other.
pub struct Around<W> {
    live: Live,
    inner: W,
}

impl<W: Write> Write for Around<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let inner = &mut self.inner;
        self.live.aside(|| {
            let written = inner.write(bytes)?;
            inner.flush()?;
            Ok(written)
        })
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.inner.flush()
    }
}
