//! compute contact/atom: number of contacts of each sphere.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::touching;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, FAMILIES, KIND, MASK, MOLECULE, RADIUS, TAG, X, X0};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct ContactAtom;

impl Style for ContactAtom {
    fn name(&self) -> &'static str {
        "contact/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Number of spheres that each particle touches.",
            text: "Per-atom vector: how many particles are no further away than the sum of both radii; 0 \
                   outside the group. Pairs that `neigh_modify exclude` takes away do not count, contacts with walls neither. \
                   Cohesive contacts that hold across a gap are none here. Unlike LAMMPS it needs no pair style.",
            example: "compute touching all contact/atom",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Particles of this group count, all without it.
    #[word(name = "group2")]
    among: Option<GroupId>,
}

impl ComputeStyle for ContactAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        super::need_spheres("compute contact/atom", cx)?;
        let among = read::<Line>(args, cx)?.among.unwrap_or(GroupId::ALL);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, among }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    among: GroupId,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, among) = (self.group.bit(), self.among.bit());
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | RADIUS | MASK | BONDS | BOX | FAMILIES | TAG | MOLECULE | KIND | X0,
            move |w, _, out| {
                let mask = &w.particles.mask;
                let counts = |i: usize, j: usize| mask[i] & group != 0 && mask[j] & among != 0;
                out.cols = 1;
                out.atom.clear();
                out.atom.resize(w.n(), 0.0);
                for pair in touching(w, &|i, j| counts(i, j) || counts(j, i)) {
                    for (i, j) in [(pair.i, pair.j), (pair.j, pair.i)] {
                        out.atom[i as usize] += f64::from(u8::from(counts(i as usize, j as usize)));
                    }
                }
                Ok(())
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn spheres_that_touch() {
        let style = AtomStyle { sphere: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.9, 0.0], [5.0; 3]]);
        b.world.particles.radius.fill(0.5);
        let c = b.compute(&ContactAtom, "").unwrap();
        // The first two touch at a single point, which counts as contact.
        assert_eq!(b.evaluate(&*c).unwrap().atom, [1.0, 2.0, 1.0, 0.0]);
        b.world.settings.neighbor.exclude_types.push((1, 1));
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0; 4]);
        assert!(b.compute(&ContactAtom, "missing").is_err());
        b.world.particles.style.sphere = false;
        assert!(b.compute(&ContactAtom, "").is_err());
    }
}
