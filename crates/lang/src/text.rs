//! A text that keeps the origin of each of its bytes, through joins and substitutions.

use perigrain_base::diag::{FileId, Span};
use std::ops::Range;

/// A stretch of the text with one origin.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    /// First byte in the text.
    start: usize,
    /// Its place in the deck.
    span: Span,
    /// Where a substituted value was defined.
    origin: Option<Span>,
    /// The bytes are the deck's own, one for one.
    literal: bool,
    /// The value behind it is not known (`check` mode).
    unknown: bool,
}

/// A line with places: literal stretches map byte by byte, substituted ones to the `$…` they replace.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mapped {
    /// The text itself.
    pub text: String,
    parts: Vec<Part>,
}

impl Mapped {
    /// A text that stands at `span`; byte by byte if the lengths agree.
    pub fn whole(text: &str, span: Span, origin: Option<Span>, unknown: bool) -> Self {
        let literal = text.len() == (span.end - span.start) as usize;
        let part = Part { start: 0, span, origin, literal, unknown };
        Self { text: text.to_owned(), parts: vec![part] }
    }

    /// An empty text with room for a line of this length and the values in it.
    pub fn with_room(length: usize) -> Self {
        Self { text: String::with_capacity(length + 32), parts: Vec::with_capacity(4) }
    }

    /// Appends bytes of the deck that start at byte `at` of `file`.
    pub fn push_literal(&mut self, text: &str, file: FileId, at: usize) {
        if text.is_empty() && !self.parts.is_empty() {
            return;
        }
        let span = Span::new(file, at, at + text.len());
        self.parts.push(Part { start: self.text.len(), span, origin: None, literal: true, unknown: false });
        self.text.push_str(text);
    }

    /// Appends a line of the deck that starts at byte `at` of `file`, with what its odd characters are read as.
    pub fn push_line(&mut self, line: &str, file: FileId, at: usize, odd: &[(usize, &'static str)]) {
        let mut done = 0;
        for (k, plain) in odd {
            let end = k + line[*k..].chars().next().map_or(0, char::len_utf8);
            if *k > done {
                self.push_literal(&line[done..*k], file, at + done);
            }
            self.push_value(plain, Span::new(file, at + k, at + end), None, false);
            done = end;
        }
        self.push_literal(&line[done..], file, at + done);
    }

    /// Drops all but the first `length` bytes.
    pub fn truncate(&mut self, length: usize) {
        self.text.truncate(length);
        let kept = self.parts.partition_point(|p| p.start < length).max(1);
        self.parts.truncate(kept);
    }

    /// The places of what stands in the place of something else.
    pub fn replaced(&self, before: usize) -> impl Iterator<Item = Span> {
        self.parts.iter().filter(move |p| !p.literal && p.start < before).map(|p| p.span)
    }

    /// Appends a value that replaces what stands at `span`.
    pub fn push_value(&mut self, text: &str, span: Span, origin: Option<Span>, unknown: bool) {
        self.parts.push(Part { start: self.text.len(), span, origin, literal: false, unknown });
        self.text.push_str(text);
    }

    /// Appends `range` of another text with its places.
    pub fn append(&mut self, other: &Mapped, range: Range<usize>) {
        for (k, part) in other.from(range.start).take_while(|(_, p)| p.start < range.end) {
            let piece = other.extent(k);
            let (lo, hi) = (piece.start.max(range.start), piece.end.min(range.end));
            if lo >= hi {
                continue;
            }
            let span = other.part_span(part, lo..hi);
            self.parts.push(Part { start: self.text.len(), span, ..part.clone() });
            self.text.push_str(&other.text[lo..hi]);
        }
    }

    /// The first `len` bytes.
    pub fn head(&self, len: usize) -> Mapped {
        let mut out = Mapped::default();
        out.append(self, 0..len);
        if out.parts.is_empty() {
            out.push_literal("", self.span(0..0).file, self.span(0..0).start as usize);
        }
        out
    }

    /// The place of `range` in the deck.
    pub fn span(&self, range: Range<usize>) -> Span {
        if let [only] = self.parts.as_slice() {
            return self.part_span(only, range);
        }
        let first = self.part_at(range.start);
        let last = self.part_at(range.end.saturating_sub(1).max(range.start));
        let (Some(first), Some(last)) = (first, last) else { return Span::default() };
        self.part_span(first, range.clone()).to(self.part_span(last, range))
    }

    /// [`Mapped::span`], [`Mapped::origin`] and [`Mapped::unknown`] of `range` at once.
    pub fn place(&self, range: Range<usize>) -> (Span, Option<Span>, bool) {
        let k = self.parts.partition_point(|p| p.start <= range.start).saturating_sub(1);
        let inside =
            |p: &&Part| !range.is_empty() && range.end <= self.extent(k).end && range.start >= p.start;
        match self.parts.get(k).filter(inside) {
            Some(part) => (self.part_span(part, range), part.origin, part.unknown),
            None => (self.span(range.clone()), self.origin(range.clone()), self.unknown(range)),
        }
    }

    /// Where the value inside `range` was defined, if one was substituted there.
    pub fn origin(&self, range: Range<usize>) -> Option<Span> {
        self.overlapping(range).find_map(|p| p.origin)
    }

    /// Whether a value inside `range` is unknown.
    pub fn unknown(&self, range: Range<usize>) -> bool {
        self.overlapping(range).any(|p| p.unknown)
    }

    fn overlapping(&self, range: Range<usize>) -> impl Iterator<Item = &Part> {
        let near = self.from(range.start).take_while(move |(_, p)| p.start < range.end);
        near.filter_map(move |(k, p)| (range.start < self.extent(k).end).then_some(p))
    }

    /// The parts from the one on that holds byte `at`: lines are joined of many.
    fn from(&self, at: usize) -> impl Iterator<Item = (usize, &Part)> {
        let first = self.parts.partition_point(|p| p.start <= at).saturating_sub(1);
        self.parts.iter().enumerate().skip(first)
    }

    fn extent(&self, k: usize) -> Range<usize> {
        let end = self.parts.get(k + 1).map_or(self.text.len(), |p| p.start);
        self.parts[k].start..end
    }

    fn part_at(&self, at: usize) -> Option<&Part> {
        let k = self.parts.partition_point(|p| p.start <= at);
        self.parts.get(k.saturating_sub(1))
    }

    /// The place of what `part` and `range` share.
    fn part_span(&self, part: &Part, range: Range<usize>) -> Span {
        if !part.literal {
            return part.span;
        }
        let len = (part.span.end - part.span.start) as usize;
        let lo = range.start.saturating_sub(part.start).min(len);
        let hi = range.end.saturating_sub(part.start).clamp(lo, len);
        let at = part.span.start as usize;
        Span::new(part.span.file, at + lo, at + hi)
    }
}

/// The place of bytes `range` of a text of length `len` that stands at `at`: exact if it stands there literally, else all of it.
pub(super) fn within(at: Span, len: usize, range: Range<usize>) -> Span {
    if len != (at.end - at.start) as usize {
        return at;
    }
    Span::new(at.file, at.start as usize + range.start, at.start as usize + range.end)
}
