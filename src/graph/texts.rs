//! Texts with values in them, and steps that a variable names, for styles that write during a run.

use super::keywords::{self, Sources};
use super::seal::Sealer;
use super::step_env::RunEnv;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Clock, Dep, Env, Expr, RefKind, Value, ValueRef, Vars, Word, substitute};
use perigrain_plan::{Stage, When};
use perigrain_styles::{PlaceTest, SealCx, Text};
use perigrain_world::{SlotId, World};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Plans the values that a text names and returns what puts them in.
///
/// # Errors
/// Formulas that cannot be read, and what they name that is not there.
pub fn text(
    s: &mut Sealer,
    vars: Arc<Vars>,
    text: &str,
    span: Span,
    stage: Stage,
    when: &When,
) -> Result<Text> {
    let needed = depends(text, span, &vars)?;
    let from = sources(s, needed, span, stage, when)?;
    let (text, declared) = (text.to_string(), s.declared());
    Ok(Box::new(move |w| {
        let mut env = RunEnv::new(w, &declared, &from);
        substitute(&text, span, &vars, &mut env)
    }))
}

/// Where the values that formulas need are found, planned.
pub(super) fn sources(
    s: &mut Sealer,
    needed: Vec<Dep>,
    span: Span,
    stage: Stage,
    when: &When,
) -> Result<BTreeMap<String, SlotId>> {
    let mut from = BTreeMap::new();
    for dep in needed {
        let (name, slot): (String, SlotId) = match dep {
            Dep::Keyword(k) => match s.keyword(&k, span, stage, when)? {
                perigrain_styles::Reading::Scalar(slot) => (k, slot),
                _ => continue,
            },
            Dep::Ref(r) => (r.to_string(), s.source(&r, stage, when)?),
        };
        from.insert(name, slot);
    }
    Ok(from)
}

/// Plans the values that a variable needs and returns a function that evaluates it at a place, with internal-style variables set
/// to the coordinates.
///
/// # Errors
/// Unknown variables, and those to be set that are of another style.
pub fn test(
    s: &mut Sealer,
    vars: Arc<Vars>,
    r: &ValueRef,
    sets: &[Option<ValueRef>; 3],
    stage: Stage,
    when: &When,
) -> Result<PlaceTest> {
    let mut vars = Vars::clone(&vars);
    for variable in sets.iter().flatten() {
        if !vars.set_internal(&variable.name, 0.0) {
            let text = format!("variable `{}` must be of style internal", variable.name);
            return fail(Code::WRONG_KIND, variable.span, text);
        }
    }
    let from = sources(s, of_variable(&r.name, &vars), r.span, stage, when)?;
    let (r, sets, declared) = (r.clone(), sets.clone(), s.declared());
    Ok(Box::new(move |w, x| {
        for (variable, x) in sets.iter().zip(x).filter_map(|(v, x)| v.as_ref().map(|v| (v, x))) {
            vars.set_internal(&variable.name, x);
        }
        let mut env = RunEnv::new(w, &declared, &from);
        match vars.value(&r.name, r.span, &mut env)? {
            Value::Number(a) => Ok(a != 0.0),
            _ => fail(Code::WRONG_KIND, r.span, format!("`{r}` has no single number")),
        }
    }))
}

/// What the `$x`, `${name}` and `$(formula)` of a text need from outside.
fn depends(text: &str, span: Span, vars: &Vars) -> Result<Vec<Dep>> {
    let mut found = vec![];
    for (at, _) in text.match_indices('$') {
        let rest = &text[at + 1..];
        if let Some(name) = rest.strip_prefix('{').and_then(|r| r.split_once('}')).map(|(name, _)| name) {
            found.extend(of_variable(name, vars));
        } else if let Some(formula) = rest.strip_prefix('(').and_then(enclosed) {
            let formula = formula.rfind(':').map_or(formula, |k| &formula[..k]);
            found.extend(Expr::parse(formula, span)?.depends(vars));
        } else if let Some(c) = rest.chars().next() {
            found.extend(of_variable(&c.to_string(), vars));
        }
    }
    Ok(found)
}

pub(super) fn of_variable(name: &str, vars: &Vars) -> Vec<Dep> {
    let name = vars.formatted(name).unwrap_or(name);
    vars.depends(name)
}

/// The text up to the parenthesis that closes one already open.
fn enclosed(text: &str) -> Option<&str> {
    let mut depth = 0usize;
    for (k, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' if depth == 0 => return Some(&text[..k]),
            ')' => depth -= 1,
            _ => {}
        }
    }
    None
}

/// The steps of the coming run that a variable names one after another, each time from the one named before.
///
/// # Errors
/// A variable that needs more than the clock, and a step that is not later than the one before.
pub fn steps(w: &mut World, vars: &Vars, r: &ValueRef) -> Result<When> {
    if vars.kind(&r.name).is_none() {
        return fail(Code::UNKNOWN_NAME, r.span, format!("there is no variable `{}`", r.name));
    }
    let present = w.clock.clone();
    let found = walk(w, vars, r);
    w.clock = present;
    found
}

fn walk(w: &mut World, vars: &Vars, r: &ValueRef) -> Result<When> {
    // The values are those inside a run, where `ramp` moves.
    w.clock.running = true;
    let mut steps = vec![];
    while w.clock.step < w.clock.last {
        let next = match vars.value(&r.name, r.span, &mut ClockEnv(w))? {
            Value::Number(a) => a.ceil(),
            _ => return fail(Code::WRONG_KIND, r.span, format!("`{r}` has no number here")),
        };
        if next.is_nan() || next <= w.clock.step as f64 {
            let text = format!("`{r}` names step {next} at step {}: it must name a later one", w.clock.step);
            return Err(Diagnostic::error(Code::BAD_VALUE, r.span, text)
                .help("use stride(), logfreq(), stagger() or another formula that leads on")
                .into());
        }
        w.clock.step = if next < i64::MAX as f64 { next as i64 } else { i64::MAX };
        if w.clock.step <= w.clock.last {
            steps.push(w.clock.step);
        }
    }
    Ok(When::At(steps.into()))
}

/// The world, reduced to its clock.
struct ClockEnv<'a>(&'a World);

impl ClockEnv<'_> {
    fn no<T>(what: &str, span: Option<Span>) -> Result<T> {
        let text = format!("`{what}` is not known before the run; steps must follow from the step before");
        fail(Code::WRONG_KIND, span, text)
    }
}

impl Env for ClockEnv<'_> {
    fn keyword(&mut self, name: &str, span: Span, _: &Vars) -> Option<Result<Value>> {
        let (name, ..) = keywords::find(name)?;
        Some(match *name {
            "step" | "elapsed" | "elaplong" | "dt" | "time" => {
                Ok(Value::Number(keywords::value(name, self.0, &Sources::default())))
            }
            _ => Self::no(name, span.into()),
        })
    }
    fn reference(&mut self, r: &ValueRef, _: &Vars) -> Result<Value> {
        match r.kind {
            RefKind::Variable => Self::no("a variable", r.span.into()),
            _ => Self::no(&r.to_string(), r.span.into()),
        }
    }
    fn particle(&mut self, attribute: &str, _tag: usize, span: Span) -> Result<Value> {
        Self::no(attribute, span.into())
    }
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>> {
        Some(Self::no(attribute, None))
    }
    fn group_function(&mut self, name: &str, _args: &[Word], span: Span, _: &Vars) -> Result<Value> {
        Self::no(name, span.into())
    }
    fn clock(&self) -> Clock {
        let c = &self.0.clock;
        Clock { step: c.step, begin: c.start, end: c.stop, dt: c.dt, running: c.running }
    }
    fn natoms(&self) -> usize {
        self.0.n()
    }
}
