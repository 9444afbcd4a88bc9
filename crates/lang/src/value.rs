//! Values of formulas, and the environment that formulas are evaluated in.

use super::command::Word;
use super::reference::ValueRef;
use super::vars::Vars;
use perigrain_base::diag::{Code, Result, Span, fail};

/// Time as formulas see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// The present step.
    pub step: i64,
    /// The step at which the current (or last) run began, or its `start`.
    pub begin: i64,
    /// The step at which the current (or last) run ends, or its `stop`.
    pub end: i64,
    /// The time step.
    pub dt: f64,
    /// Whether a run is in progress; `ramp` stays at its first value otherwise.
    pub running: bool,
}

/// What a formula yields.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A value that only a run determines, where a deck is checked without one; every result computed from it is unknown too.
    Unknown,
    /// One number.
    Number(f64),
    /// A global vector.
    Vector(Vec<f64>),
    /// One number per particle.
    Atom(Vec<f64>),
}

impl Value {
    /// What the value is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Unknown => "an unknown value",
            Value::Number(_) => "a number",
            Value::Vector(_) => "a global vector",
            Value::Atom(_) => "one value per particle",
        }
    }
}

/// A question about the session: `is_active(category,name)` and its kin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// `is_active`: is it in use?
    Active,
    /// `is_available`: could it be used?
    Available,
    /// `is_defined`: has the deck defined it?
    Defined,
}

/// The world as formulas see it.
///
/// `vars` is the variable table of the formula at hand: what is computed for it may read variables too.
pub trait Env {
    /// A thermo keyword (`step`, `pe`, `vol` …); `None` if there is no such keyword.
    fn keyword(&mut self, name: &str, span: Span, vars: &Vars) -> Option<Result<Value>>;
    /// The value of a compute or fix.
    fn reference(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value>;
    /// The same in a formula of one value per particle: where there are both, the particles' own values.
    fn of_particles(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.reference(r, vars)
    }
    /// The whole global vector of a compute or fix; with an index, that column of its global array.
    fn vector(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.reference(r, vars)
    }
    /// One particle's `x`, `vx`, `mass`, `type` …; `tag` counts from 1.
    fn particle(&mut self, attribute: &str, tag: usize, span: Span) -> Result<Value>;
    /// An attribute of every particle, in storage order; `None` if there is no such attribute.
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>>;
    /// `count(group)`, `xcm(group,dim[,region])` …; number and form of the arguments have been checked.
    fn group_function(&mut self, name: &str, args: &[Word], span: Span, vars: &Vars) -> Result<Value>;
    /// Whether columns hold the particles as they are in a run.
    fn sees_particles(&self) -> bool {
        true
    }
    /// Whether the deck is only looked at: no function of another program is called then.
    fn only_looks(&self) -> bool {
        false
    }
    /// Whether a file may be there in a run that is not there, or is another one, where a deck is only looked at.
    fn may_be_written(&self, _path: &str) -> bool {
        false
    }
    /// For every particle 1 if it is in the group and in the region, else 0.
    fn mask(&mut self, group: Option<&Word>, region: Option<&Word>, _: &Vars) -> Result<Value> {
        fail(Code::WRONG_ORDER, group.or(region).map(|w| w.span), "there are no particles here")
    }
    /// `extract_setting(name)`; `None` if there is no such setting.
    fn setting(&self, _name: &str) -> Option<Value> {
        None
    }
    /// `is_active`, `is_available`, `is_defined`; variables are looked up by the caller.
    fn answer(&self, _question: Question, category: &Word, _name: &Word) -> Result<bool> {
        fail(Code::UNKNOWN_NAME, category.span, "there is no scene here")
    }
    /// The value to which a fix has set an internal-style variable in the present run.
    fn control(&self, _name: &str) -> Option<f64> {
        None
    }
    /// Whether the limit of `timer timeout` has passed.
    fn timed_out(&self) -> bool {
        false
    }
    /// The values of the first (1) or second (2) end of each bond, from those of all particles; `None` where there are no bonds.
    fn of_ends(&self, _values: &[f64], _end: usize) -> Option<Vec<f64>> {
        None
    }
    /// The present step and run.
    fn clock(&self) -> Clock;
    /// How many particles there are.
    fn natoms(&self) -> usize;
    /// Every thermo keyword, for "did you mean".
    fn keywords(&self) -> Vec<&str> {
        vec![]
    }
}
