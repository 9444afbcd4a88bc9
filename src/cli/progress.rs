//! The progress bar: steps done, speed and time left on a terminal, nothing otherwise; the only user of indicatif.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Stderr, Write, stderr};

/// A bar on standard error, hidden when that is no terminal.
#[derive(Clone)]
pub struct Progress(ProgressBar);

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress {
    /// A bar that shows itself at the first step.
    pub fn new() -> Self {
        let target = if stderr().is_terminal() {
            ProgressDrawTarget::stderr_with_hz(5)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} step {pos}/{len}, {per_sec}, {eta} left") {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// `done` of `total` steps of the present run are made.
    pub fn step(&self, done: i64, total: i64) {
        if self.0.is_hidden() {
            return;
        }
        if done <= 1 {
            self.0.reset();
            self.0.set_length(total.max(0) as u64);
        }
        self.0.set_position(done.max(0) as u64);
        if done >= total {
            self.0.finish_and_clear();
        }
    }

    /// Takes the bar away, for instance before a message.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }

    /// A writer for the terminal that steps around the bar.
    pub fn around<W: Write>(&self, inner: W) -> Around<W> {
        Around { bar: self.0.clone(), inner }
    }
}

/// Writes with the bar out of the way, so that table lines and bar do not run into each other.
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
    stderr.is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_terminal_the_bar_is_silent_and_text_passes_unchanged() {
        let progress = Progress(ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden()));
        let mut out = vec![];
        progress.step(1, 10);
        progress.around(&mut out).write_all(b"Step Temp\n").unwrap();
        progress.step(10, 10);
        assert_eq!(out, b"Step Temp\n");
    }
}
