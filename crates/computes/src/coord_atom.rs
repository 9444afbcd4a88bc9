//! compute coord/atom: number of neighbours of each particle.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_neigh::list::Reach;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::{one_image, within};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Syntax, Types, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, FAMILIES, KIND, MASK, MOLECULE, RADIUS, TAG, X};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct CoordAtom;

impl Style for CoordAtom {
    fn name(&self) -> &'static str {
        "coord/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Coordination number: neighbours of each particle within a distance.",
            text: "How many particles are closer than R; 0 outside the group. Per-atom vector \
                   without types or with one, with several a column for each. Unlike LAMMPS \
                   it needs no pair style, and R may be longer than the cutoff of forces (up to half a periodic length).",
            example: "compute n all coord/atom cutoff 1.5",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(what = "`cutoff`")]
    method: Method,
    /// Neighbours belong to this group, to any without it.
    among: Among,
    /// Neighbours are of this type, or of one in this range such as `2*3`.
    #[word(name = "type")]
    types: Vec<Types>,
}

/// What a neighbour is.
#[derive(Words)]
enum Method {
    /// All within a distance.
    Cutoff(#[word(name = "R", what = "the cutoff", positive)] f64),
}

#[derive(Words)]
struct Among {
    #[word(keyword, name = "group2")]
    group: Option<GroupId>,
}

impl ComputeStyle for CoordAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        if let Some(word) = args.peek().filter(|word| word.text == "orientorder") {
            let text = "the style `orientorder` of compute coord/atom is not in perigrain: use `cutoff`";
            return fail(Code::NOT_SUPPORTED, word.span, text);
        }
        let Line { method: Method::Cutoff(cutoff), among, types } = read(args, cx)?;
        let among = among.group.unwrap_or(GroupId::ALL);
        let mut types: Vec<_> = types.into_iter().map(|Types(first, last)| (first, last)).collect();
        if types.is_empty() {
            types.push((1, u16::MAX));
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, cutoff, among, types }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    cutoff: f64,
    among: GroupId,
    /// Range of types counted in each column, both ends included.
    types: Vec<(u16, u16)>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(self.types.len()), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let at = cx.span();
        one_image(cx.world(), self.cutoff, at)?;
        let me = self.clone();
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | KIND | MASK | BONDS | BOX | FAMILIES | TAG | MOLECULE | RADIUS,
            move |w, _, out| {
                let p = &w.particles;
                let has = |i: usize, g: GroupId| p.mask[i] & g.bit() != 0;
                let counts = |i: usize, j: usize| has(i, me.group) && has(j, me.among);
                let near = within(w, Reach::Fixed(me.cutoff), &|i, j| counts(i, j) || counts(j, i));
                let columns = me.types.len();
                out.cols = columns;
                out.atom.clear();
                out.atom.resize(columns * w.n(), 0.0);
                for pair in near {
                    let (i, j) = (pair.i as usize, pair.j as usize);
                    for (i, j) in [(i, j), (j, i)] {
                        for (c, (lo, hi)) in me.types.iter().enumerate() {
                            if counts(i, j) && (*lo..=*hi).contains(&p.kind[j]) {
                                out.atom[i * columns + c] += 1.0;
                            }
                        }
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
    fn neighbours_by_type() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0; 3]]);
        b.world.types = 2;
        b.world.particles.kind[2] = 2;
        let c = b.compute(&CoordAtom, "cutoff 1.2 * 2").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [2.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        let c = b.compute(&CoordAtom, "cutoff 1.5").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().atom, [2.0, 2.0, 2.0, 0.0]);
        for words in
            ["", "cutoff", "orientorder q 0.5", "cutoff 0", "cutoff 1 3", "cutoff 1 group no", "radius 1"]
        {
            assert!(b.compute(&CoordAtom, words).is_err(), "{words}");
        }
    }
}
