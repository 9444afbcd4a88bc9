//! What has become of families: damage, counts, partners, and what happens to them when particles are deleted.

use crate::families::lattice::{LANES, LatticeBody, PAD};
use crate::families::list::{GROUP, ListBody};
use crate::families::{Cell, Families, Law, Moved, NearPair, Neighbour};
use crate::law::style::Style;
use perigrain_base::par::{self, Shared};

/// Where a bond stands.
enum Link<'a> {
    /// Along a stencil vector of a body.
    Lattice(&'a LatticeBody, usize),
    /// Between two records of the list.
    List(&'a ListBody, [usize; 2]),
}

impl Link<'_> {
    /// Length at the start, by the shortest way where the box repeats in these `periods`.
    fn length(&self, cell: &Cell) -> f64 {
        match self {
            Link::Lattice(body, e) => body.xi(*e).iter().map(|x| x * x).sum::<f64>().sqrt(),
            Link::List(list, [i, j]) => list.z(false, *i, *j, cell).1,
        }
    }
}

impl Families {
    /// The share of a particle's family (by volume) whose bonds are broken (Silling and Askari 2005, eq. 27).
    pub fn damage(&self, i: usize, volume: &[f64]) -> f64 {
        self.damage_from(i, || {
            let (mut live, mut sum) = (0, 0.0);
            self.each(i, |n| {
                if n.alive {
                    live += 1;
                    sum += volume[n.partner as usize];
                }
            });
            (live, sum)
        })
    }

    /// The damage of the particles `0..out.len()`.
    pub fn damage_all(&self, volume: &[f64], out: &mut [f64]) {
        let damages = self.damages(volume);
        par::each(out, |start, out| {
            for (k, d) in out.iter_mut().enumerate() {
                *d = damages.of(start + k);
            }
        });
    }

    /// The damage of many particles: where all of a body on a lattice, or of the list, are of one volume, their living bonds are counted first.
    pub fn damages<'a>(&'a self, volume: &'a [f64]) -> Damages<'a> {
        let damaged = self.damaged.contains(&true);
        let lattices = self.lattices.iter().map(|body| damaged.then(|| Counted::of(body, volume)).flatten());
        let list = damaged.then(|| Counted::of_list(&self.list, volume)).flatten();
        Damages { families: self, volume, counted: lattices.chain([list]).collect() }
    }

    /// A particle's damage from what is found about its living bonds: their number, and the volume of their partners.
    fn damage_from(&self, i: usize, found: impl FnOnce() -> (u16, f64)) -> f64 {
        let size = self.family_size.get(i).copied().unwrap_or(0);
        if size == 0 || self.family_volume[i] == 0.0 || !self.damaged[i] {
            return 0.0;
        }
        let (live, sum) = found();
        if live == size { 0.0 } else { 1.0 - sum / self.family_volume[i] }
    }

    /// Bonds at the start, each counted from both ends as LAMMPS prints them.
    pub fn bonds(&self) -> usize {
        self.family_size.iter().map(|&s| usize::from(s)).sum()
    }

    /// Bonds that still live, each counted from both ends.
    pub fn live_bonds(&self) -> usize {
        let bits: usize =
            self.lattices.iter().flat_map(|b| &b.alive).map(|byte| byte.count_ones() as usize).sum();
        2 * (bits + self.list.alive.iter().map(|b| b.count_ones() as usize).sum::<usize>())
    }

    /// Calls `f` for the ends of every living bond, each once, in the order in which they are kept; of `broken` ones too.
    pub fn bonds_as_kept(&self, broken: bool, mut f: impl FnMut(u32, u32)) {
        let mut join = |i: u32, j: u32| {
            if i != u32::MAX && j != u32::MAX {
                f(i, j);
            }
        };
        for body in &self.lattices {
            for (slot, row) in body.rows.iter().enumerate().filter(|(_, row)| row.len > 0) {
                let cells = row.start as usize..(row.start + row.len) as usize;
                for e in 0..body.stencil.len() {
                    let ahead = |cell: usize| body.ahead(slot, cell, e);
                    // All between the first and the last that lead to a cell lead to one, equally far.
                    let Some((first, to)) = cells.clone().find_map(|c| Some((c, ahead(c)?))) else {
                        continue;
                    };
                    let last = cells.clone().rfind(|c| ahead(*c).is_some()).unwrap_or(first);
                    for cell in (first..=last).filter(|cell| broken || body.lives(*cell, e)) {
                        join(body.particle[cell], body.particle[cell + to - first]);
                    }
                }
            }
        }
        let list = &self.list;
        for i in 0..list.record.len() {
            for b in list.own(i).filter(|b| broken || list.lives(*b)) {
                // Groups are filled up with their owner.
                let j = list.partner[b] as usize;
                if j != i {
                    join(list.particle[i], list.particle[j]);
                }
            }
        }
    }

    /// All partners of a particle, broken bonds included, by index.
    pub fn neighbours(&self, i: usize) -> Vec<Neighbour> {
        let mut found = Vec::new();
        self.each(i, |n| found.push(n));
        found.sort_unstable_by_key(|n| n.partner);
        found
    }

    /// The same with the lengths of bonds at the start.
    pub fn neighbours_apart(&self, i: usize) -> Vec<(Neighbour, f64)> {
        let mut found = Vec::new();
        self.each_apart(i, |n, length| found.push((n, length)));
        found.sort_unstable_by_key(|(n, _)| n.partner);
        found
    }

    /// Calls `f` for all partners of a particle.
    pub(super) fn each(&self, i: usize, mut f: impl FnMut(Neighbour)) {
        self.walk(i, |n, _| f(n));
    }

    /// Calls `f` for all partners of a particle with the length of the bond at the start.
    pub(super) fn each_apart(&self, i: usize, mut f: impl FnMut(Neighbour, f64)) {
        let cell = Cell::unstrained(self.birth.periods());
        self.walk(i, |n, link| f(n, link.length(&cell)));
    }

    fn walk(&self, i: usize, mut f: impl FnMut(Neighbour, Link)) {
        let place = self.place.get(i).copied().unwrap_or(u32::MAX);
        if place == u32::MAX {
            return;
        }
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        if let Some(body) = self.lattices.get(body) {
            let cell = (place - body.first_place) as usize;
            body.around(cell, |other, owner, e| {
                let partner = body.particle[other];
                if partner != u32::MAX {
                    let alive = body.lives(owner, e);
                    f(Neighbour { partner, alive, weight: None }, Link::Lattice(body, e));
                }
            });
            return;
        }
        let (list, record) = (&self.list, (place - self.list.first_place) as usize);
        list.around(record, |other, b| {
            let partner = list.particle[other];
            if partner != u32::MAX {
                let (alive, weight) = (list.lives(b), list.own_weight.get(b).copied());
                f(Neighbour { partner, alive, weight }, Link::List(list, [record, other]));
            }
        });
    }

    /// Renumbers particles; `None` marks a removed one, whose bonds end (and count as damage of its partners).
    pub fn remap(&mut self, old_to_new: &[Option<u32>]) {
        let n = old_to_new.iter().flatten().count();
        let (kind, frees) = (self.law.kind.style(), self.law.kind.frees(self.options.compat_lammps));
        let cell = self.cell_before();
        for body in &mut self.lattices {
            for cell in 0..body.particle.len() {
                let old = body.particle[cell];
                if old == u32::MAX {
                    continue;
                }
                body.particle[cell] = old_to_new[old as usize].unwrap_or(u32::MAX);
                if body.particle[cell] == u32::MAX {
                    if frees {
                        free_all(body, cell, kind);
                    }
                    body.vacate(cell);
                }
            }
        }
        for r in 0..self.list.particle.len() {
            let old = self.list.particle[r];
            if old == u32::MAX {
                continue;
            }
            self.list.particle[r] = old_to_new[old as usize].unwrap_or(u32::MAX);
            if self.list.particle[r] == u32::MAX {
                let law = frees.then_some(&self.law);
                end_bonds(&mut self.list, r, law, &cell);
            }
        }
        self.family_volume = moved(&self.family_volume, old_to_new, n, 0.0);
        self.family_size = moved(&self.family_size, old_to_new, n, 0);
        self.damaged = vec![true; n];
        if !self.spacing.is_empty() {
            self.spacing = moved(&self.spacing, old_to_new, n, 1.0);
        }
        if !self.lasting.is_empty() {
            self.lasting = moved(&self.lasting, old_to_new, n, false);
        }
        self.place = moved(&self.place, old_to_new, n, u32::MAX);
        self.reference = self.reference.take().map(|r| moved(&r, old_to_new, n, [0.0; 3]));
        self.continua().for_each(|(own, _)| own.inverse.clear());
        let loose = self.near.loose.iter();
        self.near.loose = loose.filter_map(|&(p, x)| old_to_new[p as usize].map(|p| (p, x))).collect();
        self.forget_near();
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        let reference = self.reference.as_ref().map_or(0, |r| 24 * r.len());
        let near: usize = self.near.pairs.iter().map(|p| size_of::<NearPair>() * p.capacity()).sum();
        let near = near + 24 * self.near.looked.len() + self.scratch.contact.bytes();
        self.lattices.iter().map(crate::families::lattice::LatticeBody::bytes).sum::<usize>()
            + self.list.bytes()
            + 14 * self.place.len()
            + reference
            + near
    }
}

/// See [`Families::damages`].
pub struct Damages<'a> {
    families: &'a Families,
    volume: &'a [f64],
    counted: Vec<Option<Counted>>,
}

impl Damages<'_> {
    /// As [`Families::damage`], to the last bit.
    pub fn of(&self, i: usize) -> f64 {
        let f = self.families;
        let place = f.place.get(i).copied().unwrap_or(u32::MAX);
        let body = f.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        let first = f.lattices.get(body).map_or(f.list.first_place, |body| body.first_place);
        match self.counted.get(body).filter(|_| place != u32::MAX) {
            Some(Some(counted)) => f.damage_from(i, || {
                let live = counted.live[(place - first) as usize];
                (live, counted.sums[usize::from(live)])
            }),
            _ => f.damage(i, self.volume),
        }
    }
}

/// Living bonds of a body whose particles are of one volume.
struct Counted {
    /// Of each cell or record.
    live: Vec<u16>,
    /// The volume of so many partners, added up one by one.
    sums: Vec<f64>,
}

/// The bits of a byte as eight numbers.
const SPREAD: [[u16; LANES]; 256] = {
    let mut spread = [[0; LANES]; 256];
    let mut k = 0;
    while k < 256 * LANES {
        spread[k / LANES][k % LANES] = ((k / LANES) >> (k % LANES) & 1) as u16;
        k += 1;
    }
    spread
};

impl Counted {
    /// The volume of all of these particles, if it is one.
    fn one(particle: &[u32], volume: &[f64]) -> Option<f64> {
        let mut all = particle.iter().filter(|&&p| p != u32::MAX).map(|&p| volume.get(p as usize));
        let one = *all.next()??;
        all.all(|v| v == Some(&one)).then_some(one)
    }

    /// The volume of 0, 1, 2 … partners.
    fn sums(one: f64, most: usize) -> Vec<f64> {
        let mut sums = vec![0.0; most + 1];
        (1..sums.len()).for_each(|k| sums[k] = sums[k - 1] + one);
        sums
    }

    fn of_list(list: &ListBody, volume: &[f64]) -> Option<Self> {
        let one = Self::one(&list.particle, volume)?;
        let mut live = vec![0u16; list.particle.len()];
        for (group, &bits) in list.alive.iter().enumerate() {
            live[list.owner[group] as usize] += bits.count_ones() as u16;
            for k in (0..GROUP).filter(|k| bits >> k & 1 == 1) {
                live[list.partner[GROUP * group + k] as usize] += 1;
            }
        }
        let most = live.iter().max().map_or(0, |most| usize::from(*most));
        Some(Self { live, sums: Self::sums(one, most) })
    }

    fn of(body: &LatticeBody, volume: &[f64]) -> Option<Self> {
        let one = Self::one(&body.particle, volume)?;
        let (entries, cells) = (body.stencil.len(), body.particle.len());
        let mut live = vec![0u16; cells];
        let counts = Shared::new(&mut live);
        let thickness = (body.reach[2] as usize).max(1);
        par::two_colours(body.planes.div_ceil(thickness), |slab| {
            let (low, high) = (slab * thickness, ((slab + 1) * thickness).min(body.planes));
            let start = |plane: usize| body.rows[body.slot(plane, 0)].start as usize;
            let (first, last) = (start(low), start((high + thickness).min(body.planes)));
            // Eights reach into cells beyond a row's ends, which may be another slab's: counted aside, with entries around.
            let mut aside = vec![0u16; last - first + 2 * PAD];
            for slot in body.slot(low, 0)..body.slot(high, 0) {
                let row = body.rows[slot];
                for (e, &[along, across, up]) in body.stencil.iter().enumerate() {
                    let other = (slot + up as usize * body.width).wrapping_add_signed(across as isize);
                    let Some(other) = body.rows.get(other).filter(|other| other.len > 0) else { continue };
                    let to = other.start as i32 - row.start as i32 + row.lo - other.lo + along;
                    for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
                        let bits = body.alive[chunk * entries + e];
                        // Where no bond lives the other row may end long before.
                        if bits == 0 {
                            continue;
                        }
                        let bits = &SPREAD[usize::from(bits)];
                        let near = PAD + chunk * LANES - first;
                        for at in [near, near.wrapping_add_signed(to as isize)] {
                            let counts = &mut aside[at..at + LANES];
                            counts.iter_mut().zip(bits).for_each(|(count, bit)| *count += bit);
                        }
                    }
                }
            }
            // SAFETY: cells of this slab and of those it reaches, which no other task writes now.
            let counts = unsafe { counts.get(first..last) };
            counts.iter_mut().zip(&aside[PAD..]).for_each(|(count, more)| *count += more);
        });
        Some(Self { live, sums: Self::sums(one, 2 * entries) })
    }
}

/// A column under new numbers.
fn moved<T: Copy>(column: &[T], old_to_new: &[Option<u32>], n: usize, empty: T) -> Vec<T> {
    let mut out = vec![empty; n];
    for (value, new) in column.iter().zip(old_to_new) {
        if let Some(new) = new {
            out[*new as usize] = *value;
        }
    }
    out
}

/// Sets the extensions of all living bonds of a cell free.
fn free_all(body: &mut LatticeBody, cell: usize, law: &Style) {
    let mut living = Vec::new();
    body.around(cell, |_, owner, e| {
        if body.lives(owner, e) {
            living.push((owner, e));
        }
    });
    living.into_iter().for_each(|(owner, e)| body.free(owner, e, law, Moved::Before));
}

/// Ends all bonds of a record, and sets their extensions free under a law that does so.
fn end_bonds(list: &mut ListBody, record: usize, frees: Option<&Law>, cell: &Cell) {
    let mut ended = Vec::new();
    list.around(record, |_, b| ended.push(b));
    for b in ended {
        if let Some(law) = frees.filter(|_| list.lives(b)) {
            list.free(b, law, cell, Moved::Before);
        }
        list.set(b, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::{Bounds, FamilyOptions, Layout, PeriView, PmbCoeff, PmbTable};

    /// Damage of all particles of a brick with a cut and a hole is that of each looked at by itself, be all volumes alike or not.
    #[test]
    fn damage_of_many_is_that_of_each() {
        let at = |i: i32| [f64::from(i % 11), f64::from(i / 11 % 6), f64::from(i / 66)];
        let x: Vec<[f64; 3]> = (0..330).map(at).collect();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.1, s00: 1.0, alpha: 0.0 }).unwrap();
        let bounds = Bounds { lo: [-20.0; 3], hi: [20.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let various: Vec<f64> = (0..330).map(|i| 0.1 + 0.001 * f64::from(i % 7)).collect();
        let layouts = [Layout::Auto, Layout::List];
        for (volume, layout) in
            [vec![0.1; 330], various].iter().flat_map(|v| layouts.map(|layout| (v, layout)))
        {
            let view = PeriView { x: &x, x0: &x, kind: &[1; 330], volume, bounds, excluded: None };
            let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
            let mut families = Families::build(&view, &table, options).unwrap();
            assert!(families.damages(volume).counted.iter().all(Option::is_none), "nothing is damaged yet");
            families.cut(&view, |a, b| (a[0] + 0.3 * a[1] - 5.2) * (b[0] + 0.3 * b[1] - 5.2) < 0.0);
            families.lattices.iter_mut().for_each(|body| body.vacate(130));
            let mut all = vec![0.0; 330];
            families.damage_all(volume, &mut all);
            let one: Vec<f64> = (0..330).map(|i| families.damage(i, volume)).collect();
            assert_eq!(all, one);
            assert!(all.iter().filter(|d| **d > 0.0).count() > 50 && all.contains(&0.0));
        }
    }

    /// Rows beside each other may be of very different lengths: most cells of the long one have no bonds into the short one.
    #[test]
    fn damage_of_a_body_with_a_step() {
        let plate = (0..600).map(|i| [f64::from(i % 200), f64::from(i / 200), 0.0]);
        let x: Vec<[f64; 3]> =
            plate.chain((0..9).map(|i| [f64::from(i % 3), f64::from(i / 3), 1.0])).collect();
        let (kind, volume) = (vec![1; x.len()], vec![0.1; x.len()]);
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 1.5, s00: 1.0, alpha: 0.0 }).unwrap();
        let bounds = Bounds { lo: [-500.0; 3], hi: [500.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let view = PeriView { x: &x, x0: &x, kind: &kind, volume: &volume, bounds, excluded: None };
        let mut families = Families::build(&view, &table, FamilyOptions::new(1.0)).unwrap();
        families.cut(&view, |a, b| (a[0] - 1.5) * (b[0] - 1.5) < 0.0);
        let mut all = vec![0.0; x.len()];
        families.damage_all(&volume, &mut all);
        let one: Vec<f64> = (0..x.len()).map(|i| families.damage(i, &volume)).collect();
        assert_eq!(all, one);
        assert!(all[0] == 0.0 && all[1] > 0.0 && all[608] > 0.0 && families.lattices.len() == 1);
    }
}
