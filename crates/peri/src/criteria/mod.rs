//! Bonds that break by something else than their stretch alone: by the work done on them, by stress or strain at their ends.
//!
//! Each criterion gives a bond the ratio of what it bears to what it can bear, which is what equilibria rank bonds by
//! ([`Families::breaking_share`]). Bonds are judged one by one, after the forces of a step that advances.

mod ends;
pub mod fatigue;
mod tension;
mod work;

use crate::families::bond::Broken;
use crate::families::lattice::{LANES, LatticeBody};
use crate::families::list::ListBody;
use crate::families::{Candidate, Cell, Criterion, Families, PeriView};
use crate::shares::{LIST, square};
use ends::Ends;
use perigrain_base::par::{self, Shared};
use tension::{InList, OnLattice, Rules};

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

/// What bonds are judged by, at the places of the last evaluation of forces.
struct Judge<'a> {
    families: &'a Families,
    view: &'a PeriView<'a>,
    /// What their ends bear, where that counts.
    ends: Option<Ends>,
}

impl<'a> Judge<'a> {
    fn new(families: &'a Families, view: &'a PeriView) -> Self {
        let ends = families.options.criterion.of_sites().then(|| Ends::of(families, view));
        Self { families, view, ends }
    }

    /// The ratio of a bond on which this work has been done; 0 where one of its ends is spared.
    fn ratio(&self, bond: &Stretched, work: impl Fn() -> f64) -> f64 {
        let Self { families, view, ends } = self;
        let spared = |p: &usize| families.lasting.get(*p).copied().unwrap_or(false);
        if bond.ends.iter().any(spared) {
            return 0.0;
        }
        match (ends, families.options.criterion) {
            (Some(ends), Criterion::Stress(most) | Criterion::Strain(most) | Criterion::Shear(most)) => {
                ends.measure(families, view, bond.ends) / (most * bond.strength)
            }
            (None, Criterion::Work) => {
                let [a, b] = bond.ends.map(|p| usize::from(view.kind[p]) - 1);
                let limit = families.work_limits[a * families.table.types() + b];
                work() / (limit * bond.strength * bond.strength)
            }
            _ => 0.0,
        }
    }
}

impl Families {
    /// Finds the bonds whose ratio is 1 or more, body by body, those of the list last.
    pub(crate) fn find_by_criterion(&self, view: &PeriView, cell: &Cell, broken: &mut Vec<Broken>) {
        if self.unjudged {
            return;
        }
        if self.options.criterion == Criterion::Formula {
            return self.find_by_ratio(view, cell, broken);
        }
        let judge = Judge::new(self, view);
        let breaks = |bond: &Stretched, work: &[[f64; 2]]| -> Option<f64> {
            Some(judge.ratio(bond, || work[bond.place][0])).filter(|ratio| *ratio >= 1.0)
        };
        for (k, body) in self.lattices.iter().enumerate() {
            for (bond, ends) in of_lattice(body, &|bond| breaks(bond, &body.work)) {
                broken.push(Broken { body: k, bond, square: square(view, ends) });
            }
        }
        let list = &self.list;
        for (bond, ends) in of_list(list, cell, &|bond| breaks(bond, &list.work)) {
            broken.push(Broken { body: LIST, bond, square: square(view, ends) });
        }
    }

    /// The largest ratio of a bond at the places of the last evaluation, which need not have advanced. 0 under a formula, which is
    /// evaluated only where bonds may break.
    pub(crate) fn largest_ratio(&self, view: &PeriView, cell: &Cell) -> f64 {
        if self.unjudged {
            return 0.0;
        }
        let judge = Judge::new(self, view);
        let rules = Rules { law: &self.law, options: &self.options, table: &self.table };
        let bodies: Vec<OnLattice> =
            self.lattices.iter().map(|body| OnLattice::new(&rules, body, view)).collect();
        let listed = InList { rules: &rules, list: &self.list, cell };
        let mut most = 0.0f64;
        self.each_living(|body, sites, bond, ends| {
            let ([i, j], ends) = (sites, ends.map(|p| p as usize));
            let ratio = match self.lattices.get(body).zip(bodies.get(body)) {
                Some((own, tensions)) if own.z(1, i, j, bond) > 0.0 => {
                    let place = own.place_of(i, bond);
                    let bond_here = Stretched { sites, ends, place, strength: own.scatter.strength(sites) };
                    judge.ratio(&bond_here, || {
                        let mut work = own.work.get(place).copied().unwrap_or_default();
                        let before = tensions.length_before(i, j, bond);
                        work::add(&mut work, tensions.tension(i, j, bond), before);
                        work[0]
                    })
                }
                None if self.list.z(false, i, j, cell).0 > 0.0 => {
                    let strength = self.list.scatter.strength(sites);
                    judge.ratio(&Stretched { sites, ends, place: bond, strength }, || {
                        let mut work = self.list.work.get(bond).copied().unwrap_or_default();
                        work::add(&mut work, listed.tension(bond), listed.length_before(bond));
                        work[0]
                    })
                }
                _ => 0.0,
            };
            most = most.max(ratio);
        });
        most
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
