//! compute nbond/atom: number of bonds of each particle.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};

use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::words::{BondType, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, MASK, TAG};
use perigrain_world::index::Index;
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct NbondAtom;

impl Style for NbondAtom {
    fn name(&self) -> &'static str {
        "nbond/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "How many bonds each particle has.",
            text: "Per-atom vector: the bonds of which a particle is an end; those that have broken or are turned off \
                   (`delete_bonds`) do not count. 0 outside the group; the other end may be outside. Bonds of `pair_style peri/…` are \
                   another matter: `compute damage/atom` counts them.",
            example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\n\
                      bond_style harmonic\nbond_coeff 1 50.0 1.0\nfix 1 all nve\ncompute n all nbond/atom\n\
                      compute most all reduce max c_n\nthermo_style custom step c_most\nrun 10",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Only bonds of this type count.
    #[word(keyword = "bond/type", name = "T")]
    kind: Option<BondType>,
}

impl ComputeStyle for NbondAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if !cx.world.particles.style.bonded {
            let text = "compute nbond/atom needs an atom style with bonds";
            let d = Diagnostic::error(Code::INCOMPLETE, cx.span, text);
            return Err(d.help("`atom_style bond` or `bpm/sphere`, alone or in a hybrid, has them").into());
        }
        let Line { kind } = read(args, cx)?;
        let kind = kind.map(|BondType(kind)| i32::from(kind));
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, kind }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// The bond type counted; `None` for all.
    kind: Option<i32>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, kind) = (self.group, self.kind);
        Ok(fill(&self.id, &Wanted { slot, stage, when }, BONDS | TAG | MASK, move |w, _, out| {
            let tags = &w.particles.tag;
            let (index, mut counts) = (Index::new(tags), vec![0.0; w.n()]);
            let counted = |kind_of: i32| kind.map_or(kind_of > 0, |kind| kind_of == kind);
            for bond in w.bonds.list.iter().filter(|b| counted(b.kind)) {
                for i in bond.ends.iter().filter_map(|t| index.find(*t, tags)) {
                    counts[i] += 1.0;
                }
            }
            per_particle(w, group, out, |i| counts[i]);
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
    fn counts_both_ends_of_living_bonds() {
        let style = AtomStyle { bonded: true, molecules: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3]; 4]);
        b.world.bonds.types = 2;
        for (kind, ends) in [(1, [1, 2]), (2, [3, 2]), (-1, [3, 4]), (1, [2, 4])] {
            b.world.bonds.push(Bond::new(kind, ends));
        }
        b.world.particles.mask[3] = 0;
        let mut counts = |words: &str| {
            let compute = b.compute(&NbondAtom, words).unwrap();
            b.evaluate(&*compute).unwrap().atom.clone()
        };
        assert_eq!(counts(""), [1.0, 3.0, 1.0, 0.0]);
        assert_eq!(counts("bond/type 2"), [0.0, 1.0, 1.0, 0.0]);
        assert_eq!(b.compute(&NbondAtom, "bond/type 3").err().unwrap().0[0].code, Code::BAD_VALUE);
    }
}
