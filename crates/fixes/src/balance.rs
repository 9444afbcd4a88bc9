//! fix balance: parsed so that LAMMPS decks run; the box is not divided among processes.

use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_plan::Op;
use perigrain_styles::words::{Grammar, Kind, Part, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use std::path::PathBuf;

/// The style.
pub struct Balance;

impl Style for Balance {
    fn name(&self) -> &'static str {
        "balance"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Accepted for the sake of LAMMPS decks: the box is not divided among processes.",
            text: "Threads share the work by themselves. The fix offers no values, and no file is written.",
            example: "fix share all balance 1000 1.1 shift xyz 20 1.05",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Would act at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 0)]
    _every: i64,
    /// The imbalance that is borne.
    #[word(name = "thresh", positive)]
    _threshold: f64,
    #[word(name = "style")]
    _style: Division,
    /// How particles count.
    #[word(keyword = "weight")]
    _weight: Vec<Weight>,
    /// A file name; nothing is written.
    #[word(keyword = "out", name = "FILE", what = "a file name")]
    _out: Option<PathBuf>,
}

/// How LAMMPS divides the box.
#[derive(Words)]
#[word(what = "style of balance")]
enum Division {
    /// By planes across some of the directions x, y, z.
    Shift {
        #[word(name = "DIMENSIONS")]
        _directions: Directions,
        #[word(name = "ITERATIONS", what = "the number of iterations", from = 1)]
        _iterations: i64,
        #[word(name = "STOP", what = "the imbalance at which to stop", positive)]
        _stop: f64,
    },
    /// By cuts across the longest edge.
    Rcb,
}

/// Some of the letters x, y, z.
struct Directions;

impl Value for Directions {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("the directions, as xyz")?;
        if !word.text.is_empty() && word.text.chars().all(|c| "xyz".contains(c)) {
            return Ok(Self);
        }
        let text = format!("`{}` names no directions: write some of x, y, z", word.text);
        fail(Code::BAD_VALUE, word.span, text)
    }
}

/// How particles count.
#[derive(Words)]
#[word(what = "style of weight")]
enum Weight {
    /// By group.
    Group {
        #[word(name = "groups")]
        _groups: Groups,
    },
    /// By the number of their neighbours.
    Neigh {
        #[word(name = "factor", what = "the factor", positive)]
        _factor: f64,
    },
    /// By the time that they take.
    Time {
        #[word(name = "factor", what = "the factor", positive)]
        _factor: f64,
    },
    /// By a variable.
    Var {
        #[word(name = "name", what = "a name")]
        _name: Word,
    },
    /// Into a property.
    Store {
        #[word(name = "name", what = "a name")]
        _name: Word,
    },
}

/// A number of groups, and each with its weight.
struct Groups;

impl Value for Groups {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::bare("n", Kind::Whole),
            Part::Many(&[Part::bare("group", Kind::Group), Part::bare("factor", Kind::Number)], 1),
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        for _ in 0..args.integer_from(1, "the number of groups")? {
            cx.group(args.expect("a group")?)?;
            args.positive("the group's weight")?;
        }
        Ok(Self)
    }
}

impl FixStyle for Balance {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let _: Line = read(args, cx)?;
        let text = "`fix balance` is without effect here: the box is not divided among processes, and threads share the work by themselves";
        cx.note(Diagnostic::note(Code::NO_EFFECT, cx.span, text));
        Ok(Box::new(Idle))
    }
}

#[derive(Clone)]
struct Idle;

impl Fix for Idle {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        Ok(vec![])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn is_validated() {
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        for words in ["10 1.1 rcb", "0 1.05 shift xz 5 1.01 weight neigh 0.8 weight group 1 all 2 out x"] {
            assert!(b.fix(&Balance, words).is_ok(), "{words}");
        }
        for words in [
            "1",
            "1 -1 rcb",
            "1 1.1 x uniform",
            "1 1.1 shift q 5 1.1",
            "1 1.1 rcb old",
            "1 1.1 rcb weight mass 1",
        ] {
            assert!(b.fix(&Balance, words).is_err(), "{words}");
        }
    }
}
