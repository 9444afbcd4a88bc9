//! A logical line as rows: the stretches between its continuations, with their words and comments.

use crate::lex::{Mode, advance, blank};
use crate::scan::place;

/// A tab leads to the next multiple of this.
const TAB: usize = 8;

/// A stretch of a text that stays as it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<'a> {
    pub text: &'a str,
    /// The column it begins in.
    pub column: usize,
    /// Columns between it and what stands before it.
    pub gap: usize,
}

impl Piece<'_> {
    pub fn width(&self) -> usize {
        self.text.chars().count()
    }
}

/// What stands between two continuations of a logical line.
#[derive(Clone, Debug, Default)]
pub(super) struct Row<'a> {
    /// It begins a logical line.
    pub first: bool,
    /// The columns before the logical line's first word.
    pub indent: usize,
    pub words: Vec<Piece<'a>>,
    /// `&` ends it.
    pub joined: bool,
    pub comment: Option<Piece<'a>>,
    /// Its line break.
    pub ending: &'a str,
    /// One of its words contains a line break or a tab, so that its width is unknown.
    pub broken: bool,
    /// All of it, where it stays as it is.
    pub whole: Option<&'a str>,
}

impl<'a> Row<'a> {
    /// An empty line with the break of another.
    pub fn empty(of: &'a str) -> Self {
        Self { first: true, ending: ending(of), ..Self::default() }
    }

    /// A line that is not touched.
    pub fn as_it_is(whole: &'a str) -> Self {
        Self { first: true, whole: Some(whole), broken: true, ..Self::default() }
    }

    /// Whether it holds nothing but a comment.
    pub fn is_comment(&self) -> bool {
        self.words.is_empty() && !self.joined && self.comment.is_some()
    }
}

/// The line break at the end of a text.
fn ending(text: &str) -> &str {
    let body = text.strip_suffix('\n').unwrap_or(text);
    let body = if body.len() < text.len() { body.strip_suffix('\r').unwrap_or(body) } else { body };
    &text[body.len()..]
}

/// The text without blanks at its end. Empty lines stay: behind a continuation one ends the line.
fn trimmed(text: &str) -> &str {
    text.trim_end_matches(|c| c != '\n' && blank(c))
}

/// What follows a dollar sign and is still open.
#[derive(Clone, Copy, PartialEq)]
enum Dollar {
    None,
    Formula(usize),
    Name,
}

/// The rows of a logical line with all its breaks.
pub(super) fn rows_of(line: &str) -> Vec<Row<'_>> {
    let mut w = Walk { line, ..Walk::default() };
    w.row.first = true;
    let mut at = 0;
    for physical in line.split_inclusive('\n') {
        if w.physical(physical, at) {
            break;
        }
        at += physical.len();
    }
    w.end_word(line.len());
    w.row.ending = ending(line);
    // Nothing follows a continuation at the end of the text.
    if !w.joined_last {
        w.rows.push(w.row);
    }
    let indent = w.rows[0].indent;
    w.rows.iter_mut().for_each(|row| row.indent = indent);
    w.rows
}

struct Walk<'a> {
    line: &'a str,
    rows: Vec<Row<'a>>,
    row: Row<'a>,
    mode: Mode,
    dollar: Dollar,
    /// The word being read: its first byte, its column, and the columns before it.
    open: Option<(usize, usize, usize)>,
    /// The byte behind the last character of the word, continuations left out.
    end: usize,
    /// The column behind the last piece.
    behind: usize,
    column: usize,
    /// The physical line before ended a row.
    joined_last: bool,
}

impl Default for Walk<'_> {
    fn default() -> Self {
        Self {
            line: "",
            rows: vec![],
            row: Row::default(),
            mode: Mode::Plain,
            dollar: Dollar::None,
            open: None,
            end: 0,
            behind: 0,
            column: 0,
            joined_last: false,
        }
    }
}

impl<'a> Walk<'a> {
    /// Walks along a physical line that starts at byte `start`; whether the rest of the logical line is a comment.
    fn physical(&mut self, line: &'a str, start: usize) -> bool {
        let body = &line[..line.len() - ending(line).len()];
        let joined = body.trim_end().strip_suffix('&');
        let content = joined.unwrap_or(body);
        (self.column, self.joined_last) = (0, false);
        if self.open.is_none() {
            self.behind = 0;
        }
        if self.walk(content, start) {
            return true;
        }
        let ends_here = start + content.len();
        if joined.is_none() {
            // Only a text in three quotes continues behind a line break of its own; the break belongs to the text.
            self.end = self.open.map_or(self.end, |_| ends_here);
            return false;
        }
        let next = self.line[start + line.len()..].chars().next();
        let inside = self.dollar != Dollar::None || matches!(self.mode, Mode::Quote(..));
        // Behind a word that continues there may be lines that hold nothing but a continuation.
        let touches = self.end == ends_here || content.is_empty();
        if self.open.is_some() && (inside || (touches && self.glued(start + line.len(), next))) {
            return false;
        }
        self.end_word(ends_here);
        self.row.joined = true;
        self.row.ending = ending(line);
        let row = std::mem::take(&mut self.row);
        self.rows.push(row);
        self.joined_last = true;
        false
    }

    /// Whether the characters behind a continuation belong to the word before it.
    fn glued(&self, next_line: usize, first: Option<char>) -> bool {
        let Some(first) = first else { return false };
        if first == '&' {
            // Perhaps the next line holds nothing but a continuation of its own.
            let line = self.line[next_line..].split_inclusive('\n').next().unwrap_or("");
            let behind = next_line + line.len();
            if line.trim_end() == "&" {
                return self.glued(behind, self.line[behind..].chars().next());
            }
        }
        !blank(first) && first != '#'
    }

    /// Walks along the characters of a physical line; whether a comment begins among them.
    fn walk(&mut self, content: &'a str, start: usize) -> bool {
        let mut rest = content;
        while let Some(c) = rest.chars().next() {
            let at = start + place(content, rest);
            let Ok((after, mode)) = advance(rest, at, self.mode) else { break };
            if let Mode::Comment(_) = mode {
                self.end_word(at);
                let text = trimmed(&self.line[at..self.line.len() - ending(self.line).len()]);
                let gap = self.column.saturating_sub(self.behind);
                if self.row.words.is_empty() && self.row.first {
                    self.row.indent = self.column;
                }
                self.row.comment = Some(Piece { text, column: self.column, gap });
                return true;
            }
            let is_gap =
                self.mode == Mode::Plain && mode == Mode::Plain && self.dollar == Dollar::None && blank(c);
            let taken = rest.len() - after.len();
            if is_gap {
                self.end_word(at);
            } else {
                self.begin_word(at);
                self.end = at + taken;
            }
            self.follow_dollar(c, rest, mode);
            for c in rest[..taken].chars() {
                self.column = if c == '\t' { (self.column / TAB + 1) * TAB } else { self.column + 1 };
            }
            (rest, self.mode) = (after, mode);
        }
        false
    }

    fn follow_dollar(&mut self, c: char, rest: &str, mode: Mode) {
        if self.mode != Mode::Plain || mode != Mode::Plain {
            return;
        }
        self.dollar = match (self.dollar, c) {
            (Dollar::None, '$') if rest.starts_with("$(") => Dollar::Formula(0),
            (Dollar::None, '$') if rest.starts_with("${") => Dollar::Name,
            (Dollar::Formula(n), '(') => Dollar::Formula(n + 1),
            (Dollar::Formula(1), ')') => Dollar::None,
            (Dollar::Formula(n), ')') => Dollar::Formula(n.saturating_sub(1)),
            (Dollar::Name, '}') => Dollar::None,
            (dollar, _) => dollar,
        };
    }

    fn begin_word(&mut self, at: usize) {
        if self.open.is_none() {
            self.open = Some((at, self.column, self.column.saturating_sub(self.behind)));
        }
    }

    /// Ends the word that is open, at `at` at the latest.
    fn end_word(&mut self, at: usize) {
        let Some((start, column, gap)) = self.open.take() else { return };
        let text = &self.line[start..self.end.min(at)];
        // A `$(` that is never closed takes in what stands behind it.
        let text = if self.dollar == Dollar::None { text } else { trimmed(text) };
        self.row.broken |= text.contains(['\n', '\t']);
        if self.row.words.is_empty() && self.row.first {
            self.row.indent = column;
        }
        self.row.words.push(Piece { text, column, gap });
        self.behind = self.column;
    }
}
