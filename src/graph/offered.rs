//! What the slots of computes and fixes offer to references in formulas.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{RefKind, Value, ValueRef};
use perigrain_world::{SlotId, World};

/// What a slot offers to a reference in a formula.
pub(super) fn from_slot(w: &World, slot: SlotId, r: &ValueRef) -> Result<Value> {
    let s = w.slots.get(slot);
    let missing = || fail(Code::WRONG_KIND, r.span, format!("`{r}` has no such value"));
    let per_particle = matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom);
    if per_particle {
        let (tag, c) = match r.index.as_slice() {
            [tag] => (*tag, 0),
            [tag, c] => (*tag, c - 1),
            _ => return missing(),
        };
        let Some(i) = u32::try_from(tag).ok().and_then(|t| w.particles.index_of(t)) else {
            return fail(Code::UNKNOWN_NAME, r.span, format!("there is no particle {tag}"));
        };
        return if c < s.cols { Ok(Value::Number(s.atom_value(i, c))) } else { missing() };
    }
    let atom = |c: usize| Value::Atom((0..w.n()).map(|i| s.atom_value(i, c)).collect());
    let number = |a: Option<f64>| a.map_or_else(missing, |a| Ok(Value::Number(a)));
    let o = s.offers;
    match r.index.as_slice() {
        [] if o.scalar => Ok(Value::Number(s.scalar)),
        [] if o.vector => Ok(Value::Vector(s.vector.clone())),
        [] if o.atom && s.cols == 1 => Ok(atom(0)),
        [k] if o.vector => number(s.vector.get(k - 1).copied()),
        [k] if o.array && *k <= s.array_cols => Ok(Value::Vector(s.array_column(k - 1))),
        [k] if o.atom && s.cols > 1 && *k <= s.cols => Ok(atom(k - 1)),
        [i, j] if o.array => number(s.cell(i - 1, j - 1)),
        _ => missing(),
    }
}

/// What a slot offers to a formula of particles, such as the contacts of a wall that has a force as a whole too.
pub(super) fn of_particles(w: &World, slot: SlotId, r: &ValueRef) -> Result<Value> {
    let s = w.slots.get(slot);
    let column = match r.index.as_slice() {
        [] if s.cols == 1 => 0,
        [k] if s.cols > 1 && (1..=s.cols).contains(k) => k - 1,
        _ => return only_particles(from_slot(w, slot, r)?, r),
    };
    let per_particle = matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom);
    if per_particle || !s.offers.atom {
        return only_particles(from_slot(w, slot, r)?, r);
    }
    Ok(Value::Atom((0..w.n()).map(|i| s.atom_value(i, column)).collect()))
}

/// Refuses, as LAMMPS does, what is not there for each particle; `C_ID[7]` is one particle's value on purpose.
fn only_particles(value: Value, r: &ValueRef) -> Result<Value> {
    if matches!(value, Value::Atom(_)) || matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom) {
        return Ok(value);
    }
    let text = format!("`{r}` is {}: a formula of particles takes values per particle here", value.kind());
    Err(by_variable(Diagnostic::error(Code::WRONG_KIND, r.span, text), r).into())
}

/// Explains how a single number gets into a formula of many.
fn by_variable(d: Diagnostic, r: &ValueRef) -> Diagnostic {
    d.help(format!("write `variable NAME equal {r}` and put `v_NAME` into this formula"))
}

/// The whole vector of a slot.
pub(super) fn whole_vector(w: &World, slot: SlotId, r: &ValueRef) -> Result<Value> {
    let s = w.slots.get(slot);
    match r.index.as_slice() {
        [] if s.offers.vector => Ok(Value::Vector(s.vector.clone())),
        [k] if s.offers.array && *k <= s.array_cols => Ok(Value::Vector(s.array_column(k - 1))),
        [] if s.offers.atom => Ok(Value::Atom(vec![])),
        _ => {
            let text = format!("`{r}` is no global vector and no column of a global array");
            let d = Diagnostic::error(Code::WRONG_KIND, r.span, text);
            Err(if s.offers.scalar && r.index.is_empty() { by_variable(d, r) } else { d }.into())
        }
    }
}
