//! What styles may know while a line of the deck is read, and what acts may use while they act.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail, nearest};
use perigrain_base::memory;
use perigrain_lang::{Param, RefKind, ValueRef, Word};
use perigrain_world::{Compat, GroupId, Key, Offers, Region, World};
use std::cell::RefCell;

use super::Wants;

/// The word of one value of a range, and what reads it.
const BYTES_PER_VALUE: f64 = 200.0;

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
    /// A dump.
    Dump,
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
    /// Length of the global vector; 0 for none, [`Shape::OPEN`] if only a run determines it.
    pub vector: usize,
    /// Columns of the global array; 0 for none.
    pub array: usize,
    /// Rows of the global array, if it has one; [`Shape::OPEN`] if only a run determines them.
    pub array_rows: usize,
    /// Columns of local values (of pairs, bonds …); 0 for none, 1 is a local vector.
    pub local: usize,
    /// Columns per particle; `Some(1)` is a per-atom vector.
    pub atom: Option<usize>,
    /// The number grows with the scene: `thermo_modify norm yes` divides it by the number of particles.
    pub scalar_extensive: bool,
    /// The global vector grows with the scene.
    pub vector_extensive: bool,
    /// The global array grows with the scene.
    pub array_extensive: bool,
    /// The values are new at multiples of this step only; 0 and 1: at every step.
    pub every: i64,
    /// It is a variable that commands and fixes may set (style internal).
    pub settable: bool,
    /// It is a temperature that takes a flow away first.
    pub flow: bool,
    /// Its values number particles into chunks.
    pub chunks: Option<Chunking>,
}

/// What chunks of particles have besides particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Chunking {
    /// Coordinates of each.
    pub coordinates: usize,
    /// Chunks without particles are left out: each has an original number.
    pub compressed: bool,
    /// They are counted once (`nchunk once`).
    pub fixed: bool,
    /// They are layers along axes: `bin/1d`, `bin/2d`, `bin/3d`.
    pub bins: Option<Bins>,
}

/// Chunks that are layers, pencils or boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bins {
    /// The axis of each coordinate, in the order of the line; the last of them varies fastest.
    pub axes: [Option<usize>; 3],
    /// Coordinates are fractions of the box.
    pub reduced: bool,
}

impl Shape {
    /// Whether a global value (element k, row and column) grows with the scene.
    pub fn extensive(&self, index: &[usize]) -> bool {
        [self.scalar_extensive, self.vector_extensive, self.array_extensive][index.len().min(2)]
    }

    /// A length that only a run determines, and that may change from step to step.
    pub const OPEN: usize = usize::MAX;

    /// The kinds of values, for the slot.
    pub fn offers(&self) -> Offers {
        Offers {
            scalar: self.scalar,
            vector: self.vector > 0,
            array: self.array > 0,
            atom: self.atom.is_some(),
            local: self.local > 0,
        }
    }
}

/// What has been declared so far, by name.
pub trait Names {
    /// The values a compute offers.
    fn compute(&self, id: &str) -> Option<Shape>;
    /// The style of a compute.
    fn compute_style(&self, _id: &str) -> Option<&'static str> {
        None
    }
    /// What the elements of a compute's vector are, where that has names.
    fn elements(&self, _id: &str) -> Vec<String> {
        vec![]
    }
    /// The values a fix offers.
    fn fix(&self, id: &str) -> Option<Shape>;
    /// The values a variable offers: one per particle of atom style, a vector, else one number.
    fn variable_shape(&self, name: &str) -> Option<Shape>;
    /// Whether a variable that does not exist yet is defined somewhere in the deck, and this line may wait for it.
    fn defined_later(&self, _name: &str) -> bool {
        false
    }
    /// Whether a variable is atom-style (`Some(true)`), any other style (`Some(false)`), or absent.
    fn variable(&self, name: &str) -> Option<bool> {
        self.variable_shape(name).map(|s| s.atom.is_some())
    }
    /// Whether this global value of a compute or fix grows with the number of particles (`thermo_modify norm`).
    fn extensive(&self, r: &ValueRef) -> bool {
        let shape = match r.kind {
            RefKind::Compute => self.compute(&r.name),
            RefKind::Fix => self.fix(&r.name),
            _ => None,
        };
        shape.is_some_and(|s| match r.index.len() {
            0 => s.scalar_extensive,
            1 => s.vector_extensive,
            _ => s.array_extensive,
        })
    }
    /// The style of a fix.
    fn fix_style(&self, _id: &str) -> Option<&'static str> {
        None
    }
    /// The first fix that relies on consecutive steps, and its style.
    fn counting_fix(&self, _w: &World) -> Option<(&str, &'static str)> {
        None
    }
    /// The first dump that has written snapshots into a file that keeps growing.
    fn growing_dump(&self) -> Option<&str> {
        None
    }
    /// The pair style in force and its sub-styles.
    fn pair_styles(&self) -> Vec<&'static str> {
        vec![]
    }
    /// The coefficients that `fix adapt` may change of a pair style (or bond style) in force; `None` where there is no such style.
    fn coefficients(&self, _bond: bool, _style: &str) -> Option<&'static [&'static str]> {
        None
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

    /// Names a fault of LAMMPS that this line has under `compat`; `mended`: the LAMMPS of 2026 has it no more.
    pub fn fault(&self, span: Span, fault: &str, mended: bool) {
        let compat = self.world.settings.compat;
        if !compat.lammps() {
            return;
        }
        let name = if mended { compat.name() } else { "lammps" };
        self.note(match mended && compat != Compat::Lammps2025 {
            false => Diagnostic::note(Code::COMPAT, span, format!("compat {name}: {fault}")),
            true => Diagnostic::note(
                Code::COMPAT,
                span,
                format!("LAMMPS 22Jul2025 has {fault}; {name} has not"),
            )
            .help("where the LAMMPS that is compared with is older than 2026, write `-compat lammps/2025`"),
        });
    }

    /// Records that this line uses a name.
    pub fn uses(&self, kind: UseKind, name: &str) {
        self.uses.borrow_mut().push(Use { kind, name: name.to_string() });
    }

    /// Checks that no fix, compute or dump in force needs what is about to be deleted.
    ///
    /// # Errors
    /// One of them does.
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
            Diagnostic::error(Code::UNKNOWN_GROUP, word.span, format!("there is no group `{}`", word.text));
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
        if let Some(r) = self.world.regions.look_up(&word.text) {
            self.uses(UseKind::Region, &word.text);
            return Ok(r);
        }
        let d =
            Diagnostic::error(Code::UNKNOWN_REGION, word.span, format!("there is no region `{}`", word.text));
        Err(match nearest(&word.text, self.world.regions.keys().map(Key::text)) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("define it before this line with `region ID style …`"),
        }
        .into())
    }

    /// Checks that a value reference names something that exists and offers the requested kind of value: a per-particle value
    /// where `per_atom`, else one number.
    ///
    /// # Errors
    /// Unknown names, missing or superfluous indices.
    pub fn value(&self, r: &ValueRef, per_atom: bool) -> Result<()> {
        self.reading(r, if per_atom { Wants::PerAtom } else { Wants::Number })
    }

    /// As `value`, for any kind of value.
    ///
    /// # Errors
    /// As `value`.
    pub fn reading(&self, r: &ValueRef, wants: Wants) -> Result<()> {
        let (kind, what) = kind_of(r);
        let Some(shape) = self.shape(r) else {
            if r.kind == RefKind::Variable && self.names.defined_later(&r.name) {
                // What it offers is seen when the run is sealed.
                self.uses(kind, &r.name);
                return Ok(());
            }
            let known = self.names.all(kind);
            let text = format!("there is no {what} `{}`", r.name);
            let mut d = Diagnostic::error(Code::unknown(what), r.span, text);
            if let Some(n) = nearest(&r.name, known.iter().map(String::as_str)) {
                d = d.help(format!("did you mean `{n}`?"));
            }
            return Err(d.into());
        };
        self.uses(kind, &r.name);
        check_index(r, what, &shape, wants)
    }

    /// The values of what a reference names, if it exists.
    pub fn shape(&self, r: &ValueRef) -> Option<Shape> {
        match r.kind {
            RefKind::Variable => self.names.variable_shape(&r.name),
            RefKind::Compute | RefKind::ComputeAtom => self.names.compute(&r.name),
            RefKind::Fix | RefKind::FixAtom => self.names.fix(&r.name),
        }
    }

    /// The words that a reference with a wildcard stands for, as `c_ID[*]` or `f_ID[2*4]`: one for each element of a vector where
    /// one number is wanted, else one for each column. Any other word stands for itself.
    ///
    /// # Errors
    /// Bounds outside the vector or array, and lengths that only a run determines.
    pub fn expand(&self, word: &Word, wants: Wants) -> Result<Vec<Word>> {
        let whole = || Ok(vec![word.clone()]);
        let Some((head, rest)) = word.text.split_once('[') else { return whole() };
        let Some((range, tail)) = rest.split_once(']') else { return whole() };
        let (Some((lo, hi)), Ok(Some(r))) = (range.split_once('*'), ValueRef::parse(head, word.span)) else {
            return whole();
        };
        let Some(shape) = self.shape(&r) else { return whole() };
        let all = match wants {
            Wants::Number if tail.is_empty() => shape.vector,
            Wants::Number => shape.array_rows,
            Wants::PerAtom => shape.atom.unwrap_or(0),
            Wants::Vector => shape.array,
            Wants::Local => shape.local,
        };
        let bound = |text: &str, default| if text.is_empty() { Ok(default) } else { text.parse::<usize>() };
        let wrong = |text: String| fail(Code::BAD_VALUE, word.span, text);
        let (Ok(lo), Ok(hi)) = (bound(lo, 1), bound(hi, all)) else {
            return wrong(format!("`{range}` is no range such as `2*4`"));
        };
        if hi == Shape::OPEN {
            return wrong(format!(
                "how many values `{head}` has is only known in a run: give the last one, as `[1*4]`"
            ));
        }
        // A single column is named without an index, and a value without columns is the reader's error to report.
        if all == 0 || (all == 1 && wants != Wants::Number) {
            return Ok(vec![Word { text: format!("{head}{tail}"), ..word.clone() }]);
        }
        if lo < 1 || lo > hi || hi > all {
            return wrong(format!("`{range}` is no range from 1 to {all}"));
        }
        if let Some(d) = memory::lacking((hi - lo) as f64 * BYTES_PER_VALUE, &format!("`{range}`")) {
            return Err(d.at(word.span).into());
        }
        Ok((lo..=hi).map(|k| Word { text: format!("{head}[{k}]{tail}"), ..word.clone() }).collect())
    }

    /// As `value` for a number or a reference.
    ///
    /// # Errors
    /// As `value`.
    pub fn param(&self, p: &Param, per_atom: bool) -> Result<()> {
        match p {
            Param::Number(_) => Ok(()),
            // An atom-style parameter may be an equal-style variable: the same number for all particles.
            Param::Ref(r) if per_atom && r.kind == RefKind::Variable => {
                self.value(r, self.names.variable(&r.name).unwrap_or(true))
            }
            Param::Ref(r) => self.value(r, per_atom),
        }
    }
}

/// What a reference names, as a kind and as a word.
fn kind_of(r: &ValueRef) -> (UseKind, &'static str) {
    match r.kind {
        RefKind::Variable => (UseKind::Variable, "variable"),
        RefKind::Compute | RefKind::ComputeAtom => (UseKind::Compute, "compute"),
        RefKind::Fix | RefKind::FixAtom => (UseKind::Fix, "fix"),
    }
}

fn check_index(r: &ValueRef, what: &str, shape: &Shape, wants: Wants) -> Result<()> {
    match wants {
        Wants::Number => check_number(r, what, shape),
        Wants::PerAtom => {
            check_columns(r, what, shape.atom.unwrap_or(0), "per-atom values", "value per atom")
        }
        Wants::Local => check_columns(r, what, shape.local, "local values", "local value each"),
        Wants::Vector => check_vector(r, what, shape),
    }
}

/// A column of values that there are many of.
fn check_columns(r: &ValueRef, what: &str, columns: usize, values: &str, one: &str) -> Result<()> {
    let wrong = |text: String| fail(Code::WRONG_KIND, r.span, text);
    let name = &r.name;
    match (columns, r.index.as_slice()) {
        (0, _) => wrong(format!("{what} `{name}` has no {values}")),
        (1, []) => Ok(()),
        (1, [_]) => wrong(format!("{what} `{name}` has one {one}: write it without an index")),
        (c, []) => wrong(format!("{what} `{name}` has {c} columns: choose one, as `[1]`")),
        (c, [k]) if *k >= 1 && *k <= c => Ok(()),
        (c, _) => wrong(format!("{what} `{name}` has columns 1 to {c}")),
    }
}

/// A whole vector, or a column of an array.
fn check_vector(r: &ValueRef, what: &str, shape: &Shape) -> Result<()> {
    let wrong = |text: String| fail(Code::WRONG_KIND, r.span, text);
    let name = &r.name;
    match r.index.as_slice() {
        [] if shape.vector > 0 => Ok(()),
        [] if shape.array > 0 => {
            wrong(format!("{what} `{name}` has an array of {} columns: choose one, as `[1]`", shape.array))
        }
        [] => wrong(format!("{what} `{name}` has no global vector")),
        [k] if *k >= 1 && *k <= shape.array => Ok(()),
        [_] if shape.array > 0 => {
            wrong(format!("the array of {what} `{name}` has columns 1 to {}", shape.array))
        }
        [_] if shape.vector > 0 => {
            wrong(format!("{what} `{name}` has a vector and no array: write it without an index"))
        }
        _ => wrong(format!("{what} `{name}` has no global array")),
    }
}

/// A single number.
fn check_number(r: &ValueRef, what: &str, shape: &Shape) -> Result<()> {
    let wrong = |text: String| fail(Code::WRONG_KIND, r.span, text);
    let name = &r.name;
    match r.index.as_slice() {
        [] if shape.scalar => Ok(()),
        [] if shape.vector > 0 && shape.vector < Shape::OPEN => wrong(format!(
            "{what} `{name}` has no single value here: choose one of {}, as `[1]`",
            shape.vector
        )),
        [] if shape.array > 0 => {
            wrong(format!("{what} `{name}` has no single value here: give row and column, as `[1][1]`"))
        }
        [] => wrong(format!("{what} `{name}` has no single value here")),
        [k] if *k >= 1 && *k <= shape.vector => Ok(()),
        [_] if shape.vector > 0 => {
            wrong(format!("the vector of {what} `{name}` has elements 1 to {}", shape.vector))
        }
        [i, j] if *i >= 1 && *j >= 1 && *i <= shape.array_rows && *j <= shape.array => Ok(()),
        [_, _] if shape.array > 0 && shape.array_rows < Shape::OPEN => wrong(format!(
            "the array of {what} `{name}` has rows 1 to {} and columns 1 to {}",
            shape.array_rows, shape.array
        )),
        [_, _] if shape.array > 0 => {
            wrong(format!("the array of {what} `{name}` has columns 1 to {}", shape.array))
        }
        [_] if shape.array > 0 => {
            wrong(format!("{what} `{name}` has an array: give row and column, as `[1][1]`"))
        }
        [_, _] => wrong(format!("{what} `{name}` has no global array")),
        _ => wrong(format!("{what} `{name}` has no global vector")),
    }
}
