//! Coefficients of pair and bond styles that follow a variable.

use super::variable;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::words::{Grammar, Kind, Part, Value};
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{MEMO, SLOTS};
use perigrain_world::{Key, Numbers, World};

/// `pair STYLE PARAMETER I J v_name` or `bond STYLE PARAMETER I v_name`.
#[derive(Clone)]
pub struct Follows {
    coefficients: Vec<Coefficient>,
    variable: ValueRef,
    style: Word,
}

/// `STYLE PARAMETER I J v_name`.
pub struct OfPairs(pub Follows);

/// `STYLE PARAMETER I v_name`.
pub struct OfBonds(pub Follows);

/// The variable that is followed.
pub const VARIABLE: Part = Part::bare("v_name", Kind::Reference);

impl Value for OfPairs {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::bare("STYLE", Kind::Text),
            Part::bare("COEFFICIENT", Kind::Text),
            Part::bare("I", Kind::Types),
            Part::bare("J", Kind::Types),
            VARIABLE,
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        read(false, args, cx).map(Self)
    }
}

impl Value for OfBonds {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::bare("STYLE", Kind::Text),
            Part::bare("COEFFICIENT", Kind::Text),
            Part::bare("I", Kind::Types),
            VARIABLE,
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        read(true, args, cx).map(Self)
    }
}

fn read(bond: bool, args: &mut Args, cx: &BuildCx) -> Result<Follows> {
    let what = if bond { "bond" } else { "pair" };
    let style = args.expect(&format!("a {what} style"))?;
    let Some(known) = cx.names.coefficients(bond, &style.text) else {
        let text = format!("`{}` is no {what} style in force", style.text);
        let d = Diagnostic::error(Code::UNKNOWN_STYLE, style.span, text);
        return Err(d.help(format!("put its {what}_style line before this one")).into());
    };
    if known.is_empty() {
        let text = format!("{what} style {} has no coefficient that fix adapt could change", style.text);
        let d = Diagnostic::error(Code::NOT_SUPPORTED, style.span, text);
        return Err(d
            .help("peri/pmb, other peri styles, soft, bpm/spring and bond style harmonic have some")
            .into());
    }
    let name = args.expect("a coefficient")?;
    if !known.contains(&name.text.as_str()) {
        let text = format!("{what} style {} has no coefficient `{}` to change", style.text, name.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, name.span, text);
        return Err(d.help(format!("it has {}", known.join(", "))).into());
    }
    let span = args.here();
    let types = if bond { cx.world.bonds.types } else { cx.world.types };
    let first = args.type_range(types)?;
    let second = if bond { first } else { args.type_range(types)? };
    let all = (first.0..=first.1).flat_map(|i| (second.0.max(i)..=second.1).map(move |j| (i, j)));
    let own = all.filter(|(i, j)| !bond || i == j);
    let coefficients: Vec<Coefficient> = own
        .map(|types| Coefficient { bond, style: style.text.clone(), name: name.text.clone(), types })
        .collect();
    if coefficients.is_empty() {
        let d = Diagnostic::error(Code::BAD_VALUE, span, "these types name no pair i ≤ j");
        return Err(d.help("write the smaller type first").into());
    }
    Ok(Follows { coefficients, variable: variable(args, false, cx)?, style: style.clone() })
}

impl Follows {
    /// The op that sets the coefficients to their current values.
    pub fn op(
        &self,
        id: &str,
        when: &When,
        scale: bool,
        reset: bool,
        cx: &mut dyn SealCx,
    ) -> Result<Box<dyn Op>> {
        let value = cx.value(&self.variable, Stage::PreForce, when)?;
        let mut before = vec![];
        for of in &self.coefficients {
            let Some(declared) = cx.coefficient(of) else {
                let ((i, j), what) = (of.types, if of.bond { "bond" } else { "pair" });
                let text = format!("{what} style {} has no coefficients for types {i} {j}", of.style);
                return fail(Code::INCOMPLETE, self.style.span, text);
            };
            before.push(Before::of(cx.world(), id, of, declared));
        }
        Ok(Box::new(Change {
            name: format!("fix {id} adapt"),
            follows: self.clone(),
            when: when.clone(),
            value,
            scale,
            reset,
            before,
        }))
    }
}

/// Sets the coefficients to their current values, and restores the original ones at the end.
struct Change {
    name: String,
    follows: Follows,
    when: When,
    value: Reading,
    scale: bool,
    reset: bool,
    before: Vec<Before>,
}

/// A coefficient before the run.
struct Before {
    value: f64,
    /// Whether a fix had set it.
    adapted: bool,
    /// Keys of its current value and of this saved one.
    keys: [Numbers; 2],
}

impl Before {
    /// The saved value of a run that a restart file interrupted, or the current one.
    fn of(w: &World, id: &str, of: &Coefficient, declared: f64) -> Self {
        let keys @ [key, kept] = [of.key(), Key::new(&format!("adapt/{id}/{}", of.key()))];
        match (w.memo.get(kept).map(Vec::as_slice), w.adapted(key)) {
            (Some(&[value, adapted]), _) => Before { value, adapted: adapted != 0.0, keys },
            (_, now) => Before { value: now.unwrap_or(declared), adapted: now.is_some(), keys },
        }
    }
}

impl Op for Change {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            ..About::new(&self.name, Stage::PreForce, Needs::new().read(SLOTS).keep(MEMO))
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged {
            return Ok(());
        }
        let value = self.value.get(w);
        for (of, before) in self.follows.coefficients.iter().zip(&self.before) {
            let new = if self.scale { before.value * value } else { value };
            // Each style checks its own limits; these values are invalid for every coefficient.
            if !new.is_finite() || (new < 0.0 && !of.bond) {
                let (text, variable) = (format!("{new} at step {}", t.step), &self.follows.variable);
                let text = format!("`{variable}` makes `{}` of {} {text}", of.name, of.style);
                return fail(Code::BAD_VALUE, variable.span, text);
            }
            let [key, kept] = before.keys;
            w.memo.insert(kept, vec![before.value, f64::from(u8::from(before.adapted))]);
            w.adapt(key, Some(new));
        }
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        for before in &self.before {
            w.memo.remove(before.keys[1]);
        }
        if !self.reset {
            return Ok(());
        }
        for before in &self.before {
            w.adapt(before.keys[0], before.adapted.then_some(before.value));
        }
        w.touch();
        Ok(())
    }
}
