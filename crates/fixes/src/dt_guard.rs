//! fix dt/guard: when the energy balance fails, the run returns to the last good state and continues with
//! shorter steps.

use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Op, Rule};
use perigrain_styles::ledger;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{GroupId, World};

/// The style.
pub struct DtGuard;

impl Style for DtGuard {
    fn name(&self) -> &'static str {
        "dt/guard"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes back blocks of steps in which energy was made, and continues in shorter steps.",
            text: "Every step at which a fix or output acts ends a block, too. At its end, before anything is put out, \
                   the residual of compute energy/ledger is compared with that at the block's beginning: if it has \
                   changed by more than the tolerance allows, or particles are lost or have no finite place, the scene \
                   is put back as it was at the beginning, the step is multiplied by the factor of `shrink`, and the \
                   log says so in one line.\n\n\
                   Contacts with granular walls count like those between particles, but what they hold is no part of \
                   the energy that is held: it counts as what goes in and out. What is put out belongs to good blocks \
                   only. A run makes its number of steps, so that it covers less time when steps became shorter (`fix \
                   halt` with the variable `time` ends at a time).\n\n\
                   The tolerance must leave room for the errors of dashpots, friction and breaking bonds, which are of \
                   first order in the step: some per cent. A block costs a copy of the scene.",
            example: "fix g all dt/guard 20 0.05 shrink 0.5 recover 10",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of steps in a block [steps].
    #[word(name = "N", from = 1)]
    every: i64,
    /// The part of the energy that may be off: of the energy held at the block's beginning plus what went in and out since.
    #[word(positive)]
    tolerance: f64,
    /// What steps are multiplied with after a bad block, below 1.
    #[word(keyword, name = "F", what = "what steps are multiplied with", positive, shown = "0.5")]
    shrink: Option<At<f64>>,
    /// The shortest step [time]: below it the run ends with an error.
    #[word(keyword, name = "T", positive, shown = "1e-6 of the first step")]
    min: Option<f64>,
    /// The number of good blocks in a row after which the step becomes longer by 1/F, up to the longest that the deck has set;
    /// never without it.
    #[word(keyword, name = "K", what = "the number of good blocks", from = 1)]
    recover: Option<i64>,
}

impl FixStyle for DtGuard {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "fix dt/guard must use the group `all`");
        }
        let Line { every, tolerance, shrink, min, recover } = read(args, cx)?;
        let shrink = match shrink {
            Some(At { value, span, .. }) if value >= 1.0 => {
                let text = format!("shrink makes steps shorter: {value} is not below 1");
                return fail(Code::BAD_VALUE, span, text);
            }
            other => other.map_or(0.5, |by| by.value),
        };
        let shortest = min.unwrap_or(1e-6 * cx.world.clock.dt);
        let rule = Rule { every, tolerance, shrink, shortest, recover: recover.unwrap_or(0) };
        Ok(Box::new(Declared { rule }))
    }
}

#[derive(Clone)]
struct Declared {
    rule: Rule,
}

impl Fix for Declared {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        // The step loop does the work: only it can restore an earlier state.
        Ok(vec![])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        ledger::open(w)
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            needs_whole_steps: Some("its ledger counts the work of whole steps"),
            guard: Some(self.rule),
            ..Facts::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn words() {
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        let fix = b.fix(&DtGuard, "20 0.1 shrink 0.25 min 1e-9 recover 7").unwrap();
        let rule = fix.facts(&b.world).guard.unwrap();
        assert_eq!(rule, Rule { every: 20, tolerance: 0.1, shrink: 0.25, shortest: 1e-9, recover: 7 });
        for words in ["", "20", "0 0.1", "20 0", "20 0.1 shrink 1", "20 0.1 min 0", "20 0.1 grow 3"] {
            assert!(b.fix(&DtGuard, words).is_err(), "{words}");
        }
    }
}
