//! What went wrong, where, and what to write instead: one diagnostic type for the whole program.

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

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Runs, but probably not what was meant.
    Warning,
    /// Refused.
    Error,
}

/// A second place that explains the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What about it.
    pub text: String,
}

/// One problem: what, where, why, and what to write instead.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad.
    pub severity: Severity,
    /// The kind of mistake; stable, explained by `perigrain explain`.
    pub code: Code,
    /// One sentence, no full stop, lower case.
    pub message: String,
    /// The words to underline; `None` when no place in a deck is to blame.
    pub span: Option<Span>,
    /// Further places.
    pub labels: Vec<Label>,
    /// What to do about it.
    pub help: Vec<String>,
    /// A text read on the way, where spans in [`FileId::BROUGHT`] point.
    pub text: Option<Arc<Source>>,
}

impl Diagnostic {
    /// A refusal.
    pub fn error(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message)
    }

    /// A warning.
    pub fn warning(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message)
    }

    /// A remark.
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

    /// Adds a sentence of advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Adds a second place.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Gives the problem a place when it has none yet.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        self.span.get_or_insert(span);
        self
    }
}

/// One or more problems; never empty when it stands for a failure.
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

    /// Adds all of another's.
    pub fn append(&mut self, mut other: Diagnostics) {
        self.0.append(&mut other.0);
    }

    /// Each problem once, where it came first; what came several times, as a loop is read turn by turn, says how often.
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

    /// Whether one of them refuses.
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|d| d.severity == Severity::Error)
    }

    /// Says in which text places in [`FileId::BROUGHT`] are.
    #[must_use]
    pub fn within(mut self, text: &Arc<Source>) -> Self {
        let points = |d: &Diagnostic| {
            d.span.is_some_and(|s| s.file == FileId::BROUGHT)
                || d.labels.iter().any(|l| l.span.file == FileId::BROUGHT)
        };
        self.0.iter_mut().filter(|d| points(d)).for_each(|d| d.text = Some(text.clone()));
        self
    }

    /// Gives those without a place this one.
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

/// What everything that can go wrong returns.
pub type Result<T> = core::result::Result<T, Diagnostics>;

/// Why a check cannot go on: a file that only a run of the deck writes. Notes that come back as a failure end a check.
pub fn unseen(span: impl Into<Option<Span>>, name: &str) -> Diagnostics {
    let text = format!("`check` cannot look into `{name}`, which the deck itself may have written by now");
    Diagnostic::note(Code::NO_FILE, span, text).into()
}

/// Short form of a failing return: one error diagnostic.
pub fn fail<T>(code: Code, span: impl Into<Option<Span>>, message: impl Into<String>) -> Result<T> {
    Err(Diagnostic::error(code, span, message).into())
}
