//! What styles may know while a line of the deck is read, and what acts may use while they act.

use crate::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail, nearest};
use crate::lang::{Param, RefKind, ValueRef, Word};
use crate::world::{GroupId, Region, World};
use std::cell::RefCell;

/// What kind of thing a line refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UseKind {
    /// A group.
    Group,
    /// A region.
    Region,
    /// A compute.
    Compute,
    /// A fix.
    Fix,
    /// A variable.
    Variable,
    /// A material.
    Material,
}

/// An edge of the graph: this line uses that name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Use {
    /// What kind of thing.
    pub kind: UseKind,
    /// Its ID.
    pub name: String,
}

/// Which values a compute, fix or variable offers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// A single number.
    pub scalar: bool,
    /// Length of the global vector; 0 for none.
    pub vector: usize,
    /// Columns per particle; `Some(1)` is a per-atom vector.
    pub atom: Option<usize>,
    /// The number grows with the scene: `thermo_modify norm yes` divides it by the number of particles.
    pub scalar_extensive: bool,
    /// The global vector grows with the scene.
    pub vector_extensive: bool,
}

/// What has been declared so far, by name.
pub trait Names {
    /// The values a compute offers.
    fn compute(&self, id: &str) -> Option<Shape>;
    /// The values a fix offers.
    fn fix(&self, id: &str) -> Option<Shape>;
    /// Whether a variable is atom-style (`Some(true)`), any other style (`Some(false)`), or absent.
    fn variable(&self, name: &str) -> Option<bool>;
    /// Whether this global value of a compute or fix grows with the number of particles (`thermo_modify norm`).
    fn extensive(&self, r: &ValueRef) -> bool {
        let shape = match r.kind {
            RefKind::Compute => self.compute(&r.name),
            RefKind::Fix => self.fix(&r.name),
            _ => None,
        };
        shape.is_some_and(|s| if r.index.is_empty() { s.scalar_extensive } else { s.vector_extensive })
    }
    /// The fixes, computes and dumps in force that use a name, as `fix ball`.
    fn users(&self, _name: &Use) -> Vec<String> {
        vec![]
    }
    /// All names of a kind, for "did you mean".
    fn all(&self, kind: UseKind) -> Vec<String>;
}

/// What a style may know while its line is read.
pub struct BuildCx<'a> {
    /// The world so far; in `perigrain check` it holds no particles.
    pub world: &'a World,
    /// What has been declared.
    pub names: &'a dyn Names,
    /// The ID given in the line (fix, compute, dump, region …); empty where there is none.
    pub id: &'a str,
    /// The group given in the line (fix, compute, dump); `all` where there is none.
    pub group: GroupId,
    /// The whole line.
    pub span: Span,
    /// Reading only: files need not exist, particles are not there.
    pub checking: bool,
    /// Warnings and notes of this line.
    pub notes: &'a RefCell<Diagnostics>,
    /// Names this line uses.
    pub uses: &'a RefCell<Vec<Use>>,
}

impl BuildCx<'_> {
    /// Leaves a warning or note.
    pub fn note(&self, d: Diagnostic) {
        self.notes.borrow_mut().push(d.at(self.span));
    }

    /// Records that this line uses a name.
    pub fn uses(&self, kind: UseKind, name: &str) {
        self.uses.borrow_mut().push(Use { kind, name: name.to_string() });
    }

    /// Checks that no fix, compute or dump in force needs what is about to be deleted.
    ///
    /// # Errors
    /// Somebody does.
    pub fn unused(&self, kind: UseKind, word: &Word) -> Result<()> {
        let users = self.names.users(&Use { kind, name: word.text.clone() });
        if users.is_empty() {
            return Ok(());
        }
        let text = format!("`{}` is still used by {}", word.text, users.join(", "));
        Err(Diagnostic::error(Code::CONFLICT, word.span, text).help("delete those first").into())
    }

    /// The group a word names.
    ///
    /// # Errors
    /// An unknown group, with the nearest known one.
    pub fn group(&self, word: &Word) -> Result<GroupId> {
        if let Some(g) = self.world.groups.find(&word.text) {
            self.uses(UseKind::Group, &word.text);
            return Ok(g);
        }
        let mut d =
            Diagnostic::error(Code::UNKNOWN_NAME, word.span, format!("there is no group `{}`", word.text));
        d = match nearest(&word.text, self.world.groups.names()) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("define it before this line with `group ID …`"),
        };
        Err(d.into())
    }

    /// The region a word names.
    ///
    /// # Errors
    /// An unknown region, with the nearest known one.
    pub fn region(&self, word: &Word) -> Result<&Region> {
        if let Some(r) = self.world.regions.get(&word.text) {
            self.uses(UseKind::Region, &word.text);
            return Ok(r);
        }
        let d =
            Diagnostic::error(Code::UNKNOWN_NAME, word.span, format!("there is no region `{}`", word.text));
        Err(match nearest(&word.text, self.world.regions.keys().map(String::as_str)) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("define it before this line with `region ID style …`"),
        }
        .into())
    }

    /// Checks that a value reference names something that exists and offers what is asked of it:
    /// a per-particle value where `per_atom`, else one number.
    ///
    /// # Errors
    /// Unknown names, missing or superfluous indices.
    pub fn value(&self, r: &ValueRef, per_atom: bool) -> Result<()> {
        let (kind, what) = match r.kind {
            RefKind::Variable => (UseKind::Variable, "variable"),
            RefKind::Compute | RefKind::ComputeAtom => (UseKind::Compute, "compute"),
            RefKind::Fix | RefKind::FixAtom => (UseKind::Fix, "fix"),
        };
        let shape = match r.kind {
            RefKind::Variable => self.names.variable(&r.name).map(|atom| Shape {
                scalar: !atom,
                atom: atom.then_some(1),
                ..Shape::default()
            }),
            RefKind::Compute | RefKind::ComputeAtom => self.names.compute(&r.name),
            RefKind::Fix | RefKind::FixAtom => self.names.fix(&r.name),
        };
        let Some(shape) = shape else {
            let known = self.names.all(kind);
            let mut d =
                Diagnostic::error(Code::UNKNOWN_NAME, r.span, format!("there is no {what} `{}`", r.name));
            if let Some(n) = nearest(&r.name, known.iter().map(String::as_str)) {
                d = d.help(format!("did you mean `{n}`?"));
            }
            return Err(d.into());
        };
        self.uses(kind, &r.name);
        check_index(r, what, shape, per_atom)
    }

    /// As `value` for a number or a reference.
    ///
    /// # Errors
    /// As `value`.
    pub fn param(&self, p: &Param, per_atom: bool) -> Result<()> {
        match p {
            Param::Number(_) => Ok(()),
            // An atom-style parameter may be an equal-style variable: the same number for everyone.
            Param::Ref(r) if per_atom && r.kind == RefKind::Variable => {
                self.value(r, self.names.variable(&r.name).unwrap_or(true))
            }
            Param::Ref(r) => self.value(r, per_atom),
        }
    }
}

fn check_index(r: &ValueRef, what: &str, shape: Shape, per_atom: bool) -> Result<()> {
    let wrong = |text: String| fail(Code::WRONG_KIND, r.span, text);
    let name = &r.name;
    if per_atom {
        return match (shape.atom, r.index.as_slice()) {
            (None, _) => wrong(format!("{what} `{name}` has no per-atom values")),
            (Some(1), []) => Ok(()),
            (Some(1), [_]) => {
                wrong(format!("{what} `{name}` has one value per atom: write it without an index"))
            }
            (Some(c), []) => wrong(format!("{what} `{name}` has {c} columns: say which, as `[1]`")),
            (Some(c), [k]) if *k >= 1 && *k <= c => Ok(()),
            (Some(c), _) => wrong(format!("{what} `{name}` has columns 1 to {c}")),
        };
    }
    match r.index.as_slice() {
        [] if shape.scalar => Ok(()),
        [] => wrong(format!("{what} `{name}` has no single value here")),
        [k] if *k >= 1 && *k <= shape.vector => Ok(()),
        [_] if shape.vector > 0 => {
            wrong(format!("the vector of {what} `{name}` has elements 1 to {}", shape.vector))
        }
        _ => wrong(format!("{what} `{name}` has no global vector")),
    }
}

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
    pub said: &'a mut Vec<String>,
    /// Warnings.
    pub notes: &'a RefCell<Diagnostics>,
}

impl ActCx<'_> {
    /// Says a line on screen and log.
    pub fn say(&mut self, line: impl Into<String>) {
        self.said.push(line.into());
    }

    /// Leaves a warning or note.
    pub fn note(&self, d: Diagnostic) {
        self.notes.borrow_mut().push(d.at(self.span));
    }

    /// The value of a parameter now.
    ///
    /// # Errors
    /// As `Values::scalar`.
    pub fn number(&mut self, p: &Param) -> Result<f64> {
        match p {
            Param::Number(a) => Ok(*a),
            Param::Ref(r) => self.values.scalar(self.world, r),
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
}
