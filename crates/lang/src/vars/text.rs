//! A variable's value: as text in a line, as a value in a formula.

use super::python::Given;
use super::{Data, Kind, Variable, Vars};
use crate::expr::{Trail, Yields, element};
use crate::number::{self, printf, value_text};
use crate::reference::{RefKind, ValueRef};
use crate::value::{Env, Value};
use perigrain_base::comm::broadcast;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};

/// A variable's value as text.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    /// The text.
    pub text: String,
    /// Where the variable was defined.
    pub origin: Option<Span>,
    /// There is no value yet (`check` mode).
    pub unknown: bool,
}

impl Vars {
    /// The value that replaces `$name`. `longer` is what follows a `$` without braces.
    pub(crate) fn text(&self, name: &str, longer: &str, span: Span, env: &mut dyn Env) -> Result<Text> {
        self.text_below(name, longer, span, env, &mut Trail::default())
    }

    pub(super) fn text_below(
        &self,
        name: &str,
        longer: &str,
        span: Span,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Text> {
        let Some(variable) = self.find(name) else {
            let mut d = self.unknown(name, span);
            let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let full = &longer[..longer.find(|c| !word(c)).unwrap_or(longer.len())];
            if self.table.contains_key(full) {
                d.help = vec![format!("names of more than one letter need braces: ${{{full}}}")];
            }
            return Err(d.into());
        };
        let text = match variable.unknown {
            true => None,
            false => self.text_of(name, variable, span, env, trail)?,
        };
        let origin = variable.span;
        Ok(Text { unknown: text.is_none(), text: text.unwrap_or_default(), origin })
    }

    /// The text, `None` if it is unknown.
    fn text_of(
        &self,
        name: &str,
        variable: &Variable,
        span: Span,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Option<String>> {
        let below =
            |name: &str| ValueRef { kind: RefKind::Variable, name: name.to_owned(), index: vec![], span };
        Ok(match &variable.data {
            Data::List { values, at } => values.get(*at).cloned(),
            Data::Range { now, width, .. } => Some(format!("{now:0width$}")),
            Data::Text(t) => Some(t.clone()),
            Data::Getenv(key) => {
                let own = self.environment.get(key).cloned();
                let system = || broadcast::text(|| std::env::var(key).ok());
                Some(own.or_else(system).unwrap_or_default())
            }
            Data::Lines(l) => Some(l.current().to_owned()),
            Data::Number(v) => Some(value_text(env.control(name).unwrap_or(*v))),
            Data::Formula(e) if variable.kind == Kind::Equal => {
                let own = below(name);
                trail.inside(&own, Yields::Any, |trail| e.scalar(self, env, trail))?.map(value_text)
            }
            Data::Formula(_) if variable.kind == Kind::Vector => {
                match self.reference(&below(name), env, trail)? {
                    Value::Vector(list) => {
                        let list: Vec<String> = list.into_iter().map(value_text).collect();
                        Some(format!("[{}]", list.join(",")))
                    }
                    _ => None,
                }
            }
            Data::Python(function) => {
                let run = |trail: &mut Trail| self.called(function, Some(name), span, env, trail);
                trail.inside(&below(name), Yields::Any, run)?.map(Given::text)
            }
            Data::Format { name: of, format } => {
                let own = below(name);
                let value =
                    trail.inside(&own, Yields::Any, |trail| self.reference(&below(of), env, trail))?;
                match value {
                    Value::Number(v) => {
                        Some(printf(format, v + 0.0).or_else(|e| fail(Code::SYNTAX, span, e))?)
                    }
                    _ => None,
                }
            }
            Data::Formula(_) if variable.kind == Kind::Bond => {
                let message = format!("variable `{name}` has one value per bond and cannot become text");
                return fail(Code::WRONG_KIND, span, message);
            }
            Data::Formula(_) | Data::Atoms(_) => {
                let message = format!("variable `{name}` has one value per particle and cannot become text");
                return fail(Code::WRONG_KIND, span, message);
            }
        })
    }

    /// What a variable was defined as, for a list of variables.
    pub fn definition(&self, name: &str) -> Option<String> {
        Some(match &self.find(name)?.data {
            Data::List { values, .. } => values.join(" "),
            Data::Range { now, last, .. } => format!("{now} … {last}"),
            Data::Text(t) | Data::Getenv(t) => t.clone(),
            Data::Python(function) => {
                self.inputs(name).fold(function.clone(), |text, input| text + " v_" + input)
            }
            Data::Lines(l) => format!("{} (now {})", l.path(), l.current()),
            Data::Atoms(a) => a.path().to_owned(),
            Data::Format { name, format } => format!("{name} {format}"),
            Data::Formula(e) => e.text().to_owned(),
            Data::Number(v) => value_text(*v),
        })
    }

    /// The value of a variable in formulas.
    pub fn value(&self, name: &str, span: Span, env: &mut dyn Env) -> Result<Value> {
        let r = ValueRef { kind: RefKind::Variable, name: name.to_owned(), index: vec![], span };
        self.reference(&r, env, &mut Trail::default())
    }

    /// The value of `v_name` or `v_name[i]` in a formula.
    pub(crate) fn reference(&self, r: &ValueRef, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        let Some(variable) = self.find(&r.name) else {
            return Err(self.unknown(&r.name, r.span).into());
        };
        if variable.unknown {
            return Ok(Value::Unknown);
        }
        match &variable.data {
            Data::Formula(e) if variable.kind == Kind::Equal && r.index.is_empty() => {
                let v = trail.inside(r, Yields::Any, |trail| e.scalar(self, env, trail))?;
                Ok(v.map_or(Value::Unknown, Value::Number))
            }
            Data::Formula(e) if variable.kind == Kind::Vector => {
                let v = trail.inside(r, Yields::Vector, |trail| e.vector(self, env, trail))?;
                picked_element(v, r)
            }
            Data::Formula(e) if variable.kind == Kind::Atom => {
                let all = match trail.inside(r, Yields::Particles, |trail| e.run(self, env, trail))? {
                    Value::Number(_) if !env.sees_particles() => Value::Unknown,
                    Value::Number(v) => Value::Atom(vec![v; env.natoms()]),
                    other => other,
                };
                picked_particle(all, r, env)
            }
            Data::Formula(e) if variable.kind == Kind::Bond => self.bond_value(e, r, env, trail),
            Data::Python(function) if r.index.is_empty() => {
                let run = |trail: &mut Trail| self.called(function, Some(&r.name), r.span, env, trail);
                match trail.inside(r, Yields::Any, run)? {
                    None => Ok(Value::Unknown),
                    Some(Given::Whole(k)) => Ok(Value::Number(k as f64)),
                    Some(Given::Real(a)) => Ok(Value::Number(a)),
                    Some(other) => no_text(&r.name, &other.text(), r.span),
                }
            }
            Data::Atoms(file) => picked_particle(file.values(r.span, env)?, r, env),
            Data::Number(v) if r.index.is_empty() => Ok(Value::Number(env.control(&r.name).unwrap_or(*v))),
            _ if !r.index.is_empty() => {
                let style = variable.kind.name();
                let message = format!("`{}` is of style {style} and has no elements", r.name);
                fail(Code::WRONG_KIND, r.span, message)
            }
            _ => self.number_in_text(r, env, trail),
        }
    }

    /// The number that a text-style variable holds.
    fn number_in_text(&self, r: &ValueRef, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        let text = self.text_below(&r.name, "", r.span, env, trail)?;
        if text.unknown {
            return Ok(Value::Unknown);
        }
        number::parse(text.text.trim()).map(Value::Number).ok_or_else(|| {
            let message = format!("variable `{}` holds `{}`, which is no number", r.name, text.text);
            let d = Diagnostic::error(Code::WRONG_KIND, r.span, message);
            match text.origin {
                Some(o) => d.label(o, "defined here").into(),
                None => d.into(),
            }
        })
    }
}

impl Trail {
    /// Evaluates a variable's formula below this trail.
    pub(super) fn inside<T>(
        &mut self,
        r: &ValueRef,
        yields: Yields,
        run: impl FnOnce(&mut Trail) -> Result<T>,
    ) -> Result<T> {
        self.enter(&r.name, r.span)?;
        let outer = std::mem::replace(&mut self.yields, yields);
        let v = run(self).map_err(|d| used(d, &r.name, r.span))?;
        self.yields = outer;
        self.leave();
        Ok(v)
    }
}

/// The number that a function gave as a text.
fn no_text(name: &str, text: &str, span: Span) -> Result<Value> {
    match number::parse(text.trim()) {
        Some(a) => Ok(Value::Number(a)),
        None => fail(Code::WRONG_KIND, span, format!("variable `{name}` is `{text}`, which is no number")),
    }
}

/// The element of a vector, if there is an index.
fn picked_element(all: Value, r: &ValueRef) -> Result<Value> {
    let Value::Vector(list) = &all else { return Ok(all) };
    match r.index[..] {
        [] => Ok(all),
        [k] => match list.get(k - 1) {
            Some(v) => Ok(Value::Number(*v)),
            None => {
                let n = list.len();
                fail(Code::BAD_VALUE, r.span, format!("variable `{}` has elements 1 to {n}", r.name))
            }
        },
        _ => fail(Code::WRONG_KIND, r.span, "a vector-style variable has one index"),
    }
}

/// One particle's element of a variable with values per particle, if there is an index.
fn picked_particle(all: Value, r: &ValueRef, env: &mut dyn Env) -> Result<Value> {
    let [tag] = r.index[..] else {
        if r.index.is_empty() || all == Value::Unknown {
            return Ok(all);
        }
        return fail(Code::WRONG_KIND, r.span, "a variable with one value per particle has one index");
    };
    if all == Value::Unknown {
        return Ok(all);
    }
    let Some(ids) = env.column("id") else {
        return fail(Code::WRONG_KIND, r.span, "the particles have no numbers");
    };
    let found = ids?.iter().position(|id| *id == tag as f64);
    Ok(Value::Number(found.map_or(0.0, |k| element(&all, k))))
}

/// How many of the variables on the way to a failure are shown.
const SHOWN: usize = 4;

/// Marks a failure inside a variable's formula with the place that used the variable: the innermost and the outermost.
fn used(d: Diagnostics, name: &str, span: Span) -> Diagnostics {
    let mark = |d: Diagnostic| {
        let mut d = d.at(span);
        if d.span == Some(span) {
            return d;
        }
        if d.labels.iter().filter(|l| l.text.ends_with(EVALUATED)).count() >= SHOWN {
            d.labels.pop();
        }
        d.label(span, format!("while `{name}` {EVALUATED}"))
    };
    Diagnostics(d.0.into_iter().map(mark).collect())
}

const EVALUATED: &str = "was evaluated here";
