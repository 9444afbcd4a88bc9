//! compute count/type: number of particles or bonds of each type.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, KIND, MASK, TAG};
use perigrain_world::index::Index;
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct CountType;

impl Style for CountType {
    fn name(&self) -> &'static str {
        "count/type"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "How many particles, or bonds, of each type there are.",
            text: "Global vector (intensive), a number for each type of particles or bonds. Bonds that have broken are gone, so that the scalar of `bond`, LAMMPS' number \
                   of bonds of type 0, is 0.",
            example: "compute kinds all count/type atom\nvariable grains equal c_kinds[2]",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "kind", what = "what is counted: atom or bond")]
    counted: At<Counted>,
}

/// What is counted.
#[derive(PartialEq, Words)]
#[word(refused = "angle dihedral improper")]
enum Counted {
    /// The particles of the group.
    Atom,
    /// The bonds with both ends in the group, those among them that `delete_bonds` has turned off.
    Bond,
}

impl ComputeStyle for CountType {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let At { value: counted, span, .. } = read::<Line>(args, cx)?.counted;
        let bonds = counted == Counted::Bond;
        if bonds && !cx.world.particles.style.bonded {
            let d = Diagnostic::error(Code::INCOMPLETE, span, "this atom style has no bonds");
            return Err(d.help("`atom_style bond` or `bpm/sphere`, alone or in a hybrid, has them").into());
        }
        let types = if bonds { cx.world.bonds.types } else { cx.world.types };
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, bonds, types }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Whether bonds are counted instead of particles.
    bonds: bool,
    types: usize,
}

impl Declared {
    /// The numbers of particles by type.
    fn particles(&self, w: &World, counts: &mut [f64]) {
        let p = &w.particles;
        for (kind, _) in p.kind.iter().zip(&*p.mask).filter(|(_, mask)| *mask & self.group.bit() != 0) {
            counts[usize::from(*kind) - 1] += 1.0;
        }
    }

    /// The numbers of bonds by type, including bonds that are switched off.
    fn bonds(&self, w: &World, counts: &mut [f64]) {
        let (tags, mask) = (&w.particles.tag, &w.particles.mask);
        let index = Index::new(tags);
        let inside = |tag: &u32| index.find(*tag, tags).is_some_and(|i| mask[i] & self.group.bit() != 0);
        for bond in w.bonds.list.iter().filter(|b| b.kind != 0 && b.ends.iter().all(inside)) {
            counts[bond.kind.unsigned_abs() as usize - 1] += 1.0;
        }
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { vector: self.types, scalar: self.bonds, ..Shape::default() }
    }

    fn op(&self, _: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        let reads = if me.bonds { BONDS | TAG | MASK } else { KIND | MASK };
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            out.vector.clear();
            out.vector.resize(me.types, 0.0);
            if me.bonds {
                out.scalar = 0.0;
                me.bonds(w, &mut out.vector);
            } else {
                me.particles(w, &mut out.vector);
            }
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Bond};

    #[test]
    fn particles_and_bonds_by_type_of_a_group() {
        let style = AtomStyle { bonded: true, molecules: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3]; 4]);
        (b.world.types, b.world.bonds.types) = (3, 2);
        b.world.particles.kind = vec![1, 3, 3, 3].into();
        for (kind, ends) in [(1, [1, 2]), (2, [3, 2]), (-2, [1, 3]), (1, [2, 4])] {
            b.world.bonds.push(Bond::new(kind, ends));
        }
        b.world.particles.mask[3] = 0;
        let mut counts = |words: &str| {
            let compute = b.compute(&CountType, words).unwrap();
            b.evaluate(&*compute).unwrap().vector.clone()
        };
        assert_eq!(counts("atom"), [1.0, 0.0, 2.0]);
        assert_eq!(counts("bond"), [1.0, 2.0]);
        for words in ["", "angle", "atoms", "atom 1"] {
            assert!(b.compute(&CountType, words).is_err(), "{words}");
        }
    }
}
