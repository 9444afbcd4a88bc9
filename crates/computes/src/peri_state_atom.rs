//! compute peri/state/atom: stress, plastic strain and damage of particles under correspondence.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_lang::Args;
use perigrain_peri::kinematics::von_mises;
use perigrain_peri::stress::State;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{FAMILIES, MASK, SITES};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct PeriStateAtom;

impl Style for PeriStateAtom {
    fn name(&self) -> &'static str {
        "peri/state/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Stress, plastic strain and damage of each particle under pair_style peri/cauchy.",
            text: "Per-atom vector of the one quantity, or an array with a column for each. They are of the latest force evaluation; 0 \
                   before the first run, for particles without a family, and outside the group. Needs `pair_style peri/cauchy`.",
            example: "material copper E 1.17e11 nu 0.35 rho 8930 yield 4.0e8\npair_style peri/cauchy\n\
                      pair_coeff * * material copper horizon 2.015\ncompute a all peri/state/atom mises plastic damage",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "quantity", least = 1)]
    quantities: Vec<Quantity>,
}

/// A quantity of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "quantity of a particle")]
enum Quantity {
    /// Von Mises' equivalent of the Kirchhoff stress τ = PFᵀ, which yield stresses limit [pressure].
    Mises,
    /// Equivalent plastic strain.
    Plastic,
    /// Damage of the material, from 0 to 1; 1 where the family is torn.
    Damage,
}

impl Quantity {
    fn of(self, state: &State) -> f64 {
        match self {
            Self::Mises => von_mises(&state.stress),
            Self::Plastic => state.memory.strain,
            Self::Damage if state.torn => 1.0,
            Self::Damage => state.memory.damage,
        }
    }
}

impl ComputeStyle for PeriStateAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { quantities } = read(args, cx)?;
        super::need_bonds(self.name(), cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, span: cx.span, quantities }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    span: Span,
    quantities: Vec<Quantity>,
}

/// Refuses scenes whose pair style has no stress of its own.
///
/// # Errors
/// `pair_style peri/cauchy` is not in force.
pub(super) fn need_stress(id: &str, span: Span, cx: &dyn SealCx) -> Result<()> {
    if cx.pair_styles().contains(&"peri/cauchy") {
        return Ok(());
    }
    let text = format!("compute `{id}`: no pair style in force has a stress of its own");
    Err(Diagnostic::error(Code::CONFLICT, span, text).help("it goes with pair_style peri/cauchy").into())
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.quantities.len()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        need_stress(&self.id, self.span, cx)?;
        let (bit, quantities) = (self.group.bit(), self.quantities.clone());
        Ok(fill(&self.id, &Wanted { slot, stage, when }, FAMILIES | SITES | MASK, move |w, _, out| {
            out.cols = quantities.len();
            out.atom.clear();
            out.atom.resize(out.cols * w.n(), 0.0);
            let Some(families) = &*w.families else { return Ok(()) };
            let rows = out.atom.chunks_exact_mut(out.cols).zip(w.particles.mask.iter());
            for (i, (row, _)) in rows.enumerate().filter(|(_, (_, mask))| **mask & bit != 0) {
                let Some(state) = families.state(i) else { continue };
                row.iter_mut().zip(&quantities).for_each(|(out, q)| *out = q.of(&state));
            }
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // Values are tested in tests/peri/cauchy.rs.
    #[test]
    fn mistakes() {
        let b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        assert!(b.compute(&PeriStateAtom, "mises plastic damage").is_ok());
        assert!(b.compute(&PeriStateAtom, "").is_err() && b.compute(&PeriStateAtom, "tresca").is_err());
        let bare = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        assert!(bare.compute(&PeriStateAtom, "mises").is_err());
    }
}
