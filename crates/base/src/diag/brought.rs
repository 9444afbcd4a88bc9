//! Messages about positions in a file that a deck names.

use super::{Code, Diagnostic, Diagnostics, FileId, Span};

/// The error for a file with invalid data at a byte.
pub fn broken(at: usize, text: impl Into<String>) -> Diagnostics {
    Diagnostic::error(Code::BAD_FILE, place(at, at + 1), text).into()
}

/// The error for an element of a file that perigrain does not support, by name.
pub fn not_read(at: Span, what: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::error(Code::NOT_SUPPORTED, at, format!("{what} is not in perigrain yet"))
}

/// The span of some bytes of the file.
pub fn place(start: usize, end: usize) -> Span {
    Span::new(FileId::BROUGHT, start, end)
}
