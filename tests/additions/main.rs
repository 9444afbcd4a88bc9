//! Styles that the program does not have, each in one file with one line that puts it into the table of its kind: what
//! `CONTRIBUTING.md` says a style costs. Laws of peridynamic bonds and of contacts have the like in `crates/peri/tests/new_law.rs`
//! and `crates/contact/src/tests/new_law.rs`.

mod new_bond_style;
mod new_command;
mod new_compute;
mod new_dump;
mod new_fix;

use perigrain::graph::catalogue::Tables;
use perigrain::session::{Options, Session};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A session of the program with one more style.
fn session(add: impl FnOnce(&mut Tables)) -> Session {
    let mut tables = Tables::default();
    add(&mut tables);
    for kind in ["pair", "bond", "fix", "compute", "dump", "command"] {
        let names = tables.names(kind).unwrap();
        let new = names.iter().collect::<BTreeSet<_>>().len();
        assert_eq!(names.len(), new, "a {kind} that the program has");
    }
    Session::new(Options { tables: Arc::new(tables), ..Options::default() }).unwrap()
}

/// The session after a deck that must work.
fn run(add: impl FnOnce(&mut Tables), deck: &str) -> Session {
    let mut session = session(add);
    session.run_text("deck", deck).unwrap_or_else(|e| panic!("{e}"));
    session
}

/// The first problem of a line behind a deck.
fn refused(session: &mut Session, line: &str) -> String {
    session.run_text("line", line).expect_err(line).0.remove(0).message
}
