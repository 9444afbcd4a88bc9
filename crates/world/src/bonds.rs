//! Bonds between particles by their ids, and which pairs they exempt from pair forces (`special_bonds`).

use super::angles::Angles;
use super::index::Index;
use perigrain_base::math::body::{self, Quat, UNTURNED, back};
use perigrain_base::math::vec3::{Vec3, scale};
use std::collections::{BTreeMap, BTreeSet};

/// A bond.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bond {
    /// Type from 1; negative while it is turned off (`delete_bonds`).
    pub kind: i32,
    /// The ids of its ends; it is listed with the first.
    pub ends: [u32; 2],
    /// Length at rest, as a bond style has measured it [length]; 0 before.
    pub length: f64,
    /// Unit vector at rest from the end with the higher ID to the other, as the former carries it, where a bond style has measured
    /// it; 0 before.
    pub axis: Vec3,
}

impl Bond {
    /// A bond without a measured length.
    pub fn new(kind: i32, ends: [u32; 2]) -> Self {
        Self { kind, ends, length: 0.0, axis: [0.0; 3] }
    }

    /// Whether it acts.
    pub fn is_on(&self) -> bool {
        self.kind > 0
    }
}

/// By how much pair forces count between particles one, two and three bonds apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Weights {
    /// Of all pair styles here.
    pub lj: [f64; 3],
    /// For electric forces, which do not exist here: only `create_bonds` and bond styles read them.
    pub coul: [f64; 3],
}

/// What becomes of a run in which a bond has lost one of its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum LostBond {
    /// It ends.
    #[default]
    Error,
    /// The bond exerts no force; a warning is given once.
    Warn,
    /// The bond exerts no force.
    Ignore,
}

/// The ids of two ends, the lower first.
pub fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// All bonds of a scene.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Bonds {
    /// Number of bond types.
    pub types: usize,
    /// The bonds, in the order in which they were made.
    pub list: Vec<Bond>,
    /// Of bonds whose ends were turned against each other when a bond style first saw them: the turn from the end with the lower
    /// ID to the other, by the ids of the ends, the lower first.
    pub turned: BTreeMap<[u32; 2], Quat>,
    /// For bonds that keep one more number (the length at rest of those that have yielded [length]), by the ids of their ends,
    /// the lower first.
    #[serde(default)]
    pub memory: BTreeMap<[u32; 2], f64>,
    /// `special_bonds`.
    pub weights: Weights,
    /// The pairs that count as bonded for the weights, ascending: as bonds were when this was last decided.
    pub special: Vec<[u32; 2]>,
    /// The bond style in force and its coefficients by type, as a data file has them.
    pub coeffs: Option<(String, BTreeMap<usize, String>)>,
    /// What becomes of a run in which a bond has lost one of its ends (`thermo_modify lost/bond`).
    #[serde(default)]
    pub lost: LostBond,
    /// The forces of peridynamic bonds are true ones, not such per volume (`bond_style bpm/peri force newton`).
    #[serde(default)]
    pub newton: bool,
    /// A ledger of energy is kept, which needs the next two.
    #[serde(default)]
    pub counts_losses: bool,
    /// The energy of bonds that have broken since then [energy].
    #[serde(default)]
    pub released: f64,
    /// What the dashpots of bonds take up at the present step, by bond type, from 0 [force length/time]: each style adds up its own.
    #[serde(default)]
    pub power: Vec<f64>,
    /// Angles between bonds.
    #[serde(default)]
    pub angles: Angles,
    /// Grows with every change of the list or of what is special, so that others notice.
    pub changes: u64,
    /// How many have gone with both ends through a face: LAMMPS counts these until a command deletes atoms.
    #[serde(skip)]
    pub left: usize,
}

impl Bonds {
    /// Number of bonds.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds a bond; what is special stays until it is decided anew.
    pub fn push(&mut self, bond: Bond) {
        self.list.push(bond);
        self.changes += 1;
    }

    /// Keeps the bonds that `keep` lets pass.
    pub fn retain(&mut self, keep: impl FnMut(&Bond) -> bool) {
        self.list.retain(keep);
        self.forget_memory();
        self.changes += 1;
    }

    /// Removes broken bonds, given by the ids of their ends, the lower first, and their type, ascending. Pair forces act between
    /// their ends from then on.
    pub fn lose(&mut self, broken: &[([u32; 2], i32)]) {
        let place = |ends: &[u32; 2]| broken.partition_point(|(b, _)| b < ends);
        let parted = |ends: &[u32; 2]| broken.get(place(ends)).is_some_and(|(b, _)| b == ends);
        let mut held = vec![];
        self.list.retain(|b| {
            let ends = ascending(b.ends);
            let holds = broken.binary_search(&(ends, b.kind)).is_err();
            if holds && parted(&ends) {
                held.push(ends);
            }
            holds
        });
        self.special.retain(|p| !parted(p));
        self.angles.part(|side| parted(&ascending(side)));
        // Another bond may join the same ends.
        for (ends, _) in broken.iter().filter(|(ends, _)| !held.contains(ends)) {
            self.turned.remove(ends);
            self.memory.remove(ends);
        }
        self.changes += 1;
    }

    /// Removes the entries of bonds that are gone.
    fn forget_memory(&mut self) {
        if self.turned.is_empty() && self.memory.is_empty() {
            return;
        }
        let mut there: Vec<[u32; 2]> = self.list.iter().map(|b| ascending(b.ends)).collect();
        there.sort_unstable();
        self.turned.retain(|ends, _| there.binary_search(ends).is_ok());
        self.memory.retain(|ends, _| there.binary_search(ends).is_ok());
    }

    /// Takes away the bonds between some pairs of ids, and lets pair forces act between them; `pairs` ascend, the lower id
    /// of each first.
    pub fn part(&mut self, pairs: &[[u32; 2]]) {
        let parted = |ends: [u32; 2]| pairs.binary_search(&ascending(ends)).is_ok();
        self.list.retain(|b| !parted(b.ends));
        self.special.retain(|p| !parted(*p));
        self.angles.part(parted);
        self.forget_memory();
        self.changes += 1;
    }

    /// Decides anew which pairs count as bonded: those of all present bonds, turned off or not.
    pub fn find_special(&mut self) {
        self.special = self.list.iter().map(|b| ascending(b.ends)).collect();
        self.special.sort_unstable();
        self.special.dedup();
        self.changes += 1;
    }

    /// Removes bonds of which both ends are gone; those with one end left are an error of the next run.
    pub fn forget_lone(&mut self, tags: &[u32]) {
        let (there, before): (BTreeSet<u32>, _) = (tags.iter().copied().collect(), self.len());
        self.list.retain(|b| b.ends.iter().any(|t| there.contains(t)));
        self.left += before - self.len();
        self.special.retain(|p| p.iter().any(|t| there.contains(t)));
        self.angles.keep(|t| there.contains(&t));
        self.forget_memory();
        self.changes += 1;
    }

    /// Renames particles; bonds of those without a new id are gone.
    pub fn rename(&mut self, new: impl Fn(u32) -> Option<u32>) {
        let both = |ends: [u32; 2]| Some([new(ends[0])?, new(ends[1])?]);
        let turned = std::mem::take(&mut self.turned);
        let mut list = vec![];
        for b in &self.list {
            let Some(ends) = both(b.ends) else { continue };
            let swapped = (ends[0] < ends[1]) != (b.ends[0] < b.ends[1]);
            let mut turn = turned.get(&ascending(b.ends)).copied().unwrap_or(UNTURNED);
            let mut axis = b.axis;
            if swapped {
                // As the other end carries it, and from there.
                axis = scale(-1.0, body::turned(turn, axis));
                turn = back(turn);
            }
            if turned.contains_key(&ascending(b.ends)) {
                self.turned.insert(ascending(ends), turn);
            }
            list.push(Bond { ends, axis, ..*b });
        }
        self.list = list;
        let memory = std::mem::take(&mut self.memory);
        self.memory = memory.into_iter().filter_map(|(ends, m)| Some((ascending(both(ends)?), m))).collect();
        self.special = self.special.iter().filter_map(|p| both(*p)).map(ascending).collect();
        self.special.sort_unstable();
        self.angles.rename(new);
        self.changes += 1;
    }

    /// The bonds in the order of LAMMPS' lists: by the place of the first end in storage.
    pub fn by_owner(&self, tags: &[u32]) -> Vec<Bond> {
        let index = Index::new(tags);
        let mut list: Vec<(usize, Bond)> =
            self.list.iter().filter_map(|b| Some((index.find(b.ends[0], tags)?, *b))).collect();
        list.sort_by_key(|(place, _)| *place);
        list.into_iter().map(|(_, b)| b).collect()
    }

    /// Pairs at most `far` bonds apart with the least number of bonds between them, by ids, ascending.
    pub fn apart(&self, far: u8) -> Vec<([u32; 2], u8)> {
        let near = Near::new(&self.special);
        let mut out = vec![];
        for (k, &id) in near.ids.iter().enumerate() {
            for (apart, ring) in (1..).zip(near.rings(k, far)) {
                let later = ring.into_iter().map(|m| near.ids[m]).filter(|other| *other > id);
                out.extend(later.map(|other| ([id, other], apart)));
            }
        }
        out.sort_unstable();
        out
    }

    /// The pairs without pair forces: those whose weight is zero, ascending.
    pub fn barred(&self) -> Vec<[u32; 2]> {
        let far = (1..=3).rev().find(|k| self.weights.lj[*k - 1] == 0.0).unwrap_or(0);
        if far == 1 {
            return self.special.clone();
        }
        let pairs = if far > 0 { self.apart(far as u8) } else { vec![] };
        let zero = |apart: u8| self.weights.lj[usize::from(apart) - 1] == 0.0;
        pairs.into_iter().filter(|(_, apart)| zero(*apart)).map(|(p, _)| p).collect()
    }

    /// The pairs whose forces count in part, with their weights between 0 and 1, ascending.
    pub fn weakened(&self) -> Vec<([u32; 2], f64)> {
        let weight = |apart: u8| self.weights.lj[usize::from(apart) - 1];
        let in_part = |apart: u8| weight(apart) > 0.0 && weight(apart) < 1.0;
        let far = (1..=3).rev().find(|k| in_part(*k)).unwrap_or(0);
        let pairs = if far > 0 { self.apart(far) } else { vec![] };
        pairs.into_iter().filter(|(_, k)| in_part(*k)).map(|(p, k)| (p, weight(k))).collect()
    }

    /// Whether two particles are joined by a bond that counts.
    pub fn joined(&self, a: u32, b: u32) -> bool {
        self.special.binary_search(&ascending([a, b])).is_ok()
    }
}

/// The partners of each particle in bonds, by places in a sorted list of ids.
struct Near {
    ids: Vec<u32>,
    partners: Vec<Vec<usize>>,
}

impl Near {
    fn new(pairs: &[[u32; 2]]) -> Self {
        let mut ids: Vec<u32> = pairs.iter().flatten().copied().collect();
        ids.sort_unstable();
        ids.dedup();
        let mut partners = vec![vec![]; ids.len()];
        let place = |id: u32| ids.binary_search(&id).unwrap_or(0);
        for [a, b] in pairs {
            let (a, b) = (place(*a), place(*b));
            partners[a].push(b);
            partners[b].push(a);
        }
        Self { ids, partners }
    }

    /// Those at exactly 1, 2 … `far` bonds from `k`.
    fn rings(&self, k: usize, far: u8) -> Vec<Vec<usize>> {
        let mut seen = BTreeSet::from([k]);
        let mut edge = vec![k];
        (0..far)
            .map(|_| {
                let mut next = vec![];
                for m in edge.iter().flat_map(|&m| &self.partners[m]) {
                    if seen.insert(*m) {
                        next.push(*m);
                    }
                }
                edge.clone_from(&next);
                next
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain() -> Bonds {
        let mut b = Bonds { types: 1, ..Bonds::default() };
        for ends in [[2, 1], [2, 3], [4, 3], [4, 5]] {
            b.push(Bond::new(1, ends));
        }
        b.find_special();
        b
    }

    #[test]
    fn pairs_at_one_two_and_three_bonds() {
        let mut b = chain();
        // Counted by hand: a chain of five.
        let near = b.apart(2);
        assert_eq!(near.iter().filter(|p| p.1 == 1).count(), 4);
        assert_eq!(
            near.iter().filter(|p| p.1 == 2).map(|p| p.0).collect::<Vec<_>>(),
            [[1, 3], [2, 4], [3, 5]]
        );
        assert_eq!(b.barred().len(), 9);
        b.weights.lj = [0.0, 1.0, 1.0];
        assert_eq!(b.barred(), [[1, 2], [2, 3], [3, 4], [4, 5]]);
        assert!(b.weakened().is_empty());
        b.weights.lj = [0.0, 0.5, 1.0];
        assert_eq!(b.weakened(), [([1, 3], 0.5), ([2, 4], 0.5), ([3, 5], 0.5)]);
        b.weights.lj = [1.0; 3];
        assert!(b.barred().is_empty() && b.joined(3, 4) && !b.joined(1, 3));
    }

    #[test]
    fn bonds_follow_their_particles() {
        let mut b = chain();
        b.forget_lone(&[1, 2, 3]);
        assert_eq!(b.list.iter().map(|b| b.ends).collect::<Vec<_>>(), [[2, 1], [2, 3], [4, 3]]);
        b.rename(|tag| (tag < 4).then(|| 10 - tag));
        assert_eq!(b.special, [[7, 8], [8, 9]]);
        // The lower id is now at the other end.
        let axis = [0.6, 0.0, 0.8];
        let turn = body::turn([0.0, 1.0, 0.0], 0.3);
        b.list[0].axis = axis;
        b.turned.insert(ascending(b.list[0].ends), turn);
        let before = b.clone();
        b.rename(|tag| Some(20 - tag));
        assert_eq!(b.list[0].axis, body::turned(turn, axis).map(|a| -a));
        b.rename(|tag| Some(20 - tag));
        let same = b.list[0].axis.iter().zip(&axis).all(|(a, b)| (a - b).abs() < 1e-15);
        assert!(same && b.turned == before.turned);
        b.list[0].axis = axis;
        assert_eq!(b.list, before.list);
        b.lose(&[(ascending(b.list[0].ends), 1)]);
        assert!(b.turned.is_empty() && b.len() == 1 && b.special.len() == 1);
        let b = before;
        let owners: Vec<[u32; 2]> = b.by_owner(&[7, 8, 9]).iter().map(|b| b.ends).collect();
        assert_eq!(owners, [[8, 9], [8, 7]]);
    }
}
