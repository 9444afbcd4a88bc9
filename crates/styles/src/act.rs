//! What acts may use while they act.

use crate::BondForce;
use crate::probe::Probe;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Source, Span};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::{Command, Param, ValueRef, Word};
use perigrain_world::{GroupId, World};
use std::cell::RefCell;
use std::sync::Arc;

/// Evaluates what a deck refers to, between runs.
pub trait Values {
    /// One number.
    ///
    /// # Errors
    /// Unknown names, values that are not available between runs.
    fn scalar(&mut self, w: &mut World, r: &ValueRef) -> Result<f64>;
    /// One number per particle.
    ///
    /// # Errors
    /// As `scalar`.
    fn per_atom(&mut self, w: &mut World, r: &ValueRef) -> Result<Vec<f64>>;
    /// One number, after internal-style variables have been given these values.
    ///
    /// # Errors
    /// As `scalar`, and variables that are not internal-style.
    fn with_internal(&mut self, w: &mut World, r: &ValueRef, set: &[(&ValueRef, f64)]) -> Result<f64>;
    /// The velocity that a temperature takes away from each particle.
    ///
    /// # Errors
    /// Computes that take none away.
    fn flow(&mut self, w: &mut World, compute: &ValueRef) -> Result<Flow>;
    /// Stops the bodies of a fix of rigid bodies, and their particles with them.
    ///
    /// # Errors
    /// Other fixes, and bodies that cannot be.
    fn stop(&mut self, w: &mut World, fix: &Word, what: Motion) -> Result<()>;
    /// Probes of the pair style in force for single pairs.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn probes(&self, _w: &World) -> Result<Vec<Box<dyn Probe>>> {
        Ok(vec![])
    }
    /// The bond style in force.
    fn bonds(&self) -> Option<Box<dyn BondForce>> {
        None
    }
}

/// What a temperature subtracts from velocities before it uses them.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// From each particle; nothing from those outside of the group.
    pub taken: Vec<Vec3>,
    /// The group of the temperature.
    pub group: GroupId,
    /// Components that are taken away whole.
    pub whole: [bool; 3],
    /// Particles that are left out together with their degrees of freedom; empty: none.
    pub apart: Vec<bool>,
}

/// The two motions of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Of the centre of mass.
    Linear,
    /// Rotation about it.
    Angular,
}

/// What an act may use.
pub struct ActCx<'a> {
    /// What it changes.
    pub world: &'a mut World,
    /// Values of variables, computes and fixes.
    pub values: &'a mut dyn Values,
    /// The whole line, for messages.
    pub span: Span,
    /// Lines for screen and log, as `Created 64 atoms`.
    pub lines: &'a mut Vec<String>,
    /// Declaring lines that a file held, with its text: executed right after the act.
    pub then: &'a mut Vec<(Command, Arc<Source>)>,
    /// Warnings.
    pub notes: &'a RefCell<Diagnostics>,
}

/// The refusal of a value that would put something other than numbers into a scene: whose, which, of which particle.
pub fn no_number(of: impl std::fmt::Display, value: f64, tag: Option<u32>, at: Span) -> Diagnostic {
    let particle = tag.map_or(String::new(), |tag| format!(" for particle {tag}"));
    Diagnostic::error(Code::NOT_FINITE, at, format!("`{of}` is {value}{particle}"))
        .help("its formula goes beyond the largest number, or takes the difference of two such values")
}

impl ActCx<'_> {
    /// Writes a line to screen and log.
    pub fn print(&mut self, line: impl Into<String>) {
        self.lines.push(line.into());
    }

    /// Leaves a warning or note.
    pub fn note(&self, d: Diagnostic) {
        self.notes.borrow_mut().push(d.at(self.span));
    }

    /// The value of a parameter now.
    ///
    /// # Errors
    /// As `Values::scalar`, and a value that is no number.
    pub fn number(&mut self, p: &Param) -> Result<f64> {
        match p {
            Param::Number(a) => Ok(*a),
            Param::Ref(r) => {
                let value = self.values.scalar(self.world, r)?;
                if value.is_nan() { Err(no_number(r, value, None, r.span).into()) } else { Ok(value) }
            }
        }
    }

    /// The value of a parameter for each particle now.
    ///
    /// # Errors
    /// As `Values::per_atom`.
    pub fn per_atom(&mut self, p: &Param) -> Result<Vec<f64>> {
        match p {
            Param::Number(a) => Ok(vec![*a; self.world.n()]),
            Param::Ref(r) => self.values.per_atom(self.world, r),
        }
    }

    /// As [`ActCx::per_atom`], of which the values of these particles (places) go into the scene; formulas need not hold for others.
    ///
    /// # Errors
    /// As `Values::per_atom`, and a value of one of them that is no finite number.
    pub fn per_atom_of(&mut self, p: &Param, chosen: &[usize]) -> Result<Vec<f64>> {
        let values = self.per_atom(p)?;
        let tag = |i: usize| self.world.particles.tag.get(i).copied();
        match (p, chosen.iter().find(|&&i| !values[i].is_finite())) {
            (Param::Ref(r), Some(&i)) => Err(no_number(r, values[i], tag(i), r.span).into()),
            _ => Ok(values),
        }
    }
}
