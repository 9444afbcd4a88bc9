//! One logical line of a deck: its text, its words, their places.

use perigrain_base::diag::Span;
use std::sync::Arc;

/// One word of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The word without its quotes.
    pub text: String,
    /// Where it stands in the deck, quotes not included; for a substituted value the `$…`.
    pub span: Span,
    /// Whether it was quoted.
    pub quoted: bool,
    /// Where a substituted value was defined.
    pub origin: Option<Span>,
    /// The value is not known yet (`check` mode) and the text stands in for it.
    pub unknown: bool,
}

impl Word {
    /// An unquoted word as it stands in the deck.
    pub fn new(text: impl Into<String>, span: Span) -> Self {
        Self { text: text.into(), span, quoted: false, origin: None, unknown: false }
    }
}

/// A command: the first word of a line and what follows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// The first word.
    pub name: Word,
    /// All others.
    pub args: Vec<Word>,
    /// From the first word to the last.
    pub span: Span,
    /// The line after substitution, comment cut off.
    pub text: String,
}

/// One logical line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The line as it is echoed: continuations joined, comment kept.
    pub raw: Arc<str>,
    /// The line after each substitution in turn; empty if there was none. Echoed after `raw`.
    pub echoes: Vec<String>,
    /// The command, unless the line is blank or a comment.
    pub command: Option<Arc<Command>>,
    /// Whether a substitution changed the line.
    pub expanded: bool,
}
