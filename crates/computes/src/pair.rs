//! compute pair: the energy of one pair style.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail, nearest};
use perigrain_lang::{Args, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::TALLY;
use perigrain_world::{Key, SlotId};

/// The style.
pub struct PairEnergy;

impl Style for PairEnergy {
    fn name(&self) -> &'static str {
        "pair"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Potential energy of one pair style, as a sub-style of `hybrid`.",
            text: "Scalar (extensive), in energy units: what a pair style has tallied, 0 for granular styles as in LAMMPS. The group \
                   decides nothing.",
            example: "compute bonds all pair peri/pmb",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The name of a pair style, which must be declared before.
    #[word(name = "pstyle", what = "the name of a pair style")]
    style: Word,
    /// A sub-style occurs once in a `hybrid`, so that its number can only be 1.
    #[word(name = "1")]
    number: Option<At<Number>>,
    part: Option<Energy>,
}

/// The number of a sub-style.
struct Number(i64);

impl Value for Number {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer("the number of the sub-style").map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.text.starts_with(|c: char| c.is_ascii_digit())
    }
}

/// Which part of the energy.
#[derive(PartialEq, Words)]
#[word(what = "part of the energy")]
enum Energy {
    /// All of it.
    Epair,
    /// All of it, as no style of perigrain has charges.
    Evdwl,
    /// 0, as no style of perigrain has charges.
    Ecoul,
}

impl ComputeStyle for PairEnergy {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { style: word, number, part } = read(args, cx)?;
        let known = cx.names.pair_styles();
        if !known.contains(&word.text.as_str()) {
            let text = format!("`{}` is no pair style of this scene", word.text);
            let d = Diagnostic::error(Code::UNKNOWN_STYLE, word.span, text);
            return Err(match nearest(&word.text, known.iter().copied()) {
                Some(n) => d.help(format!("did you mean `{n}`?")),
                None if known.is_empty() => d.help("put `pair_style` before this line"),
                None => d.help(format!("in use: {}", known.join(", "))),
            }
            .into());
        }
        if let Some(At { span, .. }) = number.filter(|n| n.value.0 != 1) {
            let text = format!("`{}` is there once: its number is 1", word.text);
            return fail(Code::BAD_VALUE, span, text);
        }
        let coulomb = part == Some(Energy::Ecoul);
        Ok(Box::new(Declared { id: cx.id.to_string(), style: Key::new(&word.text), coulomb }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    style: Key<f64>,
    coulomb: bool,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        cx.request_energy(when);
        let me = self.clone();
        Ok(fill(&self.id, &Wanted { slot, stage, when }, TALLY, move |w, t, out| {
            let tally = &w.tally;
            if tally.step.is_some_and(|s| s != t.step) {
                let text = format!("the energy is not known at step {}", t.step);
                return fail(Code::WRONG_ORDER, None, text);
            }
            let all = ["hybrid", "hybrid/overlay"].contains(&me.style.text());
            let energy = if all { tally.pair } else { tally.styles.get(me.style).copied().unwrap_or(0.0) };
            out.scalar = if me.coulomb { 0.0 } else { energy };
            Ok(())
        }))
    }

    fn tallied(&self) -> bool {
        true
    }
}
