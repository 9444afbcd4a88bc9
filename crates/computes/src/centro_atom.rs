//! compute centro/atom: deviation of each particle's neighbourhood from inversion symmetry.

use super::rdf::reach;
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_lang::Args;
use perigrain_neigh::list::{Reach, difference};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::near::within;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Kind, Or, Syntax, Value, Whole, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BONDS, BOX, FAMILIES, KIND, MASK, MOLECULE, RADIUS, TAG, X};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct CentroAtom;

impl Style for CentroAtom {
    fn name(&self) -> &'static str {
        "centro/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Centro-symmetry of each particle's neighbourhood.",
            text: "Per-atom vector in distance² units: of the N nearest neighbours, |R_i + R_j|² of all pairs, of which \
                   the N/2 smallest are added up (Kelchner, Plimpton & Hamilton, Phys. Rev. B 58, 1998, 11085): 0 on an undisturbed \
                   lattice, large at surfaces and defects; 0 outside the group and for particles with fewer than N neighbours within the cutoff of \
                   forces (see compute rdf). Neighbours belong to any group.\n\n\
                   The unit vectors of `axes yes` point along the lines through the two neighbours of the \
                   most symmetric pair and of the next one (from the neighbour that is further back in the order of ids), and across both.",
            example: "pair_style zero 2.0\npair_coeff * *\ncompute c all centro/atom 6",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of neighbours, even.
    #[word(name = "N")]
    neighbours: At<Or<Lattice, Count>>,
    /// An array of 10 columns in place of the vector: the parameter and three unit vectors.
    #[word(keyword, what = "axes", default = false)]
    axes: bool,
}

/// A lattice, for its number of neighbours.
#[derive(Clone, Copy, Words)]
enum Lattice {
    /// 12 neighbours.
    Fcc,
    /// 8 neighbours.
    Bcc,
}

/// A number of neighbours.
#[derive(Clone, Copy)]
struct Count(usize);

impl Value for Count {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        <usize as Whole>::from(args, 2, "`fcc`, `bcc` or the number of neighbours").map(Self)
    }
}

impl ComputeStyle for CentroAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { neighbours: At { value, span: at, .. }, axes } = read(args, cx)?;
        let neighbours = match value {
            Or::Word(Lattice::Fcc) => 12,
            Or::Word(Lattice::Bcc) => 8,
            Or::Else(Count(n)) => n,
        };
        if neighbours % 2 != 0 || neighbours > MOST {
            let text = format!("the number of neighbours must be even and at most {MOST}");
            return fail(Code::BAD_VALUE, at, text);
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, neighbours, axes }))
    }
}

/// A larger number of neighbours is refused: the cost is quadratic in it.
const MOST: usize = 1000;

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    neighbours: usize,
    axes: bool,
}

impl Declared {
    /// The parameter and, with `axes`, the three axes, from the neighbours of a particle: ids and relative
    /// positions.
    fn measure(&self, mut around: Vec<(u32, Vec3)>) -> Vec<f64> {
        let columns = if self.axes { 10 } else { 1 };
        if around.len() < self.neighbours {
            return vec![0.0; columns];
        }
        around.sort_by(|a, b| dot(a.1, a.1).total_cmp(&dot(b.1, b.1)).then(a.0.cmp(&b.0)));
        around.truncate(self.neighbours);
        around.sort_by_key(|a| a.0);
        let mut pairs = vec![];
        for (k, (_, a)) in around.iter().enumerate() {
            for (_, b) in &around[k + 1..] {
                let s = add(*a, *b);
                pairs.push((dot(s, s), sub(*a, *b)));
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut row = vec![pairs[..self.neighbours / 2].iter().map(|p| p.0).sum()];
        if self.axes {
            let [first, second] = [pairs[0].1, pairs.get(1).map_or([0.0; 3], |p| p.1)].map(unit);
            [first, second, unit(cross(first, second))].iter().for_each(|axis| row.extend(axis));
        }
        row
    }
}

fn unit(a: Vec3) -> Vec3 {
    let l = length(a);
    if l > 0.0 { scale(1.0 / l, a) } else { a }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(if self.axes { 10 } else { 1 }), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, at) = (self.clone(), cx.span());
        let cutoff = reach(&self.id, None, at, cx)?;
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | MASK | BOX | BONDS | FAMILIES | TAG | MOLECULE | RADIUS | KIND,
            move |w, _, out| {
                let (p, period) = (&w.particles, w.periods());
                let of = |i: usize| p.mask[i] & me.group.bit() != 0;
                let mut around: Vec<Vec<(u32, Vec3)>> = vec![vec![]; w.n()];
                for pair in within(w, Reach::Fixed(cutoff), &|i, j| of(i) || of(j)) {
                    let (i, j, d) = (pair.i as usize, pair.j as usize, difference(&p.x, &period, &pair));
                    around[i].push((p.tag[j], scale(-1.0, d)));
                    around[j].push((p.tag[i], d));
                }
                out.cols = if me.axes { 10 } else { 1 };
                out.atom.clear();
                for (i, around) in around.into_iter().enumerate() {
                    let around = if of(i) { around } else { vec![] };
                    out.atom.extend(me.measure(around));
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
    fn a_cross_with_one_arm_bent() {
        let b = Bench::new(AtomStyle::default(), &[]);
        let c = Declared { id: "c".into(), group: GroupId::ALL, neighbours: 4, axes: true };
        let around = vec![
            (4, [0.0, -1.0, 0.0]),
            (2, [1.0, 0.0, 0.0]),
            (3, [-1.1, 0.0, 0.0]),
            (7, [0.0, 1.0, 0.0]),
            (5, [0.0, 0.0, 3.0]),
        ];
        let row = c.measure(around.clone());
        // By hand: 0 from the vertical pair, 0.1² from the other; the fifth is too far away.
        assert!((row[0] - 0.01).abs() < 1e-15);
        assert_eq!(row[1..], [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(c.measure(around[..3].to_vec()), [0.0; 10]);
        for words in ["", "hcp", "3", "0", "fcc axes", "8 axis yes", "2000"] {
            assert!(b.compute(&CentroAtom, words).is_err(), "{words}");
        }
        // No pair style.
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        let c = b.compute(&CentroAtom, "fcc").unwrap();
        assert!(b.evaluate(&*c).is_err());
    }
}
