//! `processors`: LAMMPS' grid of processes; the box is not divided here.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{before_box, setting, whole};
use perigrain_styles::words::{Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Processors;

impl Style for Processors {
    fn name(&self) -> &'static str {
        "processors"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Accepted for the sake of LAMMPS decks: the box is not divided among processes.",
            text: "Must come before the box. Threads are set on the command line.",
            example: "processors * * 1",
        }
    }
}

#[derive(Words)]
#[word(refused = "part file")]
struct Line {
    /// The processes in x: `*` or a number from 1.
    #[word(name = "Px")]
    _x: Processes,
    /// The processes in y.
    #[word(name = "Py")]
    _y: Processes,
    /// The processes in z.
    #[word(name = "Pz")]
    _z: Processes,
    #[word(keyword)]
    grid: Option<Grid>,
    #[word(keyword)]
    map: Option<Map>,
    #[word(keyword, name = "N", what = "how many nodes")]
    numa_nodes: Option<i64>,
}

/// How LAMMPS divides processes among nodes.
#[derive(Words)]
#[word(what = "grid", refused = "twolevel custom")]
enum Grid {
    OneLevel,
    Numa,
}

/// The orders of processes that LAMMPS knows.
#[derive(Words)]
#[word(what = "order of processes")]
enum Map {
    Cart,
    #[word("cart/reorder")]
    CartReorder,
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    Zxy,
    Zyx,
}

/// A number of processes or `*`.
struct Processes;

impl Value for Processes {
    const KIND: Kind = Kind::Text;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect(what)?;
        if word.text != "*" && whole(word, what)? < 1 {
            return fail(Code::BAD_VALUE, word.span, format!("{what} must be `*` or at least 1"));
        }
        Ok(Self)
    }
}

impl CommandStyle for Processors {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "processors")?;
        let _: Line = read(a, cx)?;
        let text = "processors has no effect here: the box is not divided among processes";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(|_| Ok(())))
    }
}
