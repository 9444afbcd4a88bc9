//! fix halt: ends a run when a condition is met.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::comm::broadcast;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::shortest;
use perigrain_lang::{Args, Param, RefKind, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Alternative, At, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Style};
use perigrain_world::field::{CLOCK, SLOTS};
use perigrain_world::{Halt, World};
use std::path::{Path, PathBuf};

/// The style.
pub struct HaltFix;

impl Style for HaltFix {
    fn name(&self) -> &'static str {
        "halt"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Ends the run when a quantity passes a value; looked at every N steps.",
            text: "The step at which the run ends gets no extra thermo row. The group means nothing.",
            example: "fix enough all halt 1 v_speed > 1000.0 error continue",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Looks at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// What is compared: one of these words, or `v_name` of an equal-style variable.
    attribute: Attribute,
    operator: Operator,
    /// The value to compare with.
    value: f64,
    #[word(keyword, default = How::Soft)]
    error: How,
    /// Whether a line says that the run has ended.
    #[word(keyword, what = "message", default = true)]
    message: bool,
    /// The path to check, for `diskfree`; without it the working folder.
    #[word(keyword, name = "name")]
    path: Option<At<PathBuf>>,
    /// One process is the whole universe: without effect.
    #[word(keyword = "universe", what = "universe")]
    _universe: bool,
}

/// What happens to the deck.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "value of error")]
enum How {
    /// The deck ends with an error.
    Hard,
    /// The run ends, later `run` lines are passed over and all other lines work (as in LAMMPS 22Jul2025).
    Soft,
    /// The run ends, and later runs run.
    Continue,
}

/// How values are compared.
#[derive(Clone, Copy, Words)]
#[word(what = "comparison")]
enum Operator {
    #[word("<")]
    Below,
    #[word("<=")]
    AtMost,
    #[word(">")]
    Above,
    #[word(">=")]
    AtLeast,
    #[word("==")]
    Equal,
    #[word("!=")]
    Other,
    /// Exactly one of the two is 0.
    #[word("|^")]
    OneOf,
}

impl Operator {
    fn holds(self, a: f64, b: f64) -> bool {
        match self {
            Self::Below => a < b,
            Self::AtMost => a <= b,
            Self::Above => a > b,
            Self::AtLeast => a >= b,
            Self::Equal => a == b,
            Self::Other => a != b,
            Self::OneOf => (a == 0.0) != (b == 0.0),
        }
    }
}

/// The quantity compared.
#[derive(Clone)]
enum Attribute {
    Bonds,
    Seconds,
    Disk(PathBuf),
    Variable(ValueRef),
}

const fn named(word: &'static str, about: &'static str) -> Alternative {
    Alternative { word, about, parts: &[] }
}

impl Value for Attribute {
    const KIND: Kind = Kind::Or(
        &Kind::Choice(&[
            named("bondmax", "The longest bond of a bond_style, 0 where there is none."),
            named("tlimit", "Seconds since the steps of this run began."),
            named("diskfree", "Free megabytes where `path` lies."),
        ]),
        &Kind::Reference,
    );
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the quantity to check")?;
        Ok(match (word.text.as_str(), ValueRef::parse(&word.text, word.span)?) {
            ("bondmax", _) => Self::Bonds,
            ("tlimit", _) => Self::Seconds,
            ("diskfree", _) => Self::Disk(PathBuf::from(".")),
            (_, Some(r)) if r.kind == RefKind::Variable => {
                cx.value(&r, false)?;
                Self::Variable(r)
            }
            _ => return Err(args.unknown(word, &["bondmax", "tlimit", "diskfree", "v_name"])),
        })
    }
}

impl FixStyle for HaltFix {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, mut attribute, operator, value, error, message, path, .. } = read(args, cx)?;
        if let Attribute::Disk(own) = &mut attribute {
            let span = path.as_ref().map_or(cx.span, |path| path.span);
            path.into_iter().for_each(|path| *own = path.value);
            if !cx.checking {
                free_megabytes(own).map_err(|e| e.at(span))?;
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), every, attribute, operator, value, error, message }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    every: i64,
    attribute: Attribute,
    operator: Operator,
    value: f64,
    error: How,
    message: bool,
}

impl Declared {
    /// The current value of the attribute.
    fn present_value(&self, w: &World, reading: Option<Reading>) -> Result<f64> {
        match &self.attribute {
            // Without a bond_style there are no bonds.
            Attribute::Bonds => Ok(0.0),
            Attribute::Seconds => {
                Ok(broadcast::number(|| w.clock.began.map_or(0.0, |b| b.elapsed().as_secs_f64())))
            }
            Attribute::Disk(path) => free_megabytes(path),
            Attribute::Variable(_) => Ok(reading.map_or(0.0, |r| r.get(w))),
        }
    }
}

/// Free space of the file system that contains a path.
fn free_megabytes(path: &Path) -> Result<f64> {
    perigrain_base::gate::pass(path).map_err(|e| {
        let text = format!("the free space at `{}` cannot be read: {e}", path.display());
        Diagnostic::error(perigrain_base::gate::code(&e), None::<Span>, text)
    })?;
    // Uses `df`, because the standard library has no function for this.
    let text = broadcast::text(|| {
        let output = std::process::Command::new("df").arg("-Pk").arg("--").arg(path).output();
        output.ok().filter(|o| o.status.success()).map(|o| String::from_utf8_lossy(&o.stdout).into_owned())
    });
    let free = text.and_then(|t| t.lines().nth(1)?.split_whitespace().nth(3)?.parse::<f64>().ok());
    free.map(|kilobytes| kilobytes / 1024.0).ok_or_else(|| {
        let text = format!("the free space at `{}` cannot be found", path.display());
        Diagnostic::error(Code::NO_FILE, None::<Span>, text).into()
    })
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every);
        let reading = match &self.attribute {
            Attribute::Variable(r) => Some(cx.param(&Param::Ref(r.clone()), Stage::EndOfStep, &when)?),
            _ => None,
        };
        let (me, log, access) = (self.clone(), cx.log(), Needs::new().read(SLOTS).write(CLOCK));
        let op = StepOp::new(format!("fix {} halt", self.id), Stage::EndOfStep, access, move |w, t| {
            let value = me.present_value(w, reading)?;
            if !me.operator.holds(value, me.value) {
                return Ok(());
            }
            let shown = shortest(value);
            let text =
                format!("Fix halt condition for fix-id {} met on step {} with value {shown}", me.id, t.step);
            if me.error == How::Hard {
                return Err(Diagnostic::error(Code::HALTED, None, text).into());
            }
            w.clock.halt = if me.error == How::Soft { Halt::All } else { Halt::Run };
            if me.message { log.line(&text) } else { Ok(()) }
        });
        Ok(vec![op.when(when).boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Acts, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn a_run_ends_at_its_condition() {
        for (words, ends) in [
            ("1 v_e > 6", Halt::All),
            ("1 v_e >= 7 error continue", Halt::Run),
            ("1 v_e < 7", Halt::No),
            ("1 v_e |^ 0", Halt::All),
            ("1 v_e |^ 1", Halt::No),
            ("1 v_e != 7", Halt::No),
            ("1 bondmax > 0", Halt::No),
            ("1 diskfree > 0", Halt::All),
        ] {
            let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
            b.equal.insert("e".into(), 7.0);
            let fix = b.fix(&HaltFix, words).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            b.stage(&mut ops, Stage::EndOfStep).unwrap();
            assert_eq!(b.world.clock.halt, ends, "{words}");
        }
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.equal.insert("e".into(), 7.5);
        let fix = b.fix(&HaltFix, "1 v_e == 7.5 error hard").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        let e = b.stage(&mut ops, Stage::EndOfStep).unwrap_err();
        assert_eq!(e.to_string(), "Fix halt condition for fix-id f met on step 0 with value 7.5");
        for words in
            ["0 v_e > 1", "1 v_no > 1", "1 c_e > 1", "1 v_e => 1", "1 v_e > x", "1 v_e > 1 error weak"]
        {
            assert!(b.fix(&HaltFix, words).is_err(), "{words}");
        }
    }
}
