//! fix controller: steers a variable so that a measured value reaches a setpoint (PID control).

use super::window::forget;
use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{CONTROLS, MEMO, SLOTS};
use perigrain_world::{Key, Numbers, World};

/// The style.
pub struct Controller;

impl Style for Controller {
    fn name(&self) -> &'static str {
        "controller"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Steers an internal-style variable so that a value comes to a wanted one.",
            text: "Every N steps, with the error e = value − setpoint and τ = N Δt, the variable c changes by −α (Kp τ \
                   e + Ki τ² Σe + Kd Δe): proportional, integral and derivative term. At the first update the \
                   difference is 0. Something must read the variable for it to have an effect: `fix indent`, `fix \
                   setforce`, a region … Vector of 3 (extensive): the latest changes by the three terms. The group \
                   means nothing.",
            example: "variable push internal 0.0\nvariable vnow equal vcm(plate,x)\n\
                      fix steer all controller 1 1.0e6 1.0 0.0 0.0 v_vnow 0.1 push",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps].
    #[word(name = "N", what = "the number of steps N", from = 1)]
    every: i64,
    /// The coupling alpha.
    alpha: f64,
    /// The gains of the three terms.
    #[word(name = "Kp Ki Kd", what = "the gain {}")]
    gains: [f64; 3],
    /// The value to be controlled: `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]` or `v_name`.
    #[word(with = measured, kind = Kind::Value)]
    value: ValueRef,
    /// The wanted value.
    setpoint: f64,
    /// The name of an internal-style variable, without `v_`; its value in the deck is the first.
    #[word(name = "name", with = control, kind = Kind::Variable)]
    control: ValueRef,
}

fn measured(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("the value to be controlled")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom) => {
            cx.value(&r, false)?;
            Ok(r)
        }
        _ => {
            let text = format!("`{}` is no value: c_ID, c_ID[k], f_ID, f_ID[k] or v_name", word.text);
            fail(Code::WRONG_KIND, word.span, text)
        }
    }
}

fn control(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("the name of an internal-style variable")?;
    let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    if !cx.shape(&r).is_some_and(|s| s.settable) {
        let text = format!("variable `{}` must be of style internal", word.text);
        let d = Diagnostic::error(Code::WRONG_KIND, word.span, text);
        return Err(d.help(format!("write `variable {} internal 0.0`", word.text)).into());
    }
    Ok(r)
}

impl FixStyle for Controller {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { every, alpha, gains, value, setpoint, control } = read(args, cx)?;
        super::compatible(&value, &cx.shape(&value).unwrap_or_default(), every, "N")?;
        Ok(Box::new(Declared { id: cx.id.to_string(), every, alpha, gains, value, setpoint, control }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    every: i64,
    alpha: f64,
    /// Gains of the proportional, integral and derivative terms.
    gains: [f64; 3],
    value: ValueRef,
    setpoint: f64,
    control: ValueRef,
}

impl Declared {
    fn key(&self) -> Numbers {
        Key::new(&format!("controller/{}", self.id))
    }
}

impl Fix for Declared {
    fn remove(&self, w: &mut World) {
        forget(w, self.key());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = When::Every(self.every);
        let value = cx.value(&self.value, Stage::EndOfStep, &when)?;
        let control = cx.value(&self.control, Stage::EndOfStep, &when)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let (fix, key, name) = (self.clone(), self.key(), Key::new(&self.control.name));
        let access = Needs::new().read(SLOTS).write(SLOTS | CONTROLS).keep(MEMO).only(&[key.text()]);
        let op = StepOp::new(format!("fix {} controller", self.id), Stage::EndOfStep, access, move |w, t| {
            let error = value.get(w) - fix.setpoint;
            let (sum, change) = match w.memo.get(key).map(Vec::as_slice) {
                Some([sum, last]) => (sum + error, error - last),
                _ => (error, 0.0),
            };
            w.memo.insert(key, vec![sum, error]);
            let tau = fix.every as f64 * t.dt;
            let [p, i, d] = fix.gains;
            let terms = [p * tau * error, i * tau * tau * sum, d * change].map(|term| -fix.alpha * term);
            let new = control.get(w) + terms[0] + terms[1] + terms[2];
            w.controls.insert(name, new);
            let out = w.slots.get_mut(slot);
            (out.step, out.vector) = (Some(t.step), terms.to_vec());
            Ok(())
        });
        Ok(vec![op.when(when).boxed()])
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let slot = w.slots.id(&format!("f_{}", self.id));
        w.slots.get_mut(slot).vector = vec![0.0; 3];
        Ok(())
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
    }
}
