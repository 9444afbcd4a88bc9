//! Values of formulas, and what a formula asks of the world around it.

use super::reference::ValueRef;
use crate::diag::{Result, Span};

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
    /// Whether a run is going on; `ramp` rests at its first value otherwise.
    pub running: bool,
}

/// What a formula yields.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Not known before the run (`check` mode only); whatever is computed from it is unknown too.
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

/// The world as formulas see it.
pub trait Env {
    /// A thermo keyword (`step`, `pe`, `vol` …); `None` if there is no such keyword.
    fn keyword(&mut self, name: &str) -> Option<Result<Value>>;
    /// The value of a compute or fix.
    fn reference(&mut self, r: &ValueRef) -> Result<Value>;
    /// One particle's `x`, `vx`, `mass`, `type` …; `tag` counts from 1.
    fn particle(&mut self, attribute: &str, tag: usize, span: Span) -> Result<Value>;
    /// An attribute of every particle, in storage order; `None` if there is no such attribute.
    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>>;
    /// `count(group)`, `xcm(group,dim[,region])` …; number and form of the arguments have been checked.
    fn group_function(&mut self, name: &str, args: &[String], span: Span) -> Result<Value>;
    /// The present step and run.
    fn clock(&self) -> Clock;
    /// How many particles there are.
    fn natoms(&self) -> usize;
    /// Every thermo keyword, for "did you mean".
    fn keywords(&self) -> Vec<&str> {
        vec![]
    }
}
