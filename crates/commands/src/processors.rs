//! `processors`: LAMMPS' grid of processes; the box is not divided here.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{bad_keyword, before_box, choice_or_refuse, setting, whole};
use perigrain_styles::{BuildCx, Doc, Style};

/// The orders of processes that LAMMPS knows.
const MAPS: [&str; 8] = ["cart", "cart/reorder", "xyz", "xzy", "yxz", "yzx", "zxy", "zyx"];

/// The command.
pub struct Processors;

impl Style for Processors {
    fn name(&self) -> &'static str {
        "processors"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "processors Px Py Pz [grid onelevel|numa] [map STYLE] [numa_nodes N]",
            summary: "Accepted for the sake of LAMMPS decks: the box is not divided among processes.",
            text: "Must come before the box. Each number is `*` or from 1. STYLE is `cart`, `cart/reorder` or an order of x, y and z. \
                   Threads are set on the command line.",
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
        while let Some(word) = a.next() {
            match word.text.as_str() {
                "grid" => drop(choice_or_refuse(a, "grid", &["onelevel", "numa"], &["twolevel", "custom"])?),
                "map" => drop(a.choice("order of processes", &MAPS)?),
                "numa_nodes" => drop(whole(a.expect("how many nodes")?, "how many nodes")?),
                _ => return Err(bad_keyword(a, word, &["grid", "map", "numa_nodes"], &["part", "file"])),
            }
        }
        let text = "processors has no effect here: the box is not divided among processes";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(|_| Ok(())))
    }
}
