//! Messages: what went wrong, where, and the remedy; one diagnostic type for the whole program.

pub mod brought;
mod code;
mod nearest;
pub mod render;
mod source;

use std::collections::HashMap;
use std::sync::Arc;

pub use code::{CODES, Code, Kind};
pub use nearest::nearest;
pub use source::{FileId, Source, Sources, Span};

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Information.
    Note,
    /// The deck runs, but probably not as intended.
    Warning,
    /// The deck is refused.
    Error,
}

/// A second position that explains the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Position.
    pub span: Span,
    /// Text about it.
    pub text: String,
}

/// One problem: what, where, why, and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Severity.
    pub severity: Severity,
    /// The kind of mistake; stable, explained by `perigrain explain`.
    pub code: Code,
    /// One sentence, no full stop, lower case.
    pub message: String,
    /// The words to underline; `None` if the problem is not in a deck.
    pub span: Option<Span>,
    /// Further positions.
    pub labels: Vec<Label>,
    /// Remedies.
    pub help: Vec<String>,
    /// The text of a file that spans in [`FileId::BROUGHT`] refer to.
    pub text: Option<Arc<Source>>,
}

impl Diagnostic {
    /// An error.
    pub fn error(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message)
    }

    /// A warning.
    pub fn warning(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message)
    }

    /// A note.
    pub fn note(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Note, code, span, message)
    }

    fn new(
        severity: Severity,
        code: Code,
        span: impl Into<Option<Span>>,
        message: impl Into<String>,
    ) -> Self {
        Self {
            severity,
            code,
            message: message.into(),
            span: span.into(),
            labels: vec![],
            help: vec![],
            text: None,
        }
    }

    /// Adds a remedy.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Adds a second position.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Sets the span if there is none yet.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        self.span.get_or_insert(span);
        self
    }
}

/// One or more problems; never empty as an error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// Whether anything was reported.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds one more.
    pub fn push(&mut self, d: Diagnostic) {
        self.0.push(d);
    }

    /// Appends all of another list.
    pub fn append(&mut self, mut other: Diagnostics) {
        self.0.append(&mut other.0);
    }

    /// Merges repeated problems at their first occurrence, with their count (as in loops).
    #[must_use]
    pub fn together(self) -> Self {
        let (mut out, mut often): (Vec<Diagnostic>, Vec<usize>) = (vec![], vec![]);
        let mut known: HashMap<(Option<Span>, String), Vec<usize>> = HashMap::new();
        for d in self.0 {
            let alike = known.entry((d.span, d.message.clone())).or_default();
            match alike.iter().find(|k| out[**k] == d) {
                Some(k) => often[*k] += 1,
                None => {
                    alike.push(out.len());
                    out.push(d);
                    often.push(1);
                }
            }
        }
        for (d, n) in out.iter_mut().zip(often).filter(|(_, n)| *n > 1) {
            d.help.push(format!("this comes {n} times: the line is read as often"));
        }
        Self(out)
    }

    /// Whether there is an error among them.
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|d| d.severity == Severity::Error)
    }

    /// Sets the text that spans in [`FileId::BROUGHT`] refer to.
    #[must_use]
    pub fn within(mut self, text: &Arc<Source>) -> Self {
        let points = |d: &Diagnostic| {
            d.span.is_some_and(|s| s.file == FileId::BROUGHT)
                || d.labels.iter().any(|l| l.span.file == FileId::BROUGHT)
        };
        self.0.iter_mut().filter(|d| points(d)).for_each(|d| d.text = Some(text.clone()));
        self
    }

    /// Sets this span where there is none.
    #[must_use]
    pub fn at(self, span: Span) -> Self {
        Self(self.0.into_iter().map(|d| d.at(span)).collect())
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(d: Diagnostic) -> Self {
        Self(vec![d])
    }
}

impl std::fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (k, d) in self.0.iter().enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{}", d.message)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Result type of all fallible functions.
pub type Result<T> = core::result::Result<T, Diagnostics>;

/// The reason why a check ends early: a file that only a run of the deck writes. A note returned as an error
/// ends a check.
pub fn unseen(span: impl Into<Option<Span>>, name: &str) -> Diagnostics {
    let text = format!("`check` cannot look into `{name}`, which the deck itself may have written by now");
    Diagnostic::note(Code::NO_FILE, span, text).into()
}

/// Returns a single error.
pub fn fail<T>(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Result<T> {
    Err(Diagnostic::error(code, span, message).into())
}
