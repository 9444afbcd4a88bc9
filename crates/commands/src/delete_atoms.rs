//! `delete_atoms`: takes particles away.

use super::create_atoms::subset::{Amount, Subset};
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::rng::Marsaglia;
use perigrain_base::stop;
use perigrain_lang::{Args, Param};
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::words::{At, AtomVariable, Fraction, MarsagliaSeed, Nullable, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{Domain, GroupId, Particles, Region};
use std::collections::BTreeSet;

/// The command.
pub struct DeleteAtoms;

impl Style for DeleteAtoms {
    fn name(&self) -> &'static str {
        "delete_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Deletes the particles of a group or region, or those too near to others.",
            text: "As in LAMMPS the last particle moves into the hole. Peridynamic bonds of deleted particles are gone; of other \
                   bonds, one that has lost one end is an error of the next run. Where particles have bonds, ids stay (LAMMPS \
                   ignores `compress yes` then).",
            example: "delete_atoms region notch",
        }
    }
}

#[derive(Words)]
#[word(refused = "condense")]
struct Line {
    #[word(name = "style")]
    choice: Choice,
    /// Ids become storage order + 1 afterwards.
    #[word(keyword, what = "compress", default = true)]
    compress: bool,
    /// Bonds of deleted particles go, too.
    #[word(keyword, what = "bond", placed, shown = "no")]
    bond: Option<At<bool>>,
    /// Whole molecules go.
    #[word(keyword, what = "mol", placed, shown = "no")]
    mol: Option<At<bool>>,
}

/// The options of a line.
#[derive(Clone, Copy)]
struct How {
    compress: bool,
    /// Bonds of deleted particles go, too.
    bond: bool,
    /// Whole molecules go.
    mol: bool,
}

#[derive(Words)]
#[word(what = "style of delete_atoms", style)]
enum Choice {
    /// The particles of a group.
    Group(#[word(name = "ID")] GroupId),
    /// The particles inside a region.
    Region(#[word(name = "ID")] Region),
    /// Those for which an atom-style variable is not zero.
    Variable(#[word(name = "NAME")] AtomVariable),
    /// Goes through the particles of the first group in order and deletes each that is nearer than D to a particle of the second one
    /// that is still there.
    Overlap {
        #[word(name = "D", what = "the distance", positive)]
        cutoff: At<f64>,
        #[word(name = "ID")]
        first: GroupId,
        #[word(name = "ID")]
        second: GroupId,
    },
    /// A part of the particles of a group inside a region, the ones that LAMMPS deletes.
    Random(Random),
}

/// A random part of the particles of a group inside a region.
#[derive(Words)]
struct Random {
    #[word(name = "amount")]
    amount: Share,
    /// Whether the amount is exact, and an error if there are fewer, or about right.
    #[word(name = "exact", what = "exactness")]
    exact: bool,
    #[word(name = "GROUP")]
    group: GroupId,
    #[word(name = "REGION")]
    region: Nullable<Region>,
    #[word(name = "SEED")]
    seed: MarsagliaSeed,
}

#[derive(Words)]
#[word(what = "random style")]
enum Share {
    /// A part of them.
    Fraction(#[word(name = "P")] At<Fraction>),
    /// So many of them, or all if there are fewer.
    Count(#[word(name = "N", what = "the number of particles", from = 0)] At<i64>),
}

impl Share {
    /// The amount, and where it stands.
    fn amount(&self) -> (Amount, Span) {
        match self {
            Self::Fraction(part) => (Amount::Ratio(part.value.0), part.span),
            Self::Count(number) => (Amount::Count(number.value), number.span),
        }
    }
}

impl CommandStyle for DeleteAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let domain = common::domain(cx)?;
        if let Some(word) = a.peek().filter(|word| word.text == "porosity") {
            let text = "LAMMPS has no `delete_atoms porosity` any more";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
            return Err(d.help("write `delete_atoms random fraction P no GROUP REGION SEED`").into());
        }
        let Line { choice, compress, bond, mol } = read(a, cx)?;
        if let Choice::Overlap { cutoff, .. } = &choice {
            let heights = domain.edges().heights();
            if (0..3).any(|d| domain.periodic()[d] && cutoff.value > heights[d]) {
                let text = "the distance is longer than a periodic edge of the box";
                return fail(Code::BAD_VALUE, cutoff.span, text);
            }
        }
        let style = cx.world.particles.style;
        let bond = goes("bond", bond, style.bonded)?;
        let mol = goes("mol", mol, style.molecules)?;
        let how = How { compress, bond, mol };
        Ok(on_particles(vec![], move |cx| delete(cx, &choice, how)))
    }
}

/// Whether a keyword says `yes`, which needs particles that have what it is about.
fn goes(name: &str, given: Option<At<bool>>, there: bool) -> Result<bool> {
    match given {
        Some(At { value: true, span, .. }) if !there => {
            fail(Code::CONFLICT, span, format!("`{name} yes` needs an atom style with bonds"))
        }
        given => Ok(given.is_some_and(|given| given.value)),
    }
}

fn delete(cx: &mut ActCx, choice: &Choice, how: How) -> Result<()> {
    let mut marked: Vec<bool> = match choice {
        Choice::Group(g) => cx.world.particles.mask.iter().map(|m| m & g.bit() != 0).collect(),
        Choice::Region(r) => cx.world.particles.x.iter().map(|&x| r.contains(x)).collect(),
        Choice::Variable(AtomVariable(r)) => {
            cx.per_atom(&Param::Ref(r.clone()))?.into_iter().map(|v| v != 0.0).collect::<Vec<_>>()
        }
        Choice::Random(random) => drawn(cx, random)?,
        Choice::Overlap { cutoff, first, second } => {
            common::settle(cx.world);
            let domain = cx.world.domain()?;
            overlapping(&cx.world.particles, domain, cutoff.value, *first, *second)
        }
    };
    if how.mol {
        whole_molecules(&cx.world.particles, &mut marked);
    }
    let (before, bonds) = (cx.world.n(), cx.world.bonds.len());
    if how.bond || how.mol {
        let p = &cx.world.particles;
        let gone: BTreeSet<u32> = (0..p.len()).filter(|&i| marked[i]).map(|i| p.tag[i]).collect();
        cx.world.bonds.retain(|b| !b.ends.iter().any(|t| gone.contains(t)));
    }
    // Ids of bonded scenes stay as they are, as in LAMMPS.
    cx.world.delete(&marked, how.compress && !cx.world.particles.style.bonded);
    cx.world.forget_touches();
    cx.world.bonds.left = 0;
    let now = cx.world.n();
    cx.print(format!("Deleted {} atoms, new total = {now}", before - now));
    if (how.bond || how.mol) && bonds > 0 {
        let left = cx.world.bonds.len();
        cx.print(format!("Deleted {} bonds, new total = {left}", bonds - left));
    }
    Ok(())
}

/// Marks all of each molecule of which a particle is marked; molecule 0 is none.
fn whole_molecules(p: &Particles, marked: &mut [bool]) {
    let hit: BTreeSet<u32> =
        (0..p.len()).filter(|&i| marked[i] && p.molecule[i] != 0).map(|i| p.molecule[i]).collect();
    marked.iter_mut().zip(&p.molecule).for_each(|(m, id)| *m |= hit.contains(id));
}

/// Marks the particles that the random stream chooses.
fn drawn(cx: &mut ActCx, r: &Random) -> Result<Vec<bool>> {
    let p = &cx.world.particles;
    let meant = |i: &usize| {
        p.mask[*i] & r.group.bit() != 0 && r.region.0.as_ref().is_none_or(|g| g.contains(p.x[*i]))
    };
    let eligible: Vec<usize> = (0..p.len()).filter(meant).collect();
    let mut marked = vec![false; p.len()];
    let (amount, span) = r.amount.amount();
    let chosen = match amount {
        Amount::Ratio(fraction) if !r.exact => {
            let mut stream = Marsaglia::new(r.seed.0);
            eligible.into_iter().filter(|_| stream.uniform() <= fraction).collect()
        }
        Amount::Count(n) if n > eligible.len() as i64 && !r.exact => {
            let text = format!("only {} particles can be deleted, not {n}", eligible.len());
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text));
            eligible
        }
        amount => Subset { amount, seed: r.seed.0, span }.of(eligible)?,
    };
    chosen.into_iter().for_each(|i| marked[i] = true);
    Ok(marked)
}

/// Marks each particle of the first group that is too near to one of the second that is not marked yet;
/// of two images of one pair across a periodic face the smaller id goes.
fn overlapping(p: &Particles, domain: &Domain, cutoff: f64, first: GroupId, second: GroupId) -> Vec<bool> {
    let cells = Cells::new(domain, &p.x, cutoff);
    let is = |i: usize, g: GroupId| p.mask[i] & g.bit() != 0;
    let mut marked = vec![false; p.len()];
    for i in (0..p.len()).filter(|&i| is(i, first)) {
        if stop::cuts_at(i) {
            break;
        }
        marked[i] = cells.any_near(p.x[i], |j, y, image| {
            let apart = (0..3).map(|d| (p.x[i][d] - y[d]).powi(2)).sum::<f64>();
            if (j == i && !image) || apart >= cutoff * cutoff || !is(j, second) {
                return false;
            }
            if !image {
                return !marked[j];
            }
            !(is(i, second) && is(j, first) && p.tag[i] > p.tag[j])
        });
    }
    marked
}

/// Particles by cells of the upright box between whose layers there is the cutoff at least.
struct Cells<'a> {
    x: &'a [[f64; 3]],
    domain: &'a Domain,
    lo: [f64; 3],
    size: [f64; 3],
    count: [usize; 3],
    /// Particles of cell `c` are `members[starts[c]..starts[c + 1]]`.
    starts: Vec<usize>,
    members: Vec<usize>,
}

impl<'a> Cells<'a> {
    fn new(domain: &'a Domain, x: &'a [[f64; 3]], cutoff: f64) -> Self {
        let periodic = domain.periodic();
        let upright: Vec<[f64; 3]> = x.iter().map(|x| domain.upright(x)).collect();
        let extent = |d: usize, start: f64, pick: fn(f64, f64) -> f64| {
            upright.iter().fold(start, |m, x| pick(m, x[d]))
        };
        // Faces of a leaning box are nearer to each other than its edges are long.
        let (edges, heights) = (domain.lengths(), domain.edges().heights());
        let nearer = |d: usize| heights[d] / edges[d];
        let lo =
            [0, 1, 2].map(|d| if periodic[d] { domain.lo[d] } else { extent(d, domain.lo[d], f64::min) });
        let hi =
            [0, 1, 2].map(|d| if periodic[d] { domain.hi[d] } else { extent(d, domain.hi[d], f64::max) });
        // No more cells along an edge than particles can fill in the mean.
        let most = (x.len() as f64).cbrt().ceil().max(1.0);
        let count =
            [0, 1, 2].map(|d| ((hi[d] - lo[d]) * nearer(d) / cutoff).floor().clamp(1.0, most) as usize);
        let size = [0, 1, 2].map(|d| (hi[d] - lo[d]) / count[d] as f64);
        let mut cells = Self { x, domain, lo, size, count, starts: vec![], members: vec![] };
        let place: Vec<usize> = upright.iter().map(|&x| cells.index(cells.cell(x))).collect();
        cells.members = (0..x.len()).collect();
        cells.members.sort_by_key(|&i| place[i]);
        let total = count.iter().product::<usize>();
        cells.starts = (0..=total).map(|c| cells.members.partition_point(|&i| place[i] < c)).collect();
        cells
    }

    fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        [0, 1, 2].map(|d| (((x[d] - self.lo[d]) / self.size[d]).max(0.0) as usize).min(self.count[d] - 1))
    }

    fn index(&self, c: [usize; 3]) -> usize {
        (c[2] * self.count[1] + c[1]) * self.count[0] + c[0]
    }

    /// Whether `test` (particle, its place or that of its image, whether it is an image) holds for one nearby.
    fn any_near(&self, x: [f64; 3], mut test: impl FnMut(usize, [f64; 3], bool) -> bool) -> bool {
        let here = self.cell(self.domain.upright(&x));
        let (edges, periodic) = (self.domain.edges(), self.domain.periodic());
        (0..27).any(|k| {
            let (mut cell, mut turns) = ([0; 3], [0.0; 3]);
            for d in 0..3 {
                let c = here[d] as i64 + [k % 3, k / 3 % 3, k / 9][d] - 1;
                let n = self.count[d] as i64;
                if (0..n).contains(&c) {
                    cell[d] = c as usize;
                } else if periodic[d] {
                    (cell[d], turns[d]) = (c.rem_euclid(n) as usize, c.div_euclid(n) as f64);
                } else {
                    return false;
                }
            }
            let (image, shift) = (turns != [0.0; 3], edges.shift(turns));
            let c = self.index(cell);
            self.members[self.starts[c]..self.starts[c + 1]].iter().any(|&j| {
                let y = self.x[j];
                test(j, [y[0] + shift[0], y[1] + shift[1], y[2] + shift[2]], image)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};
    use perigrain_world::World;

    fn bar() -> World {
        let mut w = scene("units si\nboundary f p f\nlattice sc 0.5\nregion b block 0 4 0 3 0 3 units box");
        more(&mut w, "create_box 2 b\ncreate_atoms 1 box");
        w
    }

    #[test]
    fn ids_follow_storage_order() {
        let mut w = bar();
        let last = w.particles.x[w.n() - 1];
        more(&mut w, "group g id 12:20");
        assert_eq!(act(&mut w, "delete_atoms group g", &[]).unwrap(), ["Deleted 9 atoms, new total = 279"]);
        assert_eq!((w.particles.x[11], w.particles.tag[11]), (last, 12));
        more(&mut w, "region r block 0 1 0 1 0 1 units box\ndelete_atoms region r compress no bond no");
        assert!(w.particles.tag.contains(&279) && w.particles.tag.len() < 279);
    }

    // Oracle: the same lines in LAMMPS (with a pair style of cutoff 1, which it needs): 45 and 87 deleted,
    // Σ type = 114, Σ id·x = 4401.60756548569 (15 digits).
    #[test]
    fn overlaps_are_lammps_overlaps() {
        let mut w = scene("units si\nboundary p f p\nregion b block 0 4 0 3 0 3 units box\ncreate_box 2 b");
        more(&mut w, "create_atoms 1 random 100 124 NULL\ncreate_atoms 2 random 100 125 NULL");
        more(&mut w, "group a type 1\ngroup c id 50:150\ndelete_atoms overlap 0.4 a c");
        assert_eq!(w.n(), 155);
        more(&mut w, "delete_atoms overlap 0.5 all all");
        let p = &w.particles;
        assert_eq!((w.n(), p.kind.iter().map(|&k| u32::from(k)).sum::<u32>()), (68, 114));
        assert_eq!(p.x[67][0], 1.4492650895608892);
        let moment: f64 = (0..w.n()).map(|i| f64::from(p.tag[i]) * p.x[i][0]).sum();
        assert!((moment - 4401.60756548569).abs() < 1e-11);
    }

    #[test]
    fn blames_the_right_word() {
        let w = bar();
        assert_eq!(refused(&w, "delete_atoms group g").0, "g");
        assert_eq!(refused(&w, "delete_atoms random fraction 1.1 yes all NULL 3").0, "1.1");
        assert_eq!(refused(&w, "delete_atoms random count 2000 yes all NULL 3").0, "2000");
        assert_eq!(refused(&w, "delete_atoms porosity all NULL 0.1 3").0, "porosity");
        assert_eq!(refused(&w, "delete_atoms group all bond yes").0, "bond");
        assert_eq!(refused(&w, "delete_atoms overlap 5 all all").0, "5");
        assert_eq!(
            refused(&w, "delete_atoms overlap 0.1 all").1,
            "`delete_atoms` ends too early: a group is missing"
        );
    }
}
