//! Source texts and positions in them.

use std::sync::Arc;

/// Id of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct FileId(pub u32);

impl FileId {
    /// A text that is not among the sources, but part of a diagnostic ([`super::Diagnostic::text`]).
    pub const BROUGHT: FileId = FileId(u32::MAX);
}

/// A byte range of a source text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The bytes `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Self { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span that contains both, if they are in the same text; else the first.
    #[must_use]
    pub fn to(self, other: Span) -> Span {
        if self.file != other.file {
            return self;
        }
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One text with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The file's path, or `<stdin>`.
    pub name: String,
    /// The whole text.
    pub text: String,
}

/// All texts read so far.
#[derive(Clone, Debug, Default)]
pub struct Sources(Vec<Arc<Source>>);

impl Sources {
    /// Adds a text with a name.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        self.share(Arc::new(Source { name: name.into(), text: text.into() }))
    }

    fn share(&mut self, source: Arc<Source>) -> FileId {
        let known = self.0.iter().position(|s| Arc::ptr_eq(s, &source));
        let k = known.unwrap_or_else(|| {
            self.0.push(source);
            self.0.len() - 1
        });
        FileId(k as u32)
    }

    /// Adds the texts contained in diagnostics, so that their positions can be shown.
    #[must_use]
    pub fn adopt(&mut self, mut list: super::Diagnostics) -> super::Diagnostics {
        for d in &mut list.0 {
            let Some(text) = d.text.take() else { continue };
            let file = self.share(text);
            let spans = d.span.iter_mut().chain(d.labels.iter_mut().map(|l| &mut l.span));
            spans.filter(|s| s.file == FileId::BROUGHT).for_each(|s| s.file = file);
        }
        list
    }

    /// The number of texts so far.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// All texts so far.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|s| s.text.as_str())
    }

    /// The text with this id; the empty text if there is none.
    pub fn get(&self, id: FileId) -> Option<&Source> {
        self.0.get(id.0 as usize).map(AsRef::as_ref)
    }

    /// A shared reference to the text with this id.
    pub fn keep(&self, id: FileId) -> Option<Arc<Source>> {
        self.0.get(id.0 as usize).cloned()
    }

    /// Line and column (both from 1, column in characters) of a span's start.
    pub fn place(&self, span: Span) -> (usize, usize) {
        let Some(source) = self.get(span.file) else { return (0, 0) };
        let at = (span.start as usize).min(source.text.len());
        let before = source.text.get(..at).unwrap_or("");
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |k| k + 1);
        (line, before[start..].chars().count() + 1)
    }
}
