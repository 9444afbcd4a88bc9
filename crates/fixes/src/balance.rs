//! fix balance: parsed so that LAMMPS decks run; the box is not divided among processes.

use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::{BuildCx, Doc, SealCx, Style};

/// The style.
pub struct Balance;

impl Style for Balance {
    fn name(&self) -> &'static str {
        "balance"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group balance N thresh shift DIMENSIONS ITERATIONS STOP | rcb  [weight STYLE …] [out FILE]",
            summary: "Accepted for the sake of LAMMPS decks: the box is not divided among processes.",
            text: "Threads share the work by themselves. The fix offers no values, and no file is written.",
            example: "fix share all balance 1000 1.1 shift xyz 20 1.05",
        }
    }
}

impl FixStyle for Balance {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        args.integer_from(0, "the number of steps N")?;
        args.positive("the imbalance that is borne")?;
        if args.choice("style of balance", &["shift", "rcb"])? == "shift" {
            let dims = args.expect("the directions, as xyz")?;
            if dims.text.is_empty() || !dims.text.chars().all(|c| "xyz".contains(c)) {
                let text = format!("`{}` names no directions: write some of x, y, z", dims.text);
                return fail(Code::BAD_VALUE, dims.span, text);
            }
            args.integer_from(1, "the number of iterations")?;
            args.positive("the imbalance at which to stop")?;
        }
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "out" => drop(args.expect("a file name")?),
                "weight" => weight(args, cx)?,
                _ => return Err(args.unknown(word, &["weight", "out"])),
            }
        }
        let text = "`fix balance` is without effect here: the box is not divided among processes, and threads share the work by themselves";
        cx.note(Diagnostic::note(Code::NO_EFFECT, cx.span, text));
        Ok(Box::new(Idle))
    }
}

/// `weight group n G1 f1 … | neigh f | time f | var name | store name`.
fn weight(args: &mut Args, cx: &BuildCx) -> Result<()> {
    match args.choice("style of weight", &["group", "neigh", "time", "var", "store"])? {
        "group" => {
            for _ in 0..args.integer_from(1, "the number of groups")? {
                cx.group(args.expect("a group")?)?;
                args.positive("the group's weight")?;
            }
        }
        "neigh" | "time" => drop(args.positive("the factor")?),
        _ => drop(args.expect("a name")?),
    }
    Ok(())
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
