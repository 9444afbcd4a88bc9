//! The words of a command, consumed one by one; what is left over is an error at its place.

use super::command::{Command, Word};
use super::reference::{Param, ValueRef};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail, nearest};
use perigrain_base::memory;

/// A cursor over a command's words.
#[derive(Clone, Debug)]
pub struct Args<'a> {
    name: &'a Word,
    words: &'a [Word],
    at: usize,
    end: Span,
    /// Which words are keywords of this line.
    keyword: fn(&str) -> bool,
}

impl<'a> Args<'a> {
    /// All words after the command's name.
    pub fn new(command: &'a Command) -> Self {
        Self { name: &command.name, words: &command.args, at: 0, end: command.span, keyword: |_| false }
    }

    /// The command's name.
    pub fn command(&self) -> &'a str {
        &self.name.text
    }

    /// The place of the command's name.
    pub fn name_span(&self) -> Span {
        self.name.span
    }

    /// The next word, not consumed.
    pub fn peek(&self) -> Option<&'a Word> {
        self.words.get(self.at)
    }

    /// The text of the next word, not consumed; empty at the end.
    pub fn peek_text(&self) -> &'a str {
        self.peek().map_or("", |w| w.text.as_str())
    }

    /// The word `k` places ahead (0 is the next one).
    pub fn peek_at(&self, k: usize) -> Option<&'a Word> {
        self.words.get(self.at + k)
    }

    /// Takes the next word.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> Option<&'a Word> {
        let w = self.words.get(self.at)?;
        self.at += 1;
        Some(w)
    }

    /// Takes the next word if it is this one.
    pub fn eat(&mut self, text: &str) -> bool {
        let hit = self.peek_text() == text && !self.is_empty();
        self.at += usize::from(hit);
        hit
    }

    /// Whether all words are taken.
    pub fn is_empty(&self) -> bool {
        self.at >= self.words.len()
    }

    /// How many words are left.
    pub fn len(&self) -> usize {
        self.words.len() - self.at
    }

    /// The place just behind the last word taken, for "something is missing here".
    pub fn here(&self) -> Span {
        match (self.peek(), self.at.checked_sub(1).and_then(|k| self.words.get(k))) {
            (Some(w), _) => w.span,
            (None, Some(last)) => last.span,
            (None, None) => self.name.span,
        }
    }

    /// Takes the next word, which must be there.
    ///
    /// # Errors
    /// The line ends: `what` is missing.
    pub fn expect(&mut self, what: &str) -> Result<&'a Word> {
        match self.next() {
            Some(w) => Ok(w),
            None => Err(Diagnostic::error(
                Code::MISSING_ARGUMENT,
                self.here(),
                format!("`{}` ends too early: {what} is missing", self.name.text),
            )
            .into()),
        }
    }

    /// Takes a number.
    ///
    /// # Errors
    /// A missing word, or one that is no number.
    pub fn number(&mut self, what: &str) -> Result<f64> {
        let word = self.expect(what)?;
        parse_number(word, what)
    }

    /// Takes a number greater than zero.
    ///
    /// # Errors
    /// As `number`, and for zero, negative numbers and NaN.
    pub fn positive(&mut self, what: &str) -> Result<f64> {
        let word = self.expect(what)?;
        let a = parse_number(word, what)?;
        if word.unknown || a > 0.0 {
            return Ok(a);
        }
        let message = format!("{what} must be greater than zero, not {}", word.text);
        Err(blame(word, Code::BAD_VALUE, message).into())
    }

    /// Takes a number not below zero.
    ///
    /// # Errors
    /// As `number`, and for negative numbers and NaN.
    pub fn non_negative(&mut self, what: &str) -> Result<f64> {
        let word = self.expect(what)?;
        let a = parse_number(word, what)?;
        if word.unknown || a >= 0.0 {
            return Ok(a);
        }
        Err(blame(word, Code::BAD_VALUE, format!("{what} must not be negative: {}", word.text)).into())
    }

    /// Takes a whole number.
    ///
    /// # Errors
    /// A missing word, or one that is no whole number.
    pub fn integer(&mut self, what: &str) -> Result<i64> {
        let word = self.expect(what)?;
        match word.text.parse::<i64>() {
            Ok(k) => Ok(k),
            Err(_) if word.unknown => Ok(1),
            Err(_) => Err(blame(
                word,
                Code::BAD_NUMBER,
                format!("{what} must be a whole number, not `{}`", word.text),
            )
            .into()),
        }
    }

    /// Takes a whole number of at least `least`.
    ///
    /// # Errors
    /// As `integer`, and for smaller numbers.
    pub fn integer_from(&mut self, least: i64, what: &str) -> Result<i64> {
        let span = self.here();
        let unknown = self.peek().is_some_and(|w| w.unknown);
        let k = self.integer(what)?;
        if k >= least || unknown {
            return Ok(k.max(least));
        }
        fail(Code::BAD_VALUE, span, format!("{what} must be at least {least}, not {k}"))
    }

    /// Takes how many there are to be of what needs so many bytes each: a whole number of at least 1, for which there is room.
    ///
    /// # Errors
    /// As `integer_from`, and for numbers that do not fit into the memory.
    pub fn count(&mut self, what: &str, bytes: f64) -> Result<usize> {
        let (span, word) = (self.here(), self.peek_text());
        let count = self.integer_from(1, what)?;
        match memory::lacking(count as f64 * bytes, &format!("{word} as {what}")) {
            Some(d) => Err(d.at(span).into()),
            None => Ok(usize::try_from(count).unwrap_or(usize::MAX)),
        }
    }

    /// Takes a switch: `yes on true` or `no off false`.
    ///
    /// # Errors
    /// Any other word.
    pub fn flag(&mut self, what: &str) -> Result<bool> {
        let word = self.expect(what)?;
        match word.text.as_str() {
            "yes" | "on" | "true" => Ok(true),
            "no" | "off" | "false" => Ok(false),
            _ if word.unknown => Ok(true),
            _ => Err(blame(
                word,
                Code::BAD_VALUE,
                format!("{what} must be `yes` or `no`, not `{}`", word.text),
            )
            .into()),
        }
    }

    /// Takes a number or a reference such as `v_name`.
    ///
    /// # Errors
    /// Anything else.
    pub fn param(&mut self, what: &str) -> Result<Param> {
        let word = self.expect(what)?;
        match ValueRef::parse(&word.text, word.span)? {
            Some(r) => Ok(Param::Ref(r)),
            None => parse_number(word, what).map(Param::Number),
        }
    }

    /// Takes one of these words.
    ///
    /// # Errors
    /// Any other word, with the nearest of these.
    pub fn choice(&mut self, what: &str, known: &[&'static str]) -> Result<&'static str> {
        let word = self.expect(what)?;
        match known.iter().find(|k| **k == word.text) {
            Some(k) => Ok(k),
            None => Err(unknown_word(word, what, known).into()),
        }
    }

    /// The error for a keyword that this command does not have.
    pub fn unknown(&self, word: &Word, known: &[&'static str]) -> Diagnostics {
        unknown_word(word, &format!("keyword of {}", self.name.text), known).into()
    }

    /// Takes a type or a range of types: `2`, `*`, `2*`, `*4`, `2*4`; both ends included.
    ///
    /// # Errors
    /// Numbers outside 1 … `types`, empty ranges.
    pub fn type_range(&mut self, types: usize) -> Result<(u16, u16)> {
        let word = self.expect("an atom type")?;
        let bad = || {
            let message = format!("`{}` is no type or range of types from 1 to {types}", word.text);
            Err(blame(word, Code::BAD_VALUE, message).into())
        };
        let part = |s: &str, default: usize| {
            if s.is_empty() { Some(default) } else { s.parse::<usize>().ok() }
        };
        let (lo, hi) = match word.text.split_once('*') {
            Some((a, b)) => (part(a, 1), part(b, types)),
            None => (word.text.parse().ok(), word.text.parse().ok()),
        };
        match (lo, hi) {
            (Some(a), Some(b)) if a >= 1 && a <= b && b <= types => Ok((a as u16, b as u16)),
            _ if word.unknown => Ok((1, types.max(1) as u16)),
            _ => bad(),
        }
    }

    /// Takes all words that are left.
    pub fn rest(&mut self) -> &'a [Word] {
        let rest = &self.words[self.at.min(self.words.len())..];
        self.at = self.words.len();
        rest
    }

    /// Takes the words before the first one that `ends` knows, or all, as a line of their own.
    pub fn until(&mut self, ends: impl Fn(&str) -> bool) -> Args<'a> {
        let rest = &self.words[self.at.min(self.words.len())..];
        let count = rest.iter().position(|word| ends(&word.text)).unwrap_or(rest.len());
        self.at += count;
        let end = rest.get(count).map_or(self.end, |word| word.span);
        Args { name: self.name, words: &rest[..count], at: 0, end, keyword: self.keyword }
    }

    /// Sets which words are keywords of this line: lists of words end before them.
    pub fn keywords(&mut self, keyword: fn(&str) -> bool) {
        self.keyword = keyword;
    }

    /// Whether the next word is a keyword of this line.
    pub fn at_keyword(&self) -> bool {
        self.peek().is_some_and(|word| (self.keyword)(&word.text))
    }

    /// The end of the line: every word left over is an error at its place.
    ///
    /// # Errors
    /// Words left over.
    pub fn finish(&mut self) -> Result<()> {
        let name = &self.name.text;
        let list: Vec<_> = self
            .rest()
            .iter()
            .map(|w| blame(w, Code::EXTRA_ARGUMENT, format!("`{name}` does not expect `{}` here", w.text)))
            .collect();
        if list.is_empty() { Ok(()) } else { Err(Diagnostics(list)) }
    }

    /// The whole line's place.
    pub fn span(&self) -> Span {
        self.end
    }
}

/// A refusal of a word, which also shows where its value was defined if it came from a variable.
pub fn blame(word: &Word, code: Code, message: impl Into<String>) -> Diagnostic {
    let d = Diagnostic::error(code, word.span, message);
    match word.origin {
        Some(o) => d.label(o, format!("`{}` comes from here", word.text)),
        None => d,
    }
}

/// Reads a word as a number, as LAMMPS does (no NaN, no infinity).
///
/// # Errors
/// Anything that is no finite number.
pub fn parse_number(word: &Word, what: &str) -> Result<f64> {
    if word.unknown {
        return Ok(word.text.parse().unwrap_or(1.0));
    }
    let looks = word.text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    match word.text.parse::<f64>() {
        Ok(a) if looks && a.is_finite() => Ok(a),
        _ => {
            Err(blame(word, Code::BAD_NUMBER, format!("{what} must be a number, not `{}`", word.text)).into())
        }
    }
}

fn unknown_word(word: &Word, what: &str, known: &[&'static str]) -> Diagnostic {
    let d = blame(word, Code::UNKNOWN_KEYWORD, format!("unknown {what}: `{}`", word.text));
    match nearest(&word.text, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known here: {}", known.join(" "))),
    }
}
