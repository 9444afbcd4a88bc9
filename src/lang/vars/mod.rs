//! The variable table: definition, value as text, value in formulas, `next`.

mod define;

use super::args::blame;
use super::command::Word;
use super::expr::{Expr, Trail, element};
use super::number::{self, printf, value_text};
use super::reference::{RefKind, ValueRef};
use super::value::{Env, Value};
use crate::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use crate::math::rng::Marsaglia;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The style of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `index`: a list of texts.
    Index,
    /// `loop`: a run of whole numbers.
    Loop,
    /// `string`: one text.
    Text,
    /// `getenv`: an environment variable.
    Getenv,
    /// `format`: an equal-style variable in a C format.
    Format,
    /// `equal`: a formula that yields a number.
    Equal,
    /// `atom`: a formula that yields one number per particle.
    Atom,
}

impl Kind {
    /// The style as written in a deck.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Index => "index",
            Kind::Loop => "loop",
            Kind::Text => "string",
            Kind::Getenv => "getenv",
            Kind::Format => "format",
            Kind::Equal => "equal",
            Kind::Atom => "atom",
        }
    }
}

/// What a variable holds.
#[derive(Clone, Debug)]
enum Data {
    Index { values: Vec<String>, at: usize },
    Loop { now: i64, last: i64, width: usize },
    Text(String),
    Getenv(String),
    Format { name: String, format: String },
    Equal(Expr),
    Atom(Expr),
}

#[derive(Clone, Debug)]
struct Variable {
    data: Data,
    /// Where it was defined; nowhere if on the command line.
    span: Option<Span>,
    /// Its definition holds an unknown value (`check` mode).
    unknown: bool,
}

impl Variable {
    fn kind(&self) -> Kind {
        match self.data {
            Data::Index { .. } => Kind::Index,
            Data::Loop { .. } => Kind::Loop,
            Data::Text(_) => Kind::Text,
            Data::Getenv(_) => Kind::Getenv,
            Data::Format { .. } => Kind::Format,
            Data::Equal(_) => Kind::Equal,
            Data::Atom(_) => Kind::Atom,
        }
    }
}

/// A variable's value as text.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub text: String,
    /// Where the variable was defined.
    pub origin: Option<Span>,
    pub unknown: bool,
}

/// All variables of a session.
#[derive(Clone, Debug, Default)]
pub struct Vars {
    table: BTreeMap<String, Variable>,
    /// What `random` and `normal` draw from: one stream for numbers, one for values per particle.
    /// Copies of the table go on with the same streams.
    streams: Arc<Mutex<Streams>>,
}

/// The streams of `random` and `normal`, once their first use has seeded them.
pub(super) type Streams = [Option<Marsaglia>; 2];

impl Vars {
    /// No variables.
    pub fn new() -> Self {
        Self::default()
    }

    /// A copy that shares nothing with this table: its random streams stand where these stand now.
    pub fn detached(&self) -> Self {
        let streams = Arc::new(Mutex::new(self.streams().clone()));
        Self { streams, ..self.clone() }
    }

    pub(super) fn streams(&self) -> MutexGuard<'_, Streams> {
        self.streams.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The style of a variable.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        self.table.get(name).map(Variable::kind)
    }

    /// The formula of an equal- or atom-style variable.
    pub fn expr(&self, name: &str) -> Option<&Expr> {
        match &self.table.get(name)?.data {
            Data::Equal(e) | Data::Atom(e) => Some(e),
            _ => None,
        }
    }

    /// The variable that a format-style variable shows.
    pub fn formatted(&self, name: &str) -> Option<&str> {
        match &self.table.get(name)?.data {
            Data::Format { name, .. } => Some(name),
            _ => None,
        }
    }

    /// Where a variable was defined; `None` also if on the command line.
    pub fn span(&self, name: &str) -> Option<Span> {
        self.table.get(name)?.span
    }

    /// All names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.table.keys().map(String::as_str)
    }

    /// `-var name value …`: an index variable that wins over the deck's own.
    pub fn set_index(&mut self, name: &str, values: &[String]) -> Result<()> {
        if !is_name(name) {
            return Err(bad_name(name).into());
        }
        if values.is_empty() {
            return fail(Code::MISSING_ARGUMENT, None, format!("variable `{name}` needs at least one value"));
        }
        let data = Data::Index { values: values.to_vec(), at: 0 };
        let variable = Variable { data, span: None, unknown: false };
        self.table.entry(name.to_owned()).or_insert(variable);
        Ok(())
    }

    /// Forgets what a variable's value is (`check` mode: a branch that may not be taken has set it).
    pub fn mark_unknown(&mut self, name: &str) {
        if let Some(v) = self.table.get_mut(name) {
            v.unknown = true;
        }
    }

    /// `next`: moves all of `names` on; true if one of them has no further value (it is then forgotten).
    pub fn next(&mut self, names: &[Word]) -> Result<bool> {
        let Some(first) = names.first() else { return Ok(false) };
        for name in names {
            let Some(kind) = self.kind(&name.text) else {
                return Err(self.unknown(&name.text, name.span).into());
            };
            if !matches!(kind, Kind::Index | Kind::Loop) {
                let message = format!(
                    "`{}` is of style {}; next moves index and loop variables",
                    name.text,
                    kind.name()
                );
                return Err(blame(name, Code::WRONG_KIND, message).into());
            }
            if Some(kind) != self.kind(&first.text) {
                return fail(Code::CONFLICT, name.span, "all variables of one next must have the same style");
            }
        }
        let mut exhausted = false;
        for name in names {
            let more = self.table.get_mut(&name.text).is_some_and(|v| match &mut v.data {
                Data::Index { values, at } => {
                    *at += 1;
                    *at < values.len()
                }
                Data::Loop { now, last, .. } => {
                    *now += 1;
                    *now <= *last
                }
                _ => false,
            });
            if !more {
                self.table.remove(&name.text);
                exhausted = true;
            }
        }
        Ok(exhausted)
    }

    /// The value that replaces `$name`. `longer` is what follows a `$` without braces.
    pub(super) fn text(&self, name: &str, longer: &str, span: Span, env: &mut dyn Env) -> Result<Text> {
        let Some(variable) = self.table.get(name) else {
            let mut d = self.unknown(name, span);
            let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let full = &longer[..longer.find(|c| !word(c)).unwrap_or(longer.len())];
            if self.table.contains_key(full) {
                d.help = vec![format!("names of more than one letter need braces: ${{{full}}}")];
            }
            return Err(d.into());
        };
        let origin = variable.span;
        if variable.unknown {
            return Ok(Text { text: String::new(), origin, unknown: true });
        }
        let mut trail = Trail::default();
        let number = |v: Option<f64>, format: &dyn Fn(f64) -> Result<String>| match v {
            Some(v) => Ok(Text { text: format(v)?, origin, unknown: false }),
            None => Ok(Text { text: String::new(), origin, unknown: true }),
        };
        let text = match &variable.data {
            Data::Index { values, at } => values.get(*at).cloned().unwrap_or_default(),
            Data::Loop { now, width, .. } => format!("{now:0width$}"),
            Data::Text(t) => t.clone(),
            Data::Getenv(key) => std::env::var(key).unwrap_or_default(),
            Data::Equal(e) => {
                trail.enter(name, span)?;
                let v = e.scalar(self, env, &mut trail).map_err(|d| used(d, name, span))?;
                return number(v, &|v| Ok(value_text(v)));
            }
            Data::Format { name: of, format } => {
                let r = ValueRef { kind: RefKind::Variable, name: of.clone(), index: vec![], span };
                let v = match self.reference(&r, env, &mut trail)? {
                    Value::Number(v) => Some(v),
                    _ => None,
                };
                return number(v, &|v| printf(format, v + 0.0).or_else(|e| fail(Code::SYNTAX, span, e)));
            }
            Data::Atom(_) => {
                let message = format!("variable `{name}` has one value per particle and cannot become text");
                return fail(Code::WRONG_KIND, span, message);
            }
        };
        Ok(Text { text, origin, unknown: false })
    }

    /// The value of `v_name` or `v_name[i]` in a formula.
    pub(super) fn reference(&self, r: &ValueRef, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        let Some(variable) = self.table.get(&r.name) else {
            return Err(self.unknown(&r.name, r.span).into());
        };
        if variable.unknown {
            return Ok(Value::Unknown);
        }
        match &variable.data {
            Data::Equal(e) if r.index.is_empty() => {
                trail.enter(&r.name, r.span)?;
                let particles = std::mem::replace(&mut trail.particles, false);
                let v = e.scalar(self, env, trail).map_err(|d| used(d, &r.name, r.span))?;
                trail.particles = particles;
                trail.leave();
                Ok(v.map_or(Value::Unknown, Value::Number))
            }
            Data::Atom(e) => {
                trail.enter(&r.name, r.span)?;
                let particles = std::mem::replace(&mut trail.particles, true);
                let v = e.run(self, env, trail).map_err(|d| used(d, &r.name, r.span))?;
                trail.particles = particles;
                trail.leave();
                let all = match v {
                    Value::Number(v) => Value::Atom(vec![v; env.natoms()]),
                    other => other,
                };
                pick(all, r, env)
            }
            _ if !r.index.is_empty() => {
                let style = variable.kind().name();
                fail(
                    Code::WRONG_KIND,
                    r.span,
                    format!("`{}` is of style {style} and has no elements", r.name),
                )
            }
            _ => {
                let text = self.text(&r.name, "", r.span, env)?;
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
    }

    /// The value of a variable in formulas.
    pub fn value(&self, name: &str, span: Span, env: &mut dyn Env) -> Result<Value> {
        let r = ValueRef { kind: RefKind::Variable, name: name.to_owned(), index: vec![], span };
        self.reference(&r, env, &mut Trail::default())
    }

    fn unknown(&self, name: &str, span: Span) -> Diagnostic {
        let d = Diagnostic::error(Code::UNKNOWN_NAME, span, format!("variable `{name}` is not defined"));
        match nearest(name, self.names()) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d,
        }
    }
}

/// One particle's element of an atom-style variable, if an index asks for it.
fn pick(all: Value, r: &ValueRef, env: &mut dyn Env) -> Result<Value> {
    let [tag] = r.index[..] else {
        if r.index.is_empty() || all == Value::Unknown {
            return Ok(all);
        }
        return fail(Code::WRONG_KIND, r.span, "an atom-style variable has one index");
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

/// Marks a failure inside a variable's formula with the place that used the variable.
fn used(d: crate::diag::Diagnostics, name: &str, span: Span) -> crate::diag::Diagnostics {
    let mark = |d: Diagnostic| {
        let d = d.at(span);
        if d.span == Some(span) { d } else { d.label(span, format!("while `{name}` was evaluated here")) }
    };
    crate::diag::Diagnostics(d.0.into_iter().map(mark).collect())
}

fn is_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

fn bad_name(name: &str) -> Diagnostic {
    Diagnostic::error(Code::BAD_VALUE, None, format!("`{name}` cannot name a variable"))
        .help("letters, digits and underscores only")
}
