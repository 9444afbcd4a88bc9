//! Formulas: parsed once into a short program in postfix order, run as often as needed.

mod eval;
mod functions;
mod grammar;
mod pattern;
mod special;
mod time;

#[cfg(test)]
mod tests;

use super::command::Word;
use super::reference::{RefKind, ValueRef};
use super::text::within;
use super::value::{Env, Value};
use super::vars::{BOND_WORDS, Kind, Vars};
use functions::Function;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use std::ops::Range;

pub(super) use eval::{Trail, Yields, element};
pub(super) use grammar::balanced;

/// Attributes of particles that formulas may name, as a column (`vx`) or for one particle (`vx[3]`).
pub const ATTRIBUTES: &[&str] = &[
    "id", "type", "mol", "mass", "radius", "q", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "omegax",
    "omegay", "omegaz",
];

/// Whether a word names an attribute of particles: LAMMPS' own, or one of fix property/atom.
fn attribute(word: &str) -> bool {
    ATTRIBUTES.contains(&word) || ["i_", "d_"].iter().any(|p| word.len() > 2 && word.starts_with(p))
}

/// A parsed formula.
#[derive(Clone, Debug)]
pub struct Expr {
    text: String,
    at: Span,
    steps: Vec<Step>,
}

/// One operation and the bytes of the formula it comes from.
#[derive(Clone, Debug)]
struct Step {
    op: Op,
    range: Range<usize>,
}

/// What a step does to the stack of values.
#[derive(Clone, Debug)]
enum Op {
    Number(f64),
    Word(String),
    Column(String),
    Particle(String, Index),
    Reference(RefKind, String, Vec<Index>),
    Group(String, Vec<Name>),
    Special(&'static special::Row, Vec<Name>),
    Vector(Vec<f64>),
    Negate,
    Not,
    Binary(Binary),
    Call(&'static Function),
}

/// An argument that is a name and no formula, and its bytes of the formula.
#[derive(Clone, Debug)]
struct Name {
    text: String,
    range: Range<usize>,
}

/// An index in brackets: `[3]` or `[v_name]`.
#[derive(Clone, Debug)]
enum Index {
    Number(usize),
    Variable(String),
}

/// The operators with two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Binary {
    Or,
    Xor,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
}

/// What a formula needs from outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Dep {
    /// A thermo keyword.
    Keyword(String),
    /// A compute or a fix.
    Ref(ValueRef),
}

impl Expr {
    /// Reads the formula `text`, which stands at `at` in the deck.
    pub fn parse(text: &str, at: Span) -> Result<Self> {
        let steps = grammar::parse(text).map_err(|fault| {
            let code = match fault.code {
                Code::SYNTAX => Code::FORMULA,
                Code::UNKNOWN_NAME => Code::UNKNOWN_WORD,
                other => other,
            };
            let mut d = Diagnostic::error(code, within(at, text.len(), fault.range), fault.message);
            d.help = fault.help;
            d
        })?;
        Ok(Self { text: text.to_owned(), at, steps })
    }

    /// The formula as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where it is written.
    pub fn span(&self) -> Span {
        self.at
    }

    /// Its value now.
    pub fn eval(&self, vars: &Vars, env: &mut dyn Env) -> Result<Value> {
        self.run(vars, env, &mut Trail::default())
    }

    /// Its value as one number; `None` if that is unknown in `check` mode.
    pub fn number(&self, vars: &Vars, env: &mut dyn Env) -> Result<Option<f64>> {
        self.scalar(vars, env, &mut Trail::default())
    }

    /// Its value for every particle (a number counts for all of them); `None` if unknown.
    pub fn per_particle(&self, vars: &Vars, env: &mut dyn Env) -> Result<Option<Vec<f64>>> {
        let mut trail = Trail::for_particles();
        match self.run(vars, env, &mut trail)? {
            Value::Unknown => Ok(None),
            Value::Number(v) => Ok(Some(vec![v; env.natoms()])),
            Value::Atom(v) => Ok(Some(v)),
            Value::Vector(_) => self.wrong("one value per particle", "a global vector"),
        }
    }

    /// Everything it needs from outside, through the variables it names; each once, in order of use.
    pub fn depends(&self, vars: &Vars) -> Vec<Dep> {
        let mut out = Vec::new();
        self.collect(vars, &mut out, &mut Vec::new());
        out
    }

    pub(super) fn scalar(&self, vars: &Vars, env: &mut dyn Env, trail: &mut Trail) -> Result<Option<f64>> {
        match self.run(vars, env, trail)? {
            Value::Unknown => Ok(None),
            Value::Number(v) => Ok(Some(v)),
            other => self.wrong("one number", other.kind()),
        }
    }

    /// Its value as a global vector, or unknown.
    pub(super) fn vector(&self, vars: &Vars, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        match self.run(vars, env, trail)? {
            v @ (Value::Unknown | Value::Vector(_)) => Ok(v),
            other => self.wrong("a global vector", other.kind()),
        }
    }

    fn wrong<T>(&self, wanted: &str, got: &str) -> Result<T> {
        let text = &self.text;
        fail(Code::WRONG_KIND, self.at, format!("`{text}` yields {got}; {wanted} is needed here"))
    }

    fn collect(&self, vars: &Vars, out: &mut Vec<Dep>, seen: &mut Vec<String>) {
        let mut add = |d: Dep| {
            let known = |e: &Dep| match (e, &d) {
                (Dep::Ref(a), Dep::Ref(b)) => a.kind == b.kind && a.name == b.name && a.index == b.index,
                _ => *e == d,
            };
            if !out.iter().any(known) {
                out.push(d);
            }
        };
        let mut names = Vec::new();
        for step in &self.steps {
            match &step.op {
                Op::Word(name) => add(Dep::Keyword(name.clone())),
                Op::Reference(RefKind::Variable, name, index) => {
                    names.push(name.clone());
                    names.extend(index.iter().filter_map(Index::variable).cloned());
                }
                Op::Reference(kind, name, index) => {
                    let fixed = |i: &Index| if let Index::Number(k) = i { *k } else { 1 };
                    let span = self.place(&step.range);
                    let index_numbers = index.iter().map(fixed).collect();
                    add(Dep::Ref(ValueRef { kind: *kind, name: name.clone(), index: index_numbers, span }));
                    names.extend(index.iter().filter_map(Index::variable).cloned());
                }
                Op::Particle(_, index) => names.extend(index.variable().cloned()),
                Op::Special(row, args) if matches!(row.what, special::Special::Reduce(_)) => {
                    match special::vector_of(&self.words(args), self.place(&step.range)) {
                        Some(r) if r.kind == RefKind::Variable => names.push(r.name),
                        Some(r) => add(Dep::Ref(r)),
                        None => {}
                    }
                }
                _ => {}
            }
        }
        names.iter().for_each(|name| collect_of(name, vars, out, seen));
    }

    fn place(&self, range: &Range<usize>) -> Span {
        within(self.at, self.text.len(), range.clone())
    }

    /// Names with their places in the deck.
    fn words(&self, names: &[Name]) -> Vec<Word> {
        names.iter().map(|n| Word::new(n.text.as_str(), self.place(&n.range))).collect()
    }
}

/// What a variable needs from outside, through its formula or what its function in Python is given.
fn collect_of(name: &str, vars: &Vars, out: &mut Vec<Dep>, seen: &mut Vec<String>) {
    if seen.iter().any(|known| known == name) {
        return;
    }
    seen.push(name.to_string());
    if let Some(e) = vars.expr(name) {
        let before = out.len();
        e.collect(vars, out, seen);
        if vars.kind(name) == Some(Kind::Bond) {
            // These come from the bonds themselves.
            let of_bond = |d: &Dep| matches!(d, Dep::Keyword(k) if BOND_WORDS.contains(&k.as_str()));
            let own = out.split_off(before);
            out.extend(own.into_iter().filter(|d| !of_bond(d)));
        }
    }
    vars.inputs(name).for_each(|input| collect_of(input, vars, out, seen));
}

impl Vars {
    /// What a variable's value needs from outside, also through other variables.
    pub fn depends(&self, name: &str) -> Vec<Dep> {
        let mut out = vec![];
        collect_of(name, self, &mut out, &mut vec![]);
        out
    }
}

impl Index {
    fn variable(&self) -> Option<&String> {
        if let Index::Variable(name) = self { Some(name) } else { None }
    }
}

/// "no such thermo keyword", with the nearest one.
fn unknown_word(name: &str, span: Span, env: &dyn Env) -> Diagnostic {
    let d = Diagnostic::error(Code::UNKNOWN_WORD, span, format!("`{name}` is nothing a formula knows"));
    let mut known = env.keywords();
    known.extend(ATTRIBUTES);
    known.extend(functions::CONSTANTS);
    match nearest(name, known) {
        Some(k) => d.help(format!("did you mean `{k}`?")),
        None => d.help("variables are written v_name, computes c_ID, fixes f_ID"),
    }
}
