//! Bonds that break by something else than their stretch alone: by the work done on them, by stress or strain at their ends.
//!
//! Each criterion gives a bond the ratio of what it bears to what it can bear, which is what equilibria rank bonds by
//! ([`Families::breaking_share`]). Bonds are judged one by one, after the forces of a step that advances.

mod ends;
mod tension;
mod work;

use crate::families::bond::Broken;
use crate::families::lattice::{LANES, LatticeBody};
use crate::families::list::ListBody;
use crate::families::{Candidate, Cell, Criterion, Families, PeriView};
use crate::shares::{LIST, square};
use ends::Ends;
use perigrain_base::par::{self, Shared};

/// Records whose bonds are judged together.
const PART: usize = 64;

/// A living bond that is longer than at the start.
#[derive(Clone, Copy)]
struct Stretched {
    /// Cells or records.
    sites: [usize; 2],
    /// Particles.
    ends: [usize; 2],
    /// Where its own numbers are.
    place: usize,
    /// The factor on the stretch that it bears.
    strength: f64,
}

impl Families {
    /// Finds the bonds whose ratio is 1 or more, body by body, those of the list last.
    pub(crate) fn find_by_criterion(&self, view: &PeriView, cell: &Cell, broken: &mut Vec<Broken>) {
        if self.unjudged {
            return;
        }
        let criterion = self.options.criterion;
        if criterion == Criterion::Formula {
            return self.find_by_ratio(view, cell, broken);
        }
        let ends = criterion.of_sites().then(|| Ends::of(self, view));
        let types = self.table.types();
        let ratio = |bond: &Stretched, work: &[[f64; 2]]| match (&ends, criterion) {
            (Some(ends), Criterion::Stress(most) | Criterion::Strain(most) | Criterion::Shear(most)) => {
                ends.measure(self, view, bond.ends) / (most * bond.strength)
            }
            (None, Criterion::Work) => {
                let [a, b] = bond.ends.map(|p| usize::from(view.kind[p]) - 1);
                let limit = self.work_limits[a * types + b] * bond.strength * bond.strength;
                work[bond.place][0] / limit
            }
            _ => 0.0,
        };
        let spared = |p: usize| self.lasting.get(p).copied().unwrap_or(false);
        let judge = |bond: &Stretched, work: &[[f64; 2]]| -> Option<f64> {
            let ratio = ratio(bond, work);
            (ratio >= 1.0 && !bond.ends.iter().any(|p| spared(*p))).then_some(ratio)
        };
        for (k, body) in self.lattices.iter().enumerate() {
            for (bond, ends) in of_lattice(body, &|bond| judge(bond, &body.work)) {
                broken.push(Broken { body: k, bond, square: square(view, ends) });
            }
        }
        let list = &self.list;
        for (bond, ends) in of_list(list, cell, &|bond| judge(bond, &list.work)) {
            broken.push(Broken { body: LIST, bond, square: square(view, ends) });
        }
    }
}

impl Families {
    /// The particles at the ends of each living bond.
    pub fn living(&self) -> Vec<[u32; 2]> {
        let mut all = vec![];
        self.each_living(|_, _, _, ends| all.push(ends));
        all
    }

    /// Calls `f` for each living bond with the number of its body, its sites, its own number and its particles.
    fn each_living(&self, mut f: impl FnMut(usize, [usize; 2], usize, [u32; 2])) {
        for (k, body) in self.lattices.iter().enumerate() {
            for slot in 0..body.rows.len() {
                each_of_row(body, slot, |cell, to, e| {
                    f(k, [cell, to], e, [body.particle[cell], body.particle[to]]);
                });
            }
        }
        let list = &self.list;
        for i in 0..list.record.len() {
            for b in list.own(i).filter(|b| list.lives(*b)) {
                let j = list.partner[b] as usize;
                f(LIST, [i, j], b, [list.particle[i], list.particle[j]]);
            }
        }
    }

    /// The bonds whose ratio, from a formula, is 1 or more; none in steps without ratios.
    fn find_by_ratio(&self, view: &PeriView, cell: &Cell, broken: &mut Vec<Broken>) {
        let mut ratios = self.ratios.iter();
        let spared = |p: u32| self.lasting.get(p as usize).copied().unwrap_or(false);
        self.each_living(|body, sites, bond, ends| {
            let Some(&ratio) = ratios.next() else { return };
            let [i, j] = sites;
            let (z, strength) = match self.lattices.get(body) {
                Some(own) => (own.z(1, i, j, bond), own.scatter.strength(sites)),
                None => (self.list.z(false, i, j, cell).0, self.list.scatter.strength(sites)),
            };
            let ratio = ratio / strength;
            if ratio >= 1.0 && z > 0.0 && !ends.iter().any(|p| spared(*p)) {
                let bond = candidate(sites, bond, ratio);
                broken.push(Broken { body, bond, square: square(view, ends) });
            }
        });
    }
}

/// A bond that breaks, with its particles.
type Found = (Candidate, [u32; 2]);

/// As whose ratio to what it bears a bond is known.
fn candidate(sites: [usize; 2], bond: usize, ratio: f64) -> Candidate {
    Candidate { ends: sites.map(|s| s as u32), bond: bond as u32, stretch: ratio, s00: 1.0, alpha: 0.0 }
}

/// The bonds of a body on a lattice that `judge` gives a ratio, in the order of planes, cells and stencil vectors.
fn of_lattice(body: &LatticeBody, judge: &(impl Fn(&Stretched) -> Option<f64> + Sync)) -> Vec<Found> {
    let mut lists = vec![vec![]; body.planes];
    let shared = Shared::new(&mut lists);
    par::for_rows(body.planes, |plane| {
        // SAFETY: each plane has its own list.
        let found = unsafe { &mut shared.get(plane..plane + 1)[0] };
        for slot in body.slot(plane, 0)..body.slot(plane + 1, 0) {
            each_of_row(body, slot, |cell, to, e| {
                if body.z(1, cell, to, e) <= 0.0 {
                    return;
                }
                let bond = Stretched {
                    sites: [cell, to],
                    ends: [cell, to].map(|c| body.particle[c] as usize),
                    place: body.place_of(cell, e),
                    strength: body.scatter.strength([cell, to]),
                };
                if let Some(ratio) = judge(&bond) {
                    found.push((candidate(bond.sites, e, ratio), bond.ends.map(|p| p as u32)));
                }
            });
        }
    });
    lists.into_iter().flatten().collect()
}

/// The same of the list, in the order of its bonds.
fn of_list(list: &ListBody, cell: &Cell, judge: &(impl Fn(&Stretched) -> Option<f64> + Sync)) -> Vec<Found> {
    let n = list.record.len();
    let mut lists = vec![vec![]; n.div_ceil(PART)];
    let shared = Shared::new(&mut lists);
    par::for_rows(n.div_ceil(PART), |part| {
        // SAFETY: each part has its own list.
        let found = unsafe { &mut shared.get(part..part + 1)[0] };
        for i in part * PART..n.min((part + 1) * PART) {
            for b in list.own(i).filter(|b| list.lives(*b)) {
                let j = list.partner[b] as usize;
                if list.z(false, i, j, cell).0 <= 0.0 {
                    continue;
                }
                let bond = Stretched {
                    sites: [i, j],
                    ends: [i, j].map(|r| list.particle[r] as usize),
                    place: b,
                    strength: list.scatter.strength([i, j]),
                };
                if let Some(ratio) = judge(&bond) {
                    found.push((candidate(bond.sites, b, ratio), bond.ends.map(|p| p as u32)));
                }
            }
        }
    });
    lists.into_iter().flatten().collect()
}

/// Calls `f` for each living bond of a row's cells: its owner, its other end and its stencil vector.
fn each_of_row(body: &LatticeBody, slot: usize, mut f: impl FnMut(usize, usize, usize)) {
    for cell in body.rows[slot].cells() {
        for e in (0..body.stencil.len()).filter(|e| body.lives(cell, *e)) {
            if let Some(to) = body.ahead(slot, cell, e) {
                f(cell, to, e);
            }
        }
    }
}

impl LatticeBody {
    /// Where the work of a bond is kept.
    fn place_of(&self, cell: usize, e: usize) -> usize {
        (cell / LANES * self.stencil.len() + e) * LANES + cell % LANES
    }
}
