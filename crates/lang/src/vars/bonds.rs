//! Formulas that yield one value for each peridynamic bond.

use super::super::command::Word;
use super::super::expr::{Expr, Trail, Yields};
use super::super::reference::ValueRef;
use super::super::value::{Clock, Env, Question, Value};
use super::{Kind, Vars};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};

/// What the formula of a bond-style variable may name of a bond: its stretch, its length at the start, its direction now, and
/// temperature and damage of its ends.
pub const BOND_WORDS: [&str; 9] = ["s", "L", "nx", "ny", "nz", "T1", "T2", "d1", "d2"];

/// The bonds that a formula is evaluated for.
pub struct Bonds<'a> {
    /// The particles at their ends.
    pub ends: &'a [[u32; 2]],
    /// Each of [`BOND_WORDS`] for all bonds.
    pub word: &'a dyn Fn(&str) -> Result<Vec<f64>>,
}

impl Vars {
    /// The values of a bond-style variable, one for each bond.
    ///
    /// # Errors
    /// Variables of other styles, and formulas that cannot be evaluated.
    pub fn of_bonds(&self, r: &ValueRef, env: &mut dyn Env, bonds: &Bonds) -> Result<Vec<f64>> {
        let kind = self.kind(&r.name);
        if kind != Some(Kind::Bond) {
            let Some(kind) = kind else { return Err(self.unknown(&r.name, r.span).into()) };
            let text = format!("`{r}` is of style {}; a bond-style variable is needed", kind.name());
            let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
            return Err(d
                .help(format!("`variable {} bond \"s/0.01\"` has one value for each bond", r.name))
                .into());
        }
        let mut env = BondEnv { inner: env, bonds };
        let mut trail = Trail::for_bonds();
        match self.reference(r, &mut env, &mut trail)? {
            Value::Number(v) => Ok(vec![v; bonds.ends.len()]),
            Value::Vector(list) if list.len() == bonds.ends.len() => Ok(list),
            other => {
                let text = format!("`{r}` yields {}, not one value for each bond", other.kind());
                let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
                Err(d
                    .help("values of particles are written v_NAME[1] and v_NAME[2], by the ends of the bond")
                    .into())
            }
        }
    }

    /// The value of a bond-style variable that another one names.
    pub(super) fn bond_value(
        &self,
        e: &Expr,
        r: &ValueRef,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Value> {
        if trail.yields != Yields::Bonds {
            let text =
                format!("variable `{}` has one value per bond, which this formula cannot take", r.name);
            let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
            return Err(d
                .help("bond-style variables serve `peri_modify break formula` and each other")
                .into());
        }
        if !r.index.is_empty() {
            return fail(Code::WRONG_KIND, r.span, format!("variable `{}` has no elements", r.name));
        }
        trail.inside(r, Yields::Bonds, |trail| e.run(self, env, trail))
    }

    /// The value at one end of each bond, `v_name[1]` or `v_name[2]`, of a variable with values per particle.
    pub(in super::super) fn at_end(
        &self,
        r: &ValueRef,
        env: &mut dyn Env,
        trail: &mut Trail,
    ) -> Result<Value> {
        let [end @ (1 | 2)] = r.index[..] else {
            let text = format!("`{r}` has one value per particle, and a bond has two ends");
            let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
            return Err(d.help(format!("write v_{0}[1] or v_{0}[2]", r.name)).into());
        };
        let all = self.reference(&ValueRef { index: vec![], ..r.clone() }, env, trail)?;
        let Value::Atom(values) = all else { return Ok(all) };
        Ok(env.of_ends(&values, end).map_or(Value::Unknown, Value::Vector))
    }
}

/// The scene as formulas of bonds see it.
struct BondEnv<'a> {
    inner: &'a mut dyn Env,
    bonds: &'a Bonds<'a>,
}

impl Env for BondEnv<'_> {
    fn keyword(&mut self, name: &str, span: Span, vars: &Vars) -> Option<Result<Value>> {
        match BOND_WORDS.contains(&name) {
            true => Some((self.bonds.word)(name).map(Value::Vector)),
            false => self.inner.keyword(name, span, vars),
        }
    }
    fn of_ends(&self, values: &[f64], end: usize) -> Option<Vec<f64>> {
        let at = |ends: &[u32; 2]| values.get(ends[end - 1] as usize).copied().unwrap_or(0.0);
        Some(self.bonds.ends.iter().map(at).collect())
    }
    fn reference(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.inner.reference(r, vars)
    }
    fn of_particles(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.inner.of_particles(r, vars)
    }
    fn vector(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.inner.vector(r, vars)
    }
    fn particle(&mut self, attribute: &str, tag: usize, span: Span) -> Result<Value> {
        self.inner.particle(attribute, tag, span)
    }
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>> {
        self.inner.column(attribute)
    }
    fn group_function(&mut self, name: &str, args: &[Word], span: Span, vars: &Vars) -> Result<Value> {
        self.inner.group_function(name, args, span, vars)
    }
    fn sees_particles(&self) -> bool {
        self.inner.sees_particles()
    }
    fn only_looks(&self) -> bool {
        self.inner.only_looks()
    }
    fn may_be_written(&self, path: &str) -> bool {
        self.inner.may_be_written(path)
    }
    fn mask(&mut self, group: Option<&Word>, region: Option<&Word>, vars: &Vars) -> Result<Value> {
        self.inner.mask(group, region, vars)
    }
    fn setting(&self, name: &str) -> Option<Value> {
        self.inner.setting(name)
    }
    fn answer(&self, question: Question, category: &Word, name: &Word) -> Result<bool> {
        self.inner.answer(question, category, name)
    }
    fn control(&self, name: &str) -> Option<f64> {
        self.inner.control(name)
    }
    fn timed_out(&self) -> bool {
        self.inner.timed_out()
    }
    fn clock(&self) -> Clock {
        self.inner.clock()
    }
    fn natoms(&self) -> usize {
        self.inner.natoms()
    }
    fn keywords(&self) -> Vec<&str> {
        self.inner.keywords().into_iter().chain(BOND_WORDS).collect()
    }
}
