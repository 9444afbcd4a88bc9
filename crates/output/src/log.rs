//! The log: one handle for all text of a run, to the screen and to the log file.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::file;
use super::rows::{Row, Tables};
use perigrain_base::diag::Result;

/// Where the lines of a deck are repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Echo {
    /// Nowhere.
    None,
    /// On the screen.
    Screen,
    /// In the log file; LAMMPS' default.
    #[default]
    Log,
    /// In both.
    Both,
}

impl Echo {
    /// LAMMPS' words.
    pub const NAMES: [(&'static str, Self); 4] =
        [("none", Self::None), ("screen", Self::Screen), ("log", Self::Log), ("both", Self::Both)];

    /// The meaning of a word.
    pub fn parse(word: &str) -> Option<Self> {
        Self::NAMES.iter().find(|name| name.0 == word).map(|name| name.1)
    }
}

/// A handle to the screen and the log file; clones write to the same places.
#[derive(Clone)]
pub struct Log(Arc<Mutex<Inner>>);

struct Inner {
    screen: Option<Box<dyn Write + Send>>,
    file: Option<(PathBuf, BufWriter<File>)>,
    /// When the file was last handed to the system.
    handed: Instant,
    /// The file, if another process was writing it when it was opened and no warning has been given yet.
    shared: Option<PathBuf>,
    echo: Echo,
    /// Rows of step tables, once they are to be kept.
    tables: Option<Tables>,
    /// Only the last of them is wanted.
    last_row: bool,
    /// Set for a brief screen: the number of characters per line.
    width: Option<Width>,
}

/// Lines that come faster than this are handed to the system together.
const RARELY: Duration = Duration::from_millis(100);

/// The number of characters per line of a screen, read each time.
type Width = Box<dyn Fn() -> usize + Send>;

impl std::fmt::Debug for Log {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let inner = self.inner();
        f.debug_struct("Log")
            .field("screen", &inner.screen.is_some())
            .field("file", &inner.file.as_ref().map(|(path, _)| path))
            .field("echo", &inner.echo)
            .finish()
    }
}

impl Log {
    /// A log with this screen (`None`: silent) and no file yet.
    pub fn new(screen: Option<Box<dyn Write + Send>>) -> Self {
        let (shared, tables, last_row, width) = (None, None, false, None);
        let handed = Instant::now();
        let inner =
            Inner { screen, file: None, handed, shared, echo: Echo::default(), tables, last_row, width };
        Self(Arc::new(Mutex::new(inner)))
    }

    /// A log that goes nowhere.
    pub fn silent() -> Self {
        Self::new(None)
    }

    /// A log on the standard output.
    pub fn stdout() -> Self {
        Self::new(Some(Box::new(std::io::stdout())))
    }

    /// Replaces the screen, for instance by one that makes room for a progress bar.
    pub fn set_screen(&self, screen: Option<Box<dyn Write + Send>>) {
        self.inner().screen = screen;
    }

    /// From now on the screen gets few words where [`Log::line_or`] has them, and rows no wider than it is.
    pub fn be_brief(&self, width: impl Fn() -> usize + Send + 'static) {
        self.inner().width = Some(Box::new(width));
    }

    /// The number of characters per line of a brief screen; `None` for one that shows everything.
    pub fn brief(&self) -> Option<usize> {
        let inner = self.inner();
        inner.screen.as_ref().and(inner.width.as_ref()).map(|width| width())
    }

    /// Switches to another log file, `log FILE [append]`; the old one is finished first.
    pub fn open(&self, path: &Path, append: bool) -> Result<()> {
        let mut inner = self.inner();
        inner.close()?;
        let (file, shared) = file::claim(path, append)?;
        inner.file = Some((path.to_path_buf(), file));
        inner.shared = shared.then(|| path.to_path_buf());
        Ok(())
    }

    /// The log file, if another process writes it too: returned once.
    pub fn take_shared(&self) -> Option<PathBuf> {
        self.inner().shared.take()
    }

    /// Finishes the log file, `log none`.
    pub fn close(&self) -> Result<()> {
        self.inner().close()
    }

    /// The log file in use.
    pub fn path(&self) -> Option<PathBuf> {
        self.inner().file.as_ref().map(|(path, _)| path.clone())
    }

    /// Sets where the lines of a deck are repeated.
    pub fn set_echo(&self, echo: Echo) {
        self.inner().echo = echo;
    }

    /// Echoes a line of a deck as [`Log::set_echo`] chose.
    pub fn echo(&self, line: &str) -> Result<()> {
        let mut inner = self.inner();
        let echo = inner.echo;
        if matches!(echo, Echo::Screen | Echo::Both) {
            inner.write_line(line);
        }
        if matches!(echo, Echo::Log | Echo::Both) {
            inner.record(line)?;
        }
        Ok(())
    }

    /// A line for screen and file.
    pub fn line(&self, line: &str) -> Result<()> {
        let mut inner = self.inner();
        inner.write_line(line);
        inner.record(line)
    }

    /// A line for screen and file; a brief screen gets another line, or none.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn line_or(&self, line: &str, brief: Option<&str>) -> Result<()> {
        let mut inner = self.inner();
        match (inner.width.is_some(), brief) {
            (true, Some(brief)) => inner.write_within(brief),
            (true, None) => {}
            (false, _) => inner.write_line(line),
        }
        inner.record(line)
    }

    /// A line for the screen alone; a brief screen breaks it at its width.
    pub fn to_screen(&self, line: &str) {
        self.inner().write_within(line);
    }

    /// A line for the file alone.
    pub fn to_log(&self, line: &str) -> Result<()> {
        self.inner().record(line)
    }

    /// From now on the rows of step tables are kept as numbers too.
    pub fn keep_rows(&self) {
        self.inner().tables.get_or_insert_default();
    }

    /// From now on the latest row of a step table is kept as numbers, and none before it.
    pub fn keep_last_row(&self) {
        self.keep_rows();
        self.inner().last_row = true;
    }

    /// A row of a step table, kept after [`Log::keep_rows`].
    pub fn row(&self, make: impl FnOnce() -> (Vec<String>, Row)) {
        let mut inner = self.inner();
        let last_row = inner.last_row;
        if let Some(tables) = &mut inner.tables {
            let (columns, row) = make();
            if last_row {
                tables.0.clear();
            }
            tables.push(columns, row);
        }
    }

    /// Gives access to the rows kept.
    pub fn tables<T>(&self, look: impl FnOnce(&mut Tables) -> T) -> T {
        look(self.inner().tables.get_or_insert_default())
    }

    /// Hands everything written so far to the system.
    pub fn flush(&self) -> Result<()> {
        self.inner().flush()
    }

    /// A text for the file alone, with which the program ends at once: the log is left as it is where another thread writes it.
    pub fn last_words(&self, text: &str) {
        if let Ok(mut inner) = self.0.try_lock() {
            let _ = inner.record(text).and_then(|()| inner.flush());
        }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// A screen that cannot be written (`| head`) is dropped; the file has it all.
    fn write_line(&mut self, line: &str) {
        if let Some(screen) = &mut self.screen
            && writeln!(screen, "{line}").is_err()
        {
            self.screen = None;
        }
    }

    /// Writes lines that are wider than a brief screen on several lines, broken between words.
    fn write_within(&mut self, text: &str) {
        match self.width.as_ref().map(|width| width()) {
            Some(width) => self.write_line(&within(text, width)),
            None => self.write_line(text),
        }
    }

    /// A file that cannot be written is reported once and then dropped.
    fn record(&mut self, line: &str) -> Result<()> {
        let Some((_, file)) = &mut self.file else { return Ok(()) };
        let mut outcome = writeln!(file, "{line}");
        // The file shows each row of a slow run at once, and keeps it when the program is killed; loops of a
        // deck that echo a million lines need not wait for the system at each.
        if outcome.is_ok() && self.handed.elapsed() >= RARELY {
            outcome = file.flush();
            self.handed = Instant::now();
        }
        self.report(outcome)
    }

    fn flush(&mut self) -> Result<()> {
        if let Some(screen) = &mut self.screen
            && screen.flush().is_err()
        {
            self.screen = None;
        }
        let Some((_, file)) = &mut self.file else { return Ok(()) };
        let outcome = file.flush();
        self.report(outcome)
    }

    fn report(&mut self, outcome: std::io::Result<()>) -> Result<()> {
        let Err(e) = outcome else { return Ok(()) };
        let path = self.file.take().map(|(path, _)| path).unwrap_or_default();
        Err(file::trouble("write the log file", &path, &e).into())
    }

    fn close(&mut self) -> Result<()> {
        self.flush()?;
        self.file = None;
        Ok(())
    }
}

/// The text with lines of at most so many columns, where no word is longer; continuation lines are indented.
fn within(text: &str, width: usize) -> String {
    let line = |line: &str| {
        let words = line.trim_start();
        let options = textwrap::Options::new(width)
            .initial_indent(&line[..line.len() - words.len()])
            .subsequent_indent("  ")
            .word_separator(textwrap::WordSeparator::AsciiSpace)
            .word_splitter(textwrap::WordSplitter::NoHyphenation)
            .break_words(false);
        textwrap::fill(words, options)
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// A screen that keeps its text, for tests and bindings.
#[derive(Clone, Debug, Default)]
pub struct Buffer(Arc<Mutex<Vec<u8>>>);

impl Buffer {
    /// What was written so far.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.0.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
    }
}

impl Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(path: &Path) -> String {
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn lines_go_where_they_should() {
        let dir = tempfile::tempdir().unwrap();
        let (a, b) = (dir.path().join("a.log"), dir.path().join("b.log"));
        let screen = Buffer::default();
        let log = Log::new(Some(Box::new(screen.clone())));
        log.open(&a, false).unwrap();
        log.clone().line("both").unwrap();
        log.to_screen("screen");
        log.to_log("file").unwrap();
        log.echo("units si").unwrap();
        log.open(&b, false).unwrap();
        log.set_echo(Echo::Both);
        log.echo("run 0").unwrap();
        log.open(&a, true).unwrap();
        log.set_echo(Echo::None);
        log.echo("unseen").unwrap();
        log.line("again").unwrap();
        log.close().unwrap();
        log.line("screen only").unwrap();
        assert_eq!(read(&a), "both\nfile\nunits si\nagain\n");
        assert_eq!(read(&b), "run 0\n");
        assert_eq!(screen.text(), "both\nscreen\nrun 0\nagain\nscreen only\n");
        assert_eq!(log.path(), None);
    }

    #[test]
    fn a_screen_of_few_words_leaves_the_file_as_it_is() {
        let dir = tempfile::tempdir().unwrap();
        let (path, screen) = (dir.path().join("a.log"), Buffer::default());
        let log = Log::new(Some(Box::new(screen.clone())));
        log.open(&path, false).unwrap();
        assert_eq!(log.brief(), None);
        log.line_or("all", Some("few")).unwrap();
        log.be_brief(|| 80);
        assert_eq!(log.brief(), Some(80));
        log.line_or("block", Some("line")).unwrap();
        log.line_or("more", None).unwrap();
        log.close().unwrap();
        assert_eq!((screen.text().as_str(), read(&path).as_str()), ("all\nline\n", "all\nblock\nmore\n"));
    }

    #[test]
    fn lines_break_between_words() {
        assert_eq!(within("results: a.txt, b.txt\nfast", 14), "results:\n  a.txt, b.txt\nfast");
        assert_eq!(within("results: a_long_name.txt b", 8), "results:\n  a_long_name.txt\n  b");
        assert_eq!(within("  Step   Temp   ", 13), "  Step   Temp");
        assert_eq!(within("  a_long_name.txt b", 8), "  a_long_name.txt\n  b");
    }

    #[test]
    fn a_row_of_a_slow_run_is_in_the_file_at_once() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.log");
        let log = Log::silent();
        log.open(&path, false).unwrap();
        log.line("quick").unwrap();
        std::thread::sleep(RARELY);
        log.line("slow").unwrap();
        assert_eq!(read(&path), "quick\nslow\n");
    }

    #[test]
    fn a_file_that_fails_is_named_once() {
        let log = Log::silent();
        assert!(log.open(Path::new("/no/such/folder/x.log"), false).is_err());
        if Path::new("/dev/full").exists() {
            log.open(Path::new("/dev/full"), true).unwrap();
            log.line("x").unwrap();
            let problem = log.flush().unwrap_err().to_string();
            assert!(problem.contains("/dev/full"), "{problem}");
            log.line("continues").unwrap();
            log.flush().unwrap();
        }
    }

    #[test]
    fn a_screen_that_fails_is_dropped() {
        struct Broken;
        impl Write for Broken {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(std::io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let log = Log::new(Some(Box::new(Broken)));
        log.line("x").unwrap();
        assert!(log.0.lock().unwrap().screen.is_none());
    }
}
