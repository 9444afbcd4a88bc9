//! The world as formulas see it inside a step.

use super::answers::{self, Declared};
use super::measure;
use super::offered::{from_slot, of_particles, whole_vector};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{Clock, Env, Question, Value, ValueRef, Vars, Word};
use perigrain_world::named::Acting;
use perigrain_world::{SlotId, World};
use std::collections::BTreeMap;

/// A value of one attribute per particle, by LAMMPS' names.
fn attribute(w: &World, name: &str, i: usize) -> Option<f64> {
    let p = &w.particles;
    let of = |column: &Vec<[f64; 3]>, d: usize| column.get(i).map(|a| a[d]);
    Some(match name {
        "id" => f64::from(*p.tag.get(i)?),
        "type" => f64::from(*p.kind.get(i)?),
        "mol" => f64::from(*p.molecule.get(i)?),
        "mass" => *p.mass.get(i)?,
        "radius" => *p.radius.get(i)?,
        "x" => of(&p.x, 0)?,
        "y" => of(&p.x, 1)?,
        "z" => of(&p.x, 2)?,
        "vx" => of(&p.v, 0)?,
        "vy" => of(&p.v, 1)?,
        "vz" => of(&p.v, 2)?,
        "fx" => of(&p.f, 0)?,
        "fy" => of(&p.f, 1)?,
        "fz" => of(&p.f, 2)?,
        "omegax" => of(&p.omega, 0)?,
        "omegay" => of(&p.omega, 1)?,
        "omegaz" => of(&p.omega, 2)?,
        custom => *w.columns.get_scalar(w.columns.custom(custom)?)?.get(i)?,
    })
}

/// An attribute of one particle.
pub(super) fn one(w: &World, name: &str, tag: usize, span: Span) -> Result<Value> {
    let Some(i) = u32::try_from(tag).ok().and_then(|t| w.particles.index_of(t)) else {
        return fail(Code::UNKNOWN_NAME, span, format!("there is no particle {tag}"));
    };
    match attribute(w, name, i) {
        Some(a) => Ok(Value::Number(a)),
        None => fail(Code::WRONG_KIND, span, format!("this atom style has no `{name}`")),
    }
}

/// An attribute of all particles, if there is one of this name.
pub(super) fn column(w: &World, name: &str) -> Option<Result<Vec<f64>>> {
    const KNOWN: [&str; 17] = [
        "id", "type", "mol", "mass", "radius", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "omegax",
        "omegay", "omegaz",
    ];
    if let Some(key) = w.columns.custom(name) {
        let mut list = w.columns.get_scalar(key).unwrap_or_default().to_vec();
        list.resize(w.n(), 0.0);
        return Some(Ok(list));
    }
    if !KNOWN.contains(&name) {
        return None;
    }
    let list: Option<Vec<f64>> = (0..w.n()).map(|i| attribute(w, name, i)).collect();
    Some(match list {
        Some(list) => Ok(list),
        None => fail(Code::WRONG_KIND, None, format!("this atom style has no `{name}`")),
    })
}

/// The clock as formulas see it.
pub(super) fn clock(w: &World) -> Clock {
    let c = &w.clock;
    // Between runs LAMMPS counts from step 0.
    let begin = if w.settings.lammps() && !c.running { 0 } else { c.start };
    Clock { step: c.step, begin, end: c.stop, dt: c.dt, running: c.running }
}

/// Inside a step: values come from slots that the plan has filled before; all else that a formula names is looked up.
pub struct RunEnv<'a> {
    /// The world, read only.
    w: &'a World,
    /// What is declared.
    declared: &'a Declared,
    /// The slots of what the formula depends on.
    from: &'a BTreeMap<String, SlotId>,
    _reads: Acting,
}

impl<'a> RunEnv<'a> {
    /// For formulas whose values are in the slots `from`.
    pub fn new(w: &'a World, declared: &'a Declared, from: &'a BTreeMap<String, SlotId>) -> Self {
        Self { w, declared, from, _reads: Acting::text() }
    }
}

impl Env for RunEnv<'_> {
    fn keyword(&mut self, name: &str, _: Span, _: &Vars) -> Option<Result<Value>> {
        let slot = self.from.get(name)?;
        Some(Ok(Value::Number(self.w.slots.get(*slot).scalar)))
    }
    fn reference(&mut self, r: &ValueRef, _: &Vars) -> Result<Value> {
        match self.from.get(&r.to_string()) {
            Some(slot) => from_slot(self.w, *slot, r),
            None => fail(Code::UNKNOWN_NAME, r.span, format!("`{r}` is not available in this step")),
        }
    }
    fn of_particles(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        match self.from.get(&r.to_string()) {
            Some(slot) => of_particles(self.w, *slot, r),
            None => self.reference(r, vars),
        }
    }
    fn particle(&mut self, attribute: &str, tag: usize, span: Span) -> Result<Value> {
        one(self.w, attribute, tag, span)
    }
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>> {
        column(self.w, attribute)
    }
    fn group_function(&mut self, name: &str, args: &[Word], span: Span, _: &Vars) -> Result<Value> {
        measure::group_function(self.w, name, args, span).map(Value::Number)
    }
    fn vector(&mut self, r: &ValueRef, _: &Vars) -> Result<Value> {
        match self.from.get(&r.to_string()) {
            Some(slot) => whole_vector(self.w, *slot, r),
            None => fail(Code::UNKNOWN_NAME, r.span, format!("`{r}` is not available in this step")),
        }
    }
    fn mask(&mut self, group: Option<&Word>, region: Option<&Word>, _: &Vars) -> Result<Value> {
        answers::mask(self.w, group, region).map(Value::Atom)
    }
    fn setting(&self, name: &str) -> Option<Value> {
        answers::setting(self.w, false, name)
    }
    fn answer(&self, question: Question, category: &Word, name: &Word) -> Result<bool> {
        answers::answer(self.w, self.declared, question, category, name)
    }
    fn timed_out(&self) -> bool {
        self.w.settings.timed_out()
    }

    fn control(&self, name: &str) -> Option<f64> {
        self.w.controls.look_up(name).copied()
    }
    fn clock(&self) -> Clock {
        clock(self.w)
    }
    fn natoms(&self) -> usize {
        self.w.n()
    }
}
