//! fix halt: ends a run when a condition is met.

use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::comm::broadcast;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::shortest;
use perigrain_lang::{Args, Param, RefKind, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
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
            syntax: "fix ID group halt N attribute operator value [error hard|soft|continue] [message yes|no] [path name] [universe yes|no]",
            summary: "Ends the run when a quantity passes a value; looked at every N steps.",
            text: "Attributes: `v_name` of an equal-style variable, `tlimit` (seconds since the steps of this run began), \
                   `diskfree` (free megabytes where `path` lies, by default in the working folder), `bondmax` (longest bond \
                   of a bond_style, 0 where there is none). Operators: `< <= > >= == !=` and `|^` (exactly one of the two is \
                   0). `error soft` (default, as in LAMMPS 22Jul2025): the run ends, later `run` lines are passed over and \
                   all other lines work; `continue`: later runs run too; `hard`: the deck ends with an error. `message no` \
                   keeps quiet about it. The step at which the run ends gets no extra thermo row. The group means nothing.",
            example: "fix enough all halt 1 v_speed > 1000.0 error continue",
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

/// Compares `left` and `right`.
type Compare = fn(f64, f64) -> bool;

/// The operators and their comparisons.
const OPERATORS: [(&str, Compare); 7] = [
    ("<", |a, b| a < b),
    ("<=", |a, b| a <= b),
    (">", |a, b| a > b),
    (">=", |a, b| a >= b),
    ("==", |a, b| a == b),
    ("!=", |a, b| a != b),
    ("|^", |a, b| (a == 0.0) != (b == 0.0)),
];

impl FixStyle for HaltFix {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let every = args.integer_from(1, "the number of steps N")?;
        let word = args.expect("the quantity to check")?;
        let mut attribute = match (word.text.as_str(), ValueRef::parse(&word.text, word.span)?) {
            ("bondmax", _) => Attribute::Bonds,
            ("tlimit", _) => Attribute::Seconds,
            ("diskfree", _) => Attribute::Disk(PathBuf::from(".")),
            (_, Some(r)) if r.kind == RefKind::Variable => {
                cx.value(&r, false)?;
                Attribute::Variable(r)
            }
            _ => return Err(args.unknown(word, &["bondmax", "tlimit", "diskfree", "v_name"])),
        };
        let operator = args.choice("comparison", &["<", "<=", ">", ">=", "==", "!=", "|^"])?;
        let compare = OPERATORS.iter().find(|(name, _)| *name == operator).map_or(OPERATORS[0].1, |o| o.1);
        let value = args.number("the value to compare with")?;
        let (mut how, mut message, mut path_span) = ("soft", true, None);
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "error" => how = args.choice("value of error", &["hard", "soft", "continue"])?,
                "message" => message = args.flag("message")?,
                // One process is the whole universe.
                "universe" => drop(args.flag("universe")?),
                "path" => {
                    let name = args.expect("the path to check")?;
                    path_span = Some(name.span);
                    if let Attribute::Disk(path) = &mut attribute {
                        *path = PathBuf::from(&name.text);
                    }
                }
                _ => return Err(args.unknown(word, &["error", "message", "path", "universe"])),
            }
        }
        if let (Attribute::Disk(path), false) = (&attribute, cx.checking) {
            free_megabytes(path).map_err(|e| e.at(path_span.unwrap_or(cx.span)))?;
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), every, attribute, compare, value, how, message }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    every: i64,
    attribute: Attribute,
    compare: Compare,
    value: f64,
    how: &'static str,
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
            if !(me.compare)(value, me.value) {
                return Ok(());
            }
            let shown = shortest(value);
            let text =
                format!("Fix halt condition for fix-id {} met on step {} with value {shown}", me.id, t.step);
            if me.how == "hard" {
                return Err(Diagnostic::error(Code::HALTED, None, text).into());
            }
            w.clock.halt = if me.how == "soft" { Halt::All } else { Halt::Run };
            if me.message { log.line(&text) } else { Ok(()) }
        });
        Ok(vec![op.when(when).boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, ..Facts::default() }
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
