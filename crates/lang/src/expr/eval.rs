//! Runs the program of a formula on a stack of values.

use super::super::number;
use super::super::reference::{RefKind, ValueRef};
use super::super::value::{Env, Value};
use super::super::vars::{Kind, Vars};
use super::functions::{Body, Function};
use super::{Binary, Expr, Index, Op, Step, special, unknown_word};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::rng::Marsaglia;
use std::cell::RefCell;

/// How many variables may stand for one another in a chain.
const CHAIN: usize = 100;

/// How many variables may be evaluated for one value: variables that each name the one before twice need 2 to the power of
/// their number.
const EVALUATIONS: u32 = 1_000_000;

/// What a formula is for: it decides which of a compute's values a name means, and what `random` draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in super::super) enum Yields {
    /// One number, or whatever comes out.
    #[default]
    Any,
    /// A global vector.
    Vector,
    /// A value per particle.
    Particles,
    /// A value per bond.
    Bonds,
}

/// The variables under evaluation, outermost first.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Trail {
    names: Vec<String>,
    /// How many variables have been entered so far.
    entered: u32,
    /// What the innermost formula is for.
    pub yields: Yields,
}

impl Trail {
    /// For a formula that yields a value per particle.
    pub fn for_particles() -> Self {
        Self { yields: Yields::Particles, ..Self::default() }
    }

    /// For a formula that yields a value per bond.
    pub fn for_bonds() -> Self {
        Self { yields: Yields::Bonds, ..Self::default() }
    }

    /// Goes into a variable; refuses circles and endless chains.
    pub fn enter(&mut self, name: &str, span: Span) -> Result<()> {
        if self.names.iter().any(|n| n == name) {
            let chain = self.names.iter().map(|n| format!("v_{n}")).collect::<Vec<_>>().join(" → ");
            let d = Diagnostic::error(Code::BAD_VALUE, span, format!("variable `{name}` depends on itself"));
            return Err(d.help(format!("the circle: {chain} → v_{name}")).into());
        }
        if self.names.len() >= CHAIN {
            return fail(Code::BAD_VALUE, span, format!("more than {CHAIN} variables depend on one another"));
        }
        self.entered += 1;
        if self.entered > EVALUATIONS {
            let text = format!("more than {EVALUATIONS} variables would be evaluated for this one value");
            let d = Diagnostic::error(Code::TOO_LARGE, span, text);
            return Err(d
                .help("let `${name}` put in the value of a variable that is named more than once")
                .into());
        }
        self.names.push(name.to_owned());
        Ok(())
    }

    /// Leaves the variable entered last.
    pub fn leave(&mut self) {
        self.names.pop();
    }
}

impl Expr {
    /// The formula's value, below the variables of `trail`.
    pub(in super::super) fn run(&self, vars: &Vars, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        let mut stack: Vec<Value> = Vec::new();
        for step in &self.steps {
            let value = match &step.op {
                Op::Number(v) => Value::Number(*v),
                Op::Vector(list) => Value::Vector(list.clone()),
                Op::Negate => self.each(step, stack.pop().as_slice(), |a| Ok(-a[0]))?,
                Op::Not => self.each(step, stack.pop().as_slice(), |a| Ok(truth(a[0] == 0.0)))?,
                Op::Binary(op) => {
                    let args = stack.split_off(stack.len().saturating_sub(2));
                    self.each(step, &args, |a| op.apply(a[0], a[1]))?
                }
                Op::Call(f) => {
                    let args = stack.split_off(stack.len().saturating_sub(f.arity));
                    self.call(step, f, &args, vars, env, trail.yields == Yields::Particles)?
                }
                _ => self.leaf(step, vars, env, trail)?,
            };
            stack.push(value);
        }
        // the grammar leaves exactly one value
        Ok(stack.pop().unwrap_or(Value::Unknown))
    }

    /// A function of the values `args`.
    fn call(
        &self,
        step: &Step,
        f: &Function,
        args: &[Value],
        vars: &Vars,
        env: &mut dyn Env,
        particles: bool,
    ) -> Result<Value> {
        let draw = match f.body {
            Body::Plain(body) => {
                let clock = env.clock();
                return self.each(step, args, |a| body(a, &clock).map_err(|e| format!("{}(): {e}", f.name)));
            }
            Body::Draw(draw) => draw,
        };
        let mut streams = vars.streams();
        let stream = RefCell::new(&mut streams[usize::from(particles)]);
        let one = |a: &[f64]| {
            let mut stream = stream.borrow_mut();
            if stream.is_none() {
                **stream = Some(seeded(a[2]).map_err(|e| format!("{}(): {e}", f.name))?);
            }
            let number = stream.as_mut().map_or(Ok(0.0), |s| draw(s, a));
            number.map_err(|e| format!("{}(): {e}", f.name))
        };
        if !particles {
            return self.each(step, args, one);
        }
        if !env.sees_particles() {
            return Ok(Value::Unknown);
        }
        // one number per particle, also if all particles share the arguments
        let spread = Value::Atom(vec![0.0; env.natoms()]);
        let mut args = args.to_vec();
        args.push(spread);
        self.each(step, &args, one)
    }

    /// A value from outside the formula.
    fn leaf(&self, step: &Step, vars: &Vars, env: &mut dyn Env, trail: &mut Trail) -> Result<Value> {
        let span = self.place(&step.range);
        match &step.op {
            Op::Word(name) => {
                if name.contains("cpu") || name == "timeremain" {
                    vars.event();
                }
                match env.keyword(name, span, vars) {
                    Some(v) => v.map_err(|d| d.at(span)),
                    None => Err(unknown_word(name, span, env).into()),
                }
            }
            Op::Column(name) => match env.column(name) {
                Some(v) if !env.sees_particles() => v.map(|_| Value::Unknown).map_err(|d| d.at(span)),
                Some(v) => v.map(Value::Atom).map_err(|d| d.at(span)),
                None => fail(Code::WRONG_KIND, span, format!("the particles have no `{name}`")),
            },
            Op::Particle(name, index) => match self.index(index, span, vars, env, trail)? {
                Some(tag) => env.particle(name, tag, span).map_err(|d| d.at(span)),
                None => Ok(Value::Unknown),
            },
            Op::Special(row, args) => {
                special::value(row, &self.words(args), span, vars, env, trail).map_err(|d| d.at(span))
            }
            Op::Group(name, args) => {
                env.group_function(name, &self.words(args), span, vars).map_err(|d| d.at(span))
            }
            Op::Reference(kind, name, indices) => {
                let mut index = Vec::with_capacity(indices.len());
                for i in indices {
                    match self.index(i, span, vars, env, trail)? {
                        Some(k) => index.push(k),
                        None => return Ok(Value::Unknown),
                    }
                }
                let r = ValueRef { kind: *kind, name: name.clone(), index, span };
                if *kind != RefKind::Variable {
                    let value = match trail.yields {
                        Yields::Particles => env.of_particles(&r, vars),
                        Yields::Vector if r.index.is_empty() => env.vector(&r, vars).and_then(|v| match v {
                            Value::Atom(_) => {
                                fail(Code::WRONG_KIND, span, format!("`{r}` is no global vector"))
                            }
                            v => Ok(v),
                        }),
                        _ => env.reference(&r, vars),
                    };
                    return value.map_err(|d| d.at(span));
                }
                if trail.yields == Yields::Bonds && vars.kind(name).is_some_and(Kind::per_particle) {
                    return vars.at_end(&r, env, trail);
                }
                // LAMMPS reads equal-style variables by way of their text
                match vars.reference(&r, env, trail)? {
                    Value::Number(v) if vars.kind(name) == Some(Kind::Equal) => {
                        Ok(Value::Number(number::rounded(v)))
                    }
                    value => Ok(value),
                }
            }
            _ => Ok(Value::Unknown),
        }
    }

    /// The number an index stands for.
    fn index(
        &self,
        index: &Index,
        span: Span,
        vars: &Vars,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Option<usize>> {
        let name = match index {
            Index::Number(k) => return Ok(Some(*k)),
            Index::Variable(name) => name.clone(),
        };
        let r = ValueRef { kind: RefKind::Variable, name, index: vec![], span };
        match vars.reference(&r, env, trail)? {
            Value::Unknown => Ok(None),
            Value::Number(v) if (1.0..9e15).contains(&v) => Ok(Some(v as usize)),
            _ => fail(
                Code::BAD_VALUE,
                span,
                format!("v_{} is no index: a whole number from 1 is needed", r.name),
            ),
        }
    }

    /// Applies a function of numbers, element by element where there are vectors.
    fn each(
        &self,
        step: &Step,
        args: &[Value],
        f: impl Fn(&[f64]) -> core::result::Result<f64, String>,
    ) -> Result<Value> {
        let apply = |a: &[f64]| {
            f(a).map_err(|e| Diagnostic::error(Code::BAD_VALUE, self.place(&step.range), e).into())
        };
        if args.contains(&Value::Unknown) {
            return Ok(Value::Unknown);
        }
        let Some(len) = self.common_length(step, args)? else {
            let mut row = [0.0; 6];
            for (r, a) in row.iter_mut().zip(args) {
                *r = element(a, 0);
            }
            return apply(&row[..args.len()]).map(Value::Number);
        };
        let mut row = vec![0.0; args.len()];
        let mut out = Vec::with_capacity(len);
        for k in 0..len {
            for (r, a) in row.iter_mut().zip(args) {
                *r = element(a, k);
            }
            out.push(apply(&row)?);
        }
        let atoms = args.iter().any(|a| matches!(a, Value::Atom(_)));
        Ok(if atoms { Value::Atom(out) } else { Value::Vector(out) })
    }

    /// The length all vectors among `args` share; `None` if all are numbers.
    fn common_length(&self, step: &Step, args: &[Value]) -> Result<Option<usize>> {
        let mut first: Option<(bool, usize)> = None;
        for a in args {
            let shape = match a {
                Value::Atom(v) => (true, v.len()),
                Value::Vector(v) => (false, v.len()),
                _ => continue,
            };
            if first.is_some_and(|f| f != shape) {
                let span = self.place(&step.range);
                return fail(
                    Code::WRONG_KIND,
                    span,
                    "vectors of different kind or length cannot be combined",
                );
            }
            first = Some(shape);
        }
        Ok(first.map(|(_, n)| n))
    }
}

/// Element `k` of a value; a number is the same for every element.
pub(in super::super) fn element(value: &Value, k: usize) -> f64 {
    match value {
        Value::Number(v) => *v,
        Value::Vector(v) | Value::Atom(v) => v.get(k).copied().unwrap_or(0.0),
        Value::Unknown => 0.0,
    }
}

/// The random stream that starts at `seed`.
fn seeded(seed: f64) -> core::result::Result<Marsaglia, String> {
    let max = Marsaglia::MAX_SEED;
    if seed >= 1.0 && seed < f64::from(max) + 1.0 {
        return Ok(Marsaglia::new(seed as u32));
    }
    Err(format!("the seed must be a whole number from 1 to {max}"))
}

/// 1 or 0.
fn truth(b: bool) -> f64 {
    f64::from(u8::from(b))
}

impl Binary {
    /// The operator on two numbers; the error explains why they have no result.
    fn apply(self, a: f64, b: f64) -> core::result::Result<f64, String> {
        Ok(match self {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide if b == 0.0 => return Err("division by zero".into()),
            Binary::Divide => a / b,
            Binary::Modulo if b == 0.0 => return Err("remainder of a division by zero".into()),
            Binary::Modulo => a % b,
            Binary::Power if a == 0.0 && b < 0.0 => return Err("zero to a negative power".into()),
            Binary::Power => a.powf(b),
            Binary::Equal => truth(a == b),
            Binary::NotEqual => truth(a != b),
            Binary::Less => truth(a < b),
            Binary::LessEqual => truth(a <= b),
            Binary::Greater => truth(a > b),
            Binary::GreaterEqual => truth(a >= b),
            Binary::And => truth(a != 0.0 && b != 0.0),
            Binary::Or => truth(a != 0.0 || b != 0.0),
            Binary::Xor => truth((a != 0.0) != (b != 0.0)),
        })
    }
}
