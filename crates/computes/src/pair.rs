//! compute pair: the energy of one pair style.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail, nearest};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
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
            syntax: "compute ID group pair pstyle [1] [epair|evdwl|ecoul]",
            summary: "Potential energy of one pair style, as a sub-style of `hybrid`.",
            text: "Scalar (extensive), in energy units: what the pair style `pstyle` has tallied, 0 for granular styles as in LAMMPS. \
                   The style must be declared before. `evdwl` is the same, `ecoul` 0: no style of perigrain has charges. \
                   The group decides nothing. A sub-style occurs once in a `hybrid`, so that its number can only be 1.",
            example: "compute bonds all pair peri/pmb",
        }
    }
}

impl ComputeStyle for PairEnergy {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let word = args.expect("the name of a pair style")?;
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
        if args.peek_text().starts_with(|c: char| c.is_ascii_digit()) {
            let span = args.here();
            if args.integer("the number of the sub-style")? != 1 {
                let text = format!("`{}` is there once: its number is 1", word.text);
                return fail(Code::BAD_VALUE, span, text);
            }
        }
        let mut coulomb = false;
        if !args.is_empty() {
            coulomb = args.choice("part of the energy", &["epair", "evdwl", "ecoul"])? == "ecoul";
        }
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
