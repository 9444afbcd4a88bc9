//! compute pressure: pressure and pressure tensor from kinetic energy and virial.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{BOX, TALLY};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct Pressure;

impl Style for Pressure {
    fn name(&self) -> &'static str {
        "pressure"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pressure of the whole box and its tensor.",
            text: "Scalar (intensive), in pressure units: P = (dof k_B T + W_xx + W_yy + W_zz) / (3 V), with T and dof of \
                   compute temp-ID, the virial W of all pairs and bonds, and the volume V of the present box (area and 2 instead \
                   of 3 in two dimensions). Vector of 6: xx yy zz xy xz yz of (Σ m v_a v_b + W_ab) / V. Without terms all \
                   count, with terms only those named; those that no style of the scene has are 0. The group is `all`. For peridynamic particles the virial carries one factor of volume, as in LAMMPS.",
            example: "compute p all pressure thermo_temp virial",
        }
    }
}

#[derive(Words)]
struct Line {
    /// A temperature compute, for the kinetic term; `NULL` where `ke` does not count.
    #[word(
        name = "temp-ID",
        what = "the ID of a temperature compute, or NULL",
        kind = Kind::OrNull(&Kind::Compute)
    )]
    temp: Word,
    #[word(name = "term", what = "keyword of compute pressure")]
    terms: Vec<Term>,
}

/// A term of a pressure or stress.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(refused = "pair/hybrid")]
pub(super) enum Term {
    /// The kinetic term.
    Ke,
    /// Pairs.
    Pair,
    /// Bonds.
    Bond,
    /// What `fix_modify ID virial yes` adds.
    Fix,
    /// All but `ke`.
    Virial,
    /// Nothing, as no style has it.
    Angle,
    /// Nothing, as no style has it.
    Dihedral,
    /// Nothing, as no style has it.
    Improper,
    /// Nothing, as no style has it.
    Kspace,
}

impl ComputeStyle for Pressure {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if cx.group != GroupId::ALL {
            return fail(Code::BAD_VALUE, cx.span, "compute pressure must use the group `all`");
        }
        let Line { temp, terms } = read(args, cx)?;
        let (ke, parts) = Term::chosen(&terms);
        let temperature = if ke { Some(temperature(&temp, cx)?) } else { None };
        Ok(Box::new(Declared { id: cx.id.to_string(), temperature, parts }))
    }
}

impl Term {
    /// What the named terms are, or all if none is named: the kinetic term and the parts of the virial.
    pub fn chosen(named: &[Self]) -> (bool, Parts) {
        let has = |term| named.is_empty() || named.contains(&term);
        let part = |term| has(term) || has(Term::Virial);
        (has(Term::Ke), Parts { pair: part(Term::Pair), bond: part(Term::Bond), fix: part(Term::Fix) })
    }
}

/// The temperature compute named by a word.
///
/// # Errors
/// `NULL`, unknown names and other computes.
pub(super) fn temperature(word: &Word, cx: &BuildCx) -> Result<ValueRef> {
    if word.text == "NULL" {
        return Err(Diagnostic::error(
            Code::WRONG_KIND,
            word.span,
            "the kinetic part of a pressure needs a temperature compute, not NULL",
        )
        .help("name one, as `thermo_temp`, or leave the kinetic part out with the keyword `virial`")
        .into());
    }
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    // A pressure also has six components.
    let other = cx.names.compute_style(&r.name).is_some_and(|s| !s.starts_with("temp"));
    match cx.names.compute(&r.name) {
        Some(s) if s.vector != 6 || other => {
            fail(Code::WRONG_KIND, word.span, format!("compute `{}` is no temperature", r.name))
        }
        _ => Ok(r),
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    temperature: Option<ValueRef>,
    parts: Parts,
}

/// Selected parts of the virial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    /// Pairs.
    pub pair: bool,
    /// Bonds.
    pub bond: bool,
    /// Fixes.
    pub fix: bool,
}

impl Parts {
    /// Whether any part is selected.
    pub fn any(self) -> bool {
        self.pair || self.bond || self.fix
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 6, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let parts = self.parts;
        if parts.any() {
            cx.request_virial(when);
        }
        let kinetic = match &self.temperature {
            Some(r) => Some((cx.value(r, stage, when)?, r.clone())),
            None => None,
        };
        Ok(fill(&self.id, &Wanted { slot, stage, when }, TALLY | BOX, move |w, t, out| {
            let virial = if parts.any() { virial(w, t.step, parts)? } else { [0.0; 6] };
            let (trace, tensor) = match &kinetic {
                Some((reading, r)) => kinetic_part(w, reading, r)?,
                None => (0.0, [0.0; 6]),
            };
            let lengths = w.domain()?.lengths();
            let flat = w.settings.two_dimensional;
            let volume = if flat { lengths[0] * lengths[1] } else { lengths[0] * lengths[1] * lengths[2] };
            let (inverse, nktv2p) = (1.0 / volume, w.settings.units.constants().nktv2p);
            let diagonal = if flat { virial[0] + virial[1] } else { virial[0] + virial[1] + virial[2] };
            out.scalar = (trace + diagonal) / if flat { 2.0 } else { 3.0 } * inverse * nktv2p;
            out.vector.clear();
            out.vector.extend((0..6).map(|k| (tensor[k] + virial[k]) * inverse * nktv2p));
            if flat {
                [2, 4, 5].iter().for_each(|&k| out.vector[k] = 0.0);
            }
            Ok(())
        }))
    }

    fn take_temperature(&mut self, temperature: &ValueRef) {
        if self.temperature.is_some() {
            self.temperature = Some(temperature.clone());
        }
    }

    fn tallied(&self) -> bool {
        true
    }
}

fn virial(w: &World, step: i64, parts: Parts) -> Result<[f64; 6]> {
    let tally = &w.tally;
    let part = |yes: bool, v: [f64; 6]| if yes { v } else { [0.0; 6] };
    match tally.step {
        None => Ok([0.0; 6]),
        Some(s) if s == step && tally.with_virial => {
            let (pairs, bonds) = (part(parts.pair, tally.virial), part(parts.bond, tally.bond_virial));
            let fixes = part(parts.fix, tally.fixes);
            Ok(std::array::from_fn(|k| pairs[k] + bonds[k] + fixes[k]))
        }
        Some(_) => fail(Code::WRONG_ORDER, None, format!("the virial is not known at step {step}")),
    }
}

/// dof k_B T and Σ m v_a v_b from a temperature's slot.
fn kinetic_part(w: &World, reading: &Reading, r: &ValueRef) -> Result<(f64, [f64; 6])> {
    if let Reading::Scalar(slot) = reading {
        let slot = w.slots.get(*slot);
        if let (Some(&dof), Some(&tensor)) = (slot.inner.first(), slot.vector.first_chunk::<6>()) {
            return Ok((dof * w.settings.units.constants().boltz * slot.scalar, tensor));
        }
    }
    fail(Code::WRONG_KIND, r.span, format!("compute `{}` is no temperature", r.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.tally.clear(0, true, false, 3);
        b.world.tally.virial = [8.0, 16.0, 24.0, 32.0, 40.0, 48.0];
        let s = b.world.slots.id("c_t");
        let slot = b.world.slots.get_mut(s);
        (slot.scalar, slot.inner, slot.vector) = (4.0, vec![6.0], vec![2.0, 8.0, 14.0, 4.0, 0.0, 0.0]);
        b.computes.insert("t".into(), Shape { scalar: true, vector: 6, ..Shape::default() });
        b
    }

    // The box holds 8000; dof k_B T = 24 and the trace of the virial 48, by hand.
    #[test]
    fn kinetic_and_virial_parts() {
        let mut b = scene();
        for (words, p, xx) in
            [("t", 72.0, 10.0), ("t ke", 24.0, 2.0), ("NULL virial", 48.0, 8.0), ("NULL fix", 0.0, 0.0)]
        {
            let c = b.compute(&Pressure, words).unwrap();
            let slot = b.evaluate(&*c).unwrap();
            assert!((slot.scalar - p / 24000.0).abs() < 1e-18, "{words}");
            assert!((slot.vector[0] - xx / 8000.0).abs() < 1e-18, "{words}");
        }
    }

    #[test]
    fn the_kinetic_part_needs_a_temperature() {
        let b = scene();
        for words in ["NULL", "NULL ke", "u", "", "t pairs", "t pair/hybrid lj"] {
            assert!(b.compute(&Pressure, words).is_err(), "{words}");
        }
    }
}
