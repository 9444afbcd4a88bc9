//! Computes cluster/atom, fragment/atom and aggregate/atom: connected sets of particles.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_neigh::list::Reach;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::{Clusters, held_together, within};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, FAMILIES, KIND, MASK, MOLECULE, RADIUS, TAG, X};
use perigrain_world::{GroupId, SlotId};

/// `compute … cluster/atom`.
pub struct ClusterAtom;

/// `compute … fragment/atom`.
pub struct FragmentAtom;

/// `compute … aggregate/atom`.
pub struct AggregateAtom;

impl Style for ClusterAtom {
    fn name(&self) -> &'static str {
        "cluster/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Within::GRAMMAR),
            summary: "Clusters of particles that are close to each other.",
            text: "Per-atom vector: two particles of the group closer than the cutoff belong to one cluster; \
                   its number is the smallest id in it. 0 outside the group. Numbers are far apart: give them to \
                   `compute chunk/atom … compress yes` to count clusters. Unlike LAMMPS it needs no pair style, and the \
                   cutoff may be longer than that of forces.",
            example: "compute c all cluster/atom 1.5",
        }
    }
}

impl Style for FragmentAtom {
    fn name(&self) -> &'static str {
        "fragment/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Fragments: particles that bonds hold together.",
            text: "Per-atom vector: two particles of the group with an unbroken bond between them belong to one fragment; its \
                   number is the smallest id in it. A particle without any such bond has 0; 0 outside the group. Bonds are those of molecules, turned off or not, as in LAMMPS, and in addition those of \
                   peridynamic bodies, which are there from the first run on. With \
                   `compute chunk/atom c_ID compress yes` fragments can be counted, weighed and followed.",
            example: "compute f all fragment/atom single yes",
        }
    }
}

impl Style for AggregateAtom {
    fn name(&self) -> &'static str {
        "aggregate/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Within::GRAMMAR),
            summary: "Clusters of particles that are close to each other or bonded.",
            text: "Per-atom vector as that of compute cluster/atom, but unbroken peridynamic bonds hold particles together, \
                   too, and so do the bonds of molecules.",
            example: "compute a all aggregate/atom 1.5",
        }
    }
}

#[derive(Words)]
struct Within {
    /// The cutoff [distance].
    #[word(positive)]
    cutoff: f64,
}

#[derive(Words)]
struct Line {
    /// A particle without any bond has its own id, not 0.
    #[word(keyword, default = false)]
    single: bool,
}

impl ComputeStyle for ClusterAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let cutoff = Some(read::<Within>(args, cx)?.cutoff);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, cutoff, bonds: false, single: true }))
    }
}

impl ComputeStyle for AggregateAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let cutoff = Some(read::<Within>(args, cx)?.cutoff);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, cutoff, bonds: true, single: true }))
    }
}

impl ComputeStyle for FragmentAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { single } = read(args, cx)?;
        let style = cx.world.particles.style;
        if !(style.peri || style.bonded) {
            let text = "fragment/atom needs particles with bonds";
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, text)
                .help("`atom_style peri` or `bond` have them; `compute cluster/atom` looks at distances")
                .into());
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, cutoff: None, bonds: true, single }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Distance within which particles belong to one cluster.
    cutoff: Option<f64>,
    /// Whether bonds connect particles.
    bonds: bool,
    /// Whether a single particle counts as a fragment.
    single: bool,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | MASK | FAMILIES | BONDS | BOX | TAG | MOLECULE | RADIUS | KIND,
            move |w, _, out| {
                let p = &w.particles;
                let of = |i: usize| p.mask[i] & me.group.bit() != 0;
                let mut clusters = Clusters::new(&p.tag);
                let mut bonded = vec![me.single; w.n()];
                if let Some(cutoff) = me.cutoff {
                    let near = within(w, Reach::Fixed(cutoff), &|i, j| of(i) && of(j));
                    near.iter().for_each(|pair| clusters.join(pair.i, pair.j));
                }
                if me.bonds {
                    held_together(w, |i, j| {
                        if of(i as usize) && of(j as usize) {
                            clusters.join(i, j);
                            (bonded[i as usize], bonded[j as usize]) = (true, true);
                        }
                    });
                }
                out.cols = 1;
                out.atom.clear();
                out.atom.extend((0..w.n()).map(|i| if of(i) && bonded[i] { clusters.name(i) } else { 0.0 }));
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
    fn clusters_across_faces() {
        let places = [[-9.8, 0.0, 0.0], [0.0; 3], [9.9, 0.0, 0.0], [0.9, 0.0, 0.0], [9.5, 0.2, 0.0]];
        let mut b = Bench::new(AtomStyle::default(), &places);
        let c = b.compute(&ClusterAtom, "1.0").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [1.0, 2.0, 1.0, 2.0, 1.0]);
        b.world.particles.mask[0] = 0;
        assert_eq!(b.evaluate(&*c).unwrap().atom, [0.0, 2.0, 3.0, 2.0, 3.0]);
        assert!(b.compute(&ClusterAtom, "0").is_err() && b.compute(&FragmentAtom, "").is_err());
    }
}
