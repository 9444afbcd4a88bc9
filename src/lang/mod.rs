//! Decks as text: words with places, formulas, variables, flow control.

pub mod args;
pub mod command;
pub mod reference;

pub use args::Args;
pub use command::{Command, Line, Word};
pub use reference::{Param, RefKind, ValueRef};
