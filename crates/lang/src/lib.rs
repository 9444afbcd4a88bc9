//! Decks as text: words with places, formulas, variables, flow control.
//!
//! The main types: [`Command`], a line with its words; [`Args`], which takes words and reports errors in them; [`ValueRef`], a
//! reference such as `c_ID[2]`. This crate knows no particles and no style: an environment resolves names.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod args;
pub mod command;
mod condition;
pub mod expr;
mod flow;
pub mod format;
mod lex;
pub mod number;
mod progress;
mod raw;
pub mod reference;
mod scan;
mod script;
mod substitute;
mod text;
mod value;
mod vars;

#[cfg(test)]
mod tests;

pub use args::{Args, blame};
pub use command::{Command, Line, Word};
pub use expr::{Dep, Expr};
pub use flow::{Files, Flow};
pub use lex::{is_unfinished, odd_letters, plain_value};
pub use number::{printf, value_text};
pub use raw::{RawLine, raw_lines, raw_words};
pub use reference::{Param, RefKind, ValueRef};
pub use script::Script;
pub use substitute::{Substituted, substitute, substitute_known};
pub use value::{Clock, Env, Question, Value};
pub use vars::{BOND_WORDS, Bonds, Kind, Partition, Turn, Vars, python};
