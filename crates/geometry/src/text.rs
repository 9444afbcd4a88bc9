//! A data file as text: lines without comments, words with places, numbers.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, FileId, Result, Source, Span, fail, unseen};
use perigrain_base::{gate, memory, stop};
use perigrain_lang::Word;
use perigrain_output::binary;
use perigrain_world::{Promise, World};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All bytes of a file, unpacked when its name ends in `.gz`.
///
/// # Errors
/// Files that cannot be read, or are too large for places in them to be counted.
pub fn load_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let file = gate::open(path)?;
    let mut bytes = vec![];
    if path.extension().is_some_and(|e| e == "gz") {
        // A small file may be packed from a huge one.
        let unpacked = flate2::read::MultiGzDecoder::new(file);
        memory::read_all(unpacked.take(u64::from(u32::MAX)), &mut bytes)?;
    } else {
        memory::read_file(file, &mut bytes)?;
    }
    if bytes.len() > u32::MAX as usize - 1 {
        return Err(odd("it is larger than 4 GB"));
    }
    Ok(bytes)
}

fn odd(text: &str) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidData, text)
}

/// Reads a file, unpacked when its name ends in `.gz`; binary dumps as text.
///
/// # Errors
/// Files that cannot be read, are no text, or are too large for places in them to be counted.
pub fn load(path: &Path) -> std::io::Result<Arc<Source>> {
    let bytes = load_bytes(path)?;
    if binary::ENDINGS.iter().any(|e| path.to_string_lossy().ends_with(e)) {
        let text = binary::as_text(&bytes)?;
        return Ok(Arc::new(Source { name: format!("{}, as text", path.display()), text }));
    }
    let text = String::from_utf8(bytes).map_err(|_| odd("it is no text"))?;
    Ok(Arc::new(Source { name: path.display().to_string(), text }))
}

/// Finds a deck's file, which is a `what`, in the working folder or beside the deck, and reads it; in a deck that is only looked at perhaps one
/// that an earlier line would have printed.
///
/// # Errors
/// Files that cannot be read, or that only a run would write.
pub fn find(w: &World, word: &Word, what: &str) -> Result<Arc<Source>> {
    let printed = |text: &str| Arc::new(Source { name: word.text.clone(), text: text.to_string() });
    let load = |path: &Path| load(path).map(|source| plain(w, source));
    seek(w, word, what, printed, load)
}

/// As [`find`], for a file that need not be text: its path and bytes.
///
/// # Errors
/// As `find`.
pub fn find_bytes(w: &World, word: &Word, what: &str) -> Result<(String, Vec<u8>)> {
    let printed = |text: &str| (word.text.clone(), text.as_bytes().to_vec());
    let load = |path: &Path| {
        let (name, bytes) = (path.display().to_string(), load_bytes(path)?);
        let bytes = w.read_files.plain_bytes(&name, bytes);
        Ok((name, bytes))
    };
    seek(w, word, what, printed, load)
}

/// The same text with blanks in the place of what looks like them.
pub fn plain(w: &World, source: Arc<Source>) -> Arc<Source> {
    if source.text.is_ascii() {
        return source;
    }
    let source = Arc::unwrap_or_clone(source);
    let text = w.read_files.plain(&source.name, source.text);
    Arc::new(Source { name: source.name, text })
}

fn seek<T>(
    w: &World,
    word: &Word,
    what: &str,
    printed: impl Fn(&str) -> T,
    load: impl Fn(&Path) -> std::io::Result<T>,
) -> Result<T> {
    let (name, promised) = (&word.text, &w.promised);
    match promised.get(name) {
        Some(Promise::Text(text)) => return Ok(printed(text)),
        Some(_) => return Err(unseen(word.span, name)),
        None => {}
    }
    let mut trouble = None;
    for path in [PathBuf::from(name), w.folder.join(name)] {
        match load(&path) {
            Ok(content) => {
                w.read_files.note(&path);
                return Ok(content);
            }
            Err(e) => drop(trouble.get_or_insert(e)),
        }
    }
    if let Some(e) = trouble.as_ref().filter(|e| gate::final_word(e)) {
        return fail(gate::code(e), word.span, format!("the {what} `{name}` cannot be read: {e}"));
    }
    if promised.anything {
        return Err(unseen(word.span, name));
    }
    let why = trouble.map_or(String::new(), |e| format!(": {e}"));
    Err(absent(word, &format!("the {what} `{name}` cannot be read{why}")))
}

/// In check mode: the file `word` of a line that reads it in a run is there, or may be there by then.
///
/// # Errors
/// It will not be.
pub fn comes(w: &World, word: &Word, what: &str) -> Result<()> {
    let name = &word.text;
    if gate::refuses(Path::new(name)) {
        let text = format!("the {what} `{name}` is not one that -safe lets a deck read");
        return fail(Code::NOT_ALLOWED, word.span, text);
    }
    let there = || gate::exists(Path::new(name)) || gate::exists(&w.folder.join(name));
    if w.promised.may_come(name) || there() {
        return Ok(());
    }
    Err(absent(word, &format!("the {what} `{name}` cannot be read: it is not there")))
}

/// The refusal of a word whose thing is not in perigrain.
pub fn absent(word: &Word, text: &str) -> Diagnostics {
    let d = Diagnostic::error(Code::NO_FILE, word.span, text);
    d.help("it is looked for in the working folder and beside the deck").into()
}

/// A line without its comment.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// The line up to a `#` that follows a blank or opens it.
    pub text: &'a str,
    /// What follows the `#`.
    pub comment: &'a str,
    /// Place of its first byte in the file.
    pub start: usize,
}

impl<'a> Line<'a> {
    /// Whether nothing stands on it.
    pub fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    /// The place of its words.
    pub fn span(&self) -> Span {
        let start = self.start + (self.text.len() - self.text.trim_start().len());
        Span::new(FileId::BROUGHT, start, start + self.text.trim().len())
    }

    /// Its words.
    pub fn words(&self) -> impl Iterator<Item = &'a str> {
        self.text.split_ascii_whitespace()
    }

    /// Its word `k`, from 0; the empty end of the line where there are fewer.
    pub fn word(&self, k: usize) -> &'a str {
        self.words().nth(k).unwrap_or(&self.text[self.text.len()..])
    }

    /// The place of a word of it.
    pub fn span_of(&self, word: &str) -> Span {
        let start = self.start + (word.as_ptr() as usize - self.text.as_ptr() as usize);
        Span::new(FileId::BROUGHT, start, start + word.len())
    }
}

/// A cursor over the lines of a text.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    text: &'a str,
    at: usize,
}

/// Bytes between two checks whether reading has to end.
const BETWEEN_LOOKS: usize = 1 << 16;

impl<'a> Lines<'a> {
    /// At the first line.
    pub fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    /// The line that begins at this byte.
    pub fn line_at(text: &'a str, at: usize) -> Option<Line<'a>> {
        Self { text, at }.take()
    }

    /// The next line, not taken.
    pub fn peek(&self) -> Option<Line<'a>> {
        let mut ahead = *self;
        ahead.take()
    }

    /// Takes the next line.
    pub fn take(&mut self) -> Option<Line<'a>> {
        if self.at >= self.text.len() {
            return None;
        }
        let rest = &self.text[self.at..];
        let end = rest.find('\n').unwrap_or(rest.len());
        let whole = &rest[..end];
        let start = self.at;
        self.at += end + 1;
        if start / BETWEEN_LOOKS != self.at / BETWEEN_LOOKS && stop::cuts() {
            // As if the text ended here: what comes of it counts for nothing.
            return None;
        }
        let bytes = whole.as_bytes();
        let mark = (0..end).find(|&k| bytes[k] == b'#' && (k == 0 || bytes[k - 1].is_ascii_whitespace()));
        let (text, comment) = match mark {
            Some(k) => (&whole[..k], whole[k + 1..].trim()),
            None => (whole, ""),
        };
        Some(Line { text, comment, start })
    }

    /// Takes the next line that is not blank.
    pub fn take_filled(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.take()?;
            if !line.is_blank() {
                return Some(line);
            }
        }
    }

    /// At this byte of a text.
    pub fn at(text: &'a str, at: usize) -> Self {
        Self { text, at }
    }

    /// The byte at which the next line begins.
    pub fn position(&self) -> usize {
        self.at
    }

    /// All of the text.
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// The place of the end.
    pub fn end(&self) -> Span {
        let end = self.text.trim_end().len();
        Span::new(FileId::BROUGHT, end.saturating_sub(1), end)
    }
}

/// Takes the line under a heading, which LAMMPS passes over whatever it holds: a note where it holds a text.
///
/// # Errors
/// Numbers there, which are a row that LAMMPS would lose.
pub fn under_heading(lines: &mut Lines, name: &str) -> Result<Option<Diagnostic>> {
    let Some(line) = lines.take().filter(|line| !line.is_blank()) else { return Ok(None) };
    if line.word(0).parse::<f64>().is_ok() {
        let text = format!("the line after the heading {name} must be blank");
        let d = Diagnostic::error(Code::SYNTAX, line.span(), text);
        return Err(d.help("LAMMPS passes over this line: put a blank one before the first row").into());
    }
    let text = format!("the text under the heading {name} is passed over, as LAMMPS does");
    Ok(Some(Diagnostic::note(Code::NO_EFFECT, line.span(), text)))
}

/// Reads a finite number.
#[inline]
pub fn number(line: &Line, word: &str, what: &str) -> Result<f64> {
    let looks = word.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
    match word.parse::<f64>() {
        Ok(a) if looks && a.is_finite() => Ok(a),
        _ => fail(Code::BAD_NUMBER, line.span_of(word), format!("{what} must be a number, not `{word}`")),
    }
}

/// Reads a whole number.
#[inline]
pub fn whole(line: &Line, word: &str, what: &str) -> Result<i64> {
    match word.parse::<i64>() {
        Ok(k) => Ok(k),
        Err(_) => {
            fail(Code::BAD_NUMBER, line.span_of(word), format!("{what} must be a whole number, not `{word}`"))
        }
    }
}

/// The refusal of something in the file that LAMMPS has and perigrain does not.
pub fn not_here(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error(Code::NOT_SUPPORTED, span, format!("{what} is not in perigrain yet"))
}
