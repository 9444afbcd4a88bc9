//! Bonds as columns in spatial order, and the bonds of each particle.

mod follow;

use perigrain_base::math::body::{Quat, UNTURNED};
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;

/// Bonds of one type are stored in groups of this size, so that vectorized code handles a single type.
pub const GROUP: usize = 8;

/// A bond with the storage indices of its ends.
#[derive(Clone, Copy, Debug)]
pub struct Member<const C: usize> {
    /// Type.
    pub kind: u16,
    /// Indices of the ends; the first is the end with the lower ID.
    pub ends: [u32; 2],
    /// Rest length [length].
    pub length: f64,
    /// Unit vector from the second end to the first at rest, in the frame of the second end.
    pub axis: Vec3,
    /// The rotation from the first end's orientation to the second's when the bond was made.
    pub turned: Quat,
    /// Values of this bond.
    pub own: [f64; C],
}

/// Determines the position of a bond in the columns.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Type.
    pub kind: u16,
    /// Indices of the ends.
    pub ends: [u32; 2],
}

/// Bonds sorted by type, lower index and upper index; equal ones in the given order.
fn in_order(keys: &[Key], particles: usize) -> Vec<u32> {
    // Ends are close in memory and have few bonds each: a counting sort is faster than comparisons.
    let lower = |k: usize| keys[k].ends[0].min(keys[k].ends[1]) as usize;
    let upper = |k: usize| u64::from(keys[k].ends[0].max(keys[k].ends[1]));
    let (starts, mut order) = counted(particles, keys.len(), lower, |k| upper(k) << 32 | k as u64);
    for range in starts.windows(2) {
        order[range[0] as usize..range[1] as usize].sort_unstable();
    }
    let by_place: Vec<u32> = order.iter().map(|k| *k as u32).collect();
    if keys.iter().all(|key| key.kind == keys[0].kind) {
        return by_place;
    }
    let kinds = keys.iter().map(|key| usize::from(key.kind) + 1).max().unwrap_or(0);
    counted(kinds, keys.len(), |k| usize::from(keys[by_place[k] as usize].kind), |k| by_place[k]).1
}

/// Stable counting sort by a small number: the start of each number's range, and the sorted items.
fn counted<T: Copy + Default>(
    numbers: usize,
    things: usize,
    number: impl Fn(usize) -> usize,
    what: impl Fn(usize) -> T,
) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0u32; numbers + 1];
    (0..things).for_each(|k| starts[number(k) + 1] += 1);
    for k in 0..numbers {
        starts[k + 1] += starts[k];
    }
    let (mut next, mut out) = (starts.clone(), vec![T::default(); things]);
    for k in 0..things {
        let at = &mut next[number(k)];
        out[*at as usize] = what(k);
        *at += 1;
    }
    (starts, out)
}

/// Bonds by type and position, padded to whole groups with dead bonds.
#[derive(Clone, Debug)]
pub struct Columns<const C: usize> {
    /// Indices of the ends.
    pub ends: [Vec<u32>; 2],
    /// The type of each group.
    pub kinds: Vec<u16>,
    /// 1 for intact bonds, 0 for broken ones and padding.
    alive: Vec<f64>,
    /// Whether all bonds of a group are intact.
    whole: Vec<bool>,
    /// Rest lengths [length].
    pub length: Vec<f64>,
    /// Components of the axes; empty if no bond has one.
    pub axis: [Vec<f64>; 3],
    /// Initial rotations; empty if all are the identity.
    pub turned: Vec<Quat>,
    /// Values of single bonds.
    pub own: [Vec<f64>; C],
    /// One more than the largest index of an end.
    pub reach: usize,
    holders: Holders,
    /// Whether the spatial order matches the current order of particles.
    in_order: bool,
    /// Whether bonds have broken since they were sorted.
    fewer: bool,
}

/// The bonds of each particle.
#[derive(Clone, Debug)]
struct Holders {
    /// Start of each particle's entries, and the end of the last.
    starts: Vec<u32>,
    /// Twice the row of a bond, plus one at its second end; sorted by type and index of the partner, which is
    /// ascending if bonds are in order.
    entries: Vec<u32>,
}

impl Holders {
    #[inline]
    fn of(&self, particle: usize) -> &[u32] {
        &self.entries[self.starts[particle] as usize..self.starts[particle + 1] as usize]
    }

    /// Inserts the intact bonds.
    fn enter(&mut self, ends: &[Vec<u32>; 2], alive: &[f64], particles: usize) {
        let Self { starts, entries } = self;
        starts.clear();
        starts.resize(particles + 1, 0);
        let living = || (0..alive.len()).filter(|&k| alive[k] > 0.0);
        for places in ends {
            let rows = places.iter().zip(alive).filter(|(_, alive)| **alive > 0.0);
            rows.for_each(|(place, _)| starts[*place as usize + 1] += 1);
        }
        for k in 0..particles {
            starts[k + 1] += starts[k];
        }
        entries.clear();
        entries.resize(starts[particles] as usize, 0);
        for k in living() {
            for (end, places) in ends.iter().enumerate() {
                // Advances each particle's start to its end, which is the start of the next.
                let at = &mut starts[places[k] as usize];
                entries[*at as usize] = (2 * k + end) as u32;
                *at += 1;
            }
        }
        starts.rotate_right(1);
        starts[0] = 0;
    }
}

impl<const C: usize> Default for Columns<C> {
    fn default() -> Self {
        Self {
            ends: Default::default(),
            kinds: vec![],
            alive: vec![],
            whole: vec![],
            length: vec![],
            axis: Default::default(),
            turned: vec![],
            own: std::array::from_fn(|_| vec![]),
            reach: 0,
            holders: Holders { starts: vec![0], entries: vec![] },
            in_order: true,
            fewer: false,
        }
    }
}

impl<const C: usize> Columns<C> {
    /// Columns of bonds between `particles` particles.
    pub fn new(bonds: &[Member<C>], particles: usize) -> Self {
        let keys: Vec<Key> = bonds.iter().map(|b| Key { kind: b.kind, ends: b.ends }).collect();
        let mut columns = Self::default();
        columns.fill(&keys, particles, |k| bonds[k]);
        columns
    }

    /// Replaces the bonds: one per key, between `particles` particles.
    pub fn fill(&mut self, keys: &[Key], particles: usize, bond: impl Fn(usize) -> Member<C>) {
        let rows = self.arrange(keys);
        self.holders.enter(&self.ends, &self.alive, particles);
        self.length.clear();
        self.axis.iter_mut().for_each(Vec::clear);
        self.turned.clear();
        self.own.iter_mut().for_each(Vec::clear);
        for k in rows {
            self.push(&bond(k as usize));
        }
    }

    /// Creates rows for these bonds; returns the bond of each row. Does not update the bonds of particles.
    fn arrange(&mut self, keys: &[Key]) -> Vec<u32> {
        (self.in_order, self.fewer) = (true, false);
        let reach = keys.iter().map(|key| key.ends[0].max(key.ends[1])).max();
        self.reach = reach.map_or(0, |place| place as usize + 1);
        let (order, mut rows) = (in_order(keys, self.reach), Vec::with_capacity(keys.len() + GROUP));
        self.kinds.clear();
        self.alive.clear();
        self.whole.clear();
        let mut rest = &order[..];
        while let Some(first) = rest.first() {
            let kind = keys[*first as usize].kind;
            let (alike, others) = rest.split_at(rest.partition_point(|k| keys[*k as usize].kind == kind));
            rows.extend_from_slice(alike);
            self.alive.resize(rows.len(), 1.0);
            rows.resize(rows.len().next_multiple_of(GROUP), alike[alike.len() - 1]);
            self.kinds.resize(rows.len() / GROUP, kind);
            // Padding is dead.
            self.whole.resize(self.alive.len() / GROUP, true);
            self.whole.resize(rows.len() / GROUP, false);
            self.alive.resize(rows.len(), 0.0);
            rest = others;
        }
        for (end, places) in self.ends.iter_mut().enumerate() {
            // Every element is written.
            places.resize(rows.len(), 0);
            par::each((&mut places[..], &rows[..]), |_, (places, rows)| {
                places.iter_mut().zip(rows).for_each(|(place, k)| *place = keys[*k as usize].ends[end]);
            });
        }
        rows
    }

    /// 1 for intact bonds, 0 for broken ones and padding.
    pub fn alive(&self) -> &[f64] {
        &self.alive
    }

    /// Whether all bonds of a group are intact.
    pub fn whole(&self) -> &[bool] {
        &self.whole
    }

    /// Marks a bond as broken.
    pub fn lose(&mut self, bond: usize) {
        (self.alive[bond], self.whole[bond / GROUP], self.fewer) = (0.0, false, true);
    }

    /// Fills the next row with a bond.
    fn push(&mut self, bond: &Member<C>) {
        let rows = self.length.len();
        self.length.push(bond.length);
        // The columns of axes and rotations are created with the first bond that has one.
        for k in 0..3 {
            if bond.axis != [0.0; 3] || !self.axis[k].is_empty() {
                self.axis[k].resize(rows, 0.0);
                self.axis[k].push(bond.axis[k]);
            }
        }
        if bond.turned != UNTURNED || !self.turned.is_empty() {
            self.turned.resize(rows, UNTURNED);
            self.turned.push(bond.turned);
        }
        for k in 0..C {
            self.own[k].push(bond.own[k]);
        }
    }

    /// The number of rows, including padding.
    pub fn rows(&self) -> usize {
        self.alive.len()
    }

    /// The bonds of a particle: twice the row, plus one at the second end.
    #[inline]
    pub fn of(&self, particle: usize) -> &[u32] {
        self.holders.of(particle)
    }

    /// The ends of a bond.
    pub fn pair(&self, bond: usize) -> [usize; 2] {
        [self.ends[0][bond] as usize, self.ends[1][bond] as usize]
    }

    /// The number of particles.
    pub fn particles(&self) -> usize {
        self.holders.starts.len() - 1
    }

    /// The type of a bond.
    pub fn kind(&self, bond: usize) -> u16 {
        self.kinds[bond / GROUP]
    }

    /// The intact bonds, in order.
    pub fn living(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.rows()).filter(|&k| self.alive[k] > 0.0)
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let axis = if self.axis[0].is_empty() { 0 } else { 24 };
        let turned = if self.turned.is_empty() { 0 } else { 32 };
        let per_row = 8 + 8 * (2 + C) + axis + turned;
        self.rows() * per_row + 4 * (self.holders.starts.len() + self.holders.entries.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_have_one_type_and_particles_know_their_bonds() {
        let bond = |kind, ends| Member {
            kind,
            ends,
            length: 1.0,
            axis: [1.0, 0.0, 0.0],
            turned: UNTURNED,
            own: [f64::from(kind)],
        };
        let mut bonds: Vec<_> = (0..11).map(|k| bond(2, [k + 1, k])).collect();
        bonds.extend([bond(1, [3, 5]), bond(1, [0, 2])]);
        let c = Columns::new(&bonds, 13);
        assert_eq!((c.rows(), &c.kinds[..]), (24, &[1, 2, 2][..]));
        assert_eq!(c.living().count(), 13);
        assert_eq!([c.pair(0), c.pair(1)], [[0, 2], [3, 5]]);
        assert!(c.turned.is_empty() && c.own[0][8] == 2.0);
        let entries: usize = (0..13).map(|p| c.of(p).len()).sum();
        assert_eq!((entries, c.of(12).len()), (26, 0));
        for p in 0..13u32 {
            for &e in c.of(p as usize) {
                assert_eq!(c.ends[e as usize & 1][e as usize / 2], p);
            }
        }
    }

    #[test]
    fn columns_filled_anew_are_as_new_ones() {
        let turn = [0.8, 0.6, 0.0, 0.0];
        let bond = |k: u32| {
            let ends = [(7 * k + 3) % 40, (11 * k * k + 5) % 40];
            let turned = if k % 9 == 4 { turn } else { UNTURNED };
            Member {
                kind: (k % 3 + 1) as u16,
                ends,
                length: f64::from(k),
                axis: [1.0, 0.0, 0.0],
                turned,
                own: [],
            }
        };
        let bonds: Vec<Member<0>> = (0..150).map(bond).filter(|b| b.ends[0] != b.ends[1]).collect();
        let new = Columns::new(&bonds, 40);
        let mut sorted = bonds.clone();
        sorted.sort_by_key(|b| (b.kind, b.ends[0].min(b.ends[1]), b.ends[0].max(b.ends[1])));
        let lengths: Vec<f64> = new.living().map(|k| new.length[k]).collect();
        assert_eq!(lengths, sorted.iter().map(|b| b.length).collect::<Vec<_>>());
        assert!(
            new.turned.len() == new.rows()
                && new.living().all(|k| (new.turned[k] == turn) == (new.length[k] % 9.0 == 4.0))
        );
        let mut again = Columns::new(&bonds[..20], 50);
        let keys: Vec<Key> = bonds.iter().map(|b| Key { kind: b.kind, ends: b.ends }).collect();
        again.fill(&keys, 40, |k| bonds[k]);
        assert_eq!(format!("{again:?}"), format!("{new:?}"));
        // Reordered particles keep their bonds: the bonds of each particle, and their order, are as in new
        // columns.
        let moved: Vec<u32> = (0..40).map(|k| (17 * k + 5) % 40).collect();
        let gone = again.pair(7).map(|e| e as u32);
        let mut whole = sorted.clone();
        whole.iter_mut().for_each(|b| b.ends = b.ends.map(|e| moved[e as usize]));
        let (mut followed, fresh) = (again.clone(), Columns::new(&whole, 40));
        followed.follow(&moved);
        assert!(!followed.in_order() && followed.ends != fresh.ends);
        let held = |c: &Columns<0>, place: usize| -> Vec<[u64; 2]> {
            let bond = |e: &u32| [c.length[*e as usize / 2].to_bits(), u64::from(e & 1)];
            c.of(place).iter().map(bond).collect()
        };
        assert!((0..40).all(|place| held(&followed, place) == held(&fresh, place)));
        followed.put_in_order();
        assert_eq!(format!("{followed:?}"), format!("{fresh:?}"));
        // Except for broken bonds.
        again.lose(7);
        again.follow(&moved);
        let mut left = sorted.clone();
        let at = left.iter().position(|b| b.ends == gone && b.length == new.length[7]).unwrap();
        left.remove(at);
        left.iter_mut().for_each(|b| b.ends = b.ends.map(|e| moved[e as usize]));
        assert_eq!(format!("{again:?}"), format!("{:?}", Columns::new(&left, 40)));
    }
}
