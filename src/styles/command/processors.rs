//! `processors`: LAMMPS' grid of processes; one process here.

use super::common::{bad_keyword, before_box, setting, whole};
use super::{Act, CommandStyle};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::Args;
use crate::styles::{BuildCx, Doc, Style};

/// The command.
pub struct Processors;

impl Style for Processors {
    fn name(&self) -> &'static str {
        "processors"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "processors Px Py Pz",
            summary: "Accepted for the sake of LAMMPS decks: perigrain is one process with threads.",
            text: "Must come before the box. Each number is `*` or from 1. Threads are set on the command line.",
            example: "processors * * 1",
        }
    }
}

impl CommandStyle for Processors {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "processors")?;
        for what in ["the processes in x", "the processes in y", "the processes in z"] {
            let word = a.expect(what)?;
            if word.text != "*" && whole(word, what)? < 1 {
                return fail(Code::BAD_VALUE, word.span, format!("{what} must be `*` or at least 1"));
            }
        }
        if let Some(word) = a.next() {
            return Err(bad_keyword(a, word, &[], &["grid", "map", "part", "file", "numa_nodes"]));
        }
        let text = "processors has no effect here: perigrain is one process with threads";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(|_| Ok(())))
    }
}
