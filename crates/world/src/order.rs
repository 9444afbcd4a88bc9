//! Which particle stands where: the order of space during runs, deletion and renumbering.

use super::World;
use super::contacts::{mirror, swap_sides};
use super::index::Index;
use super::moving::Under;
use std::collections::BTreeMap;

impl World {
    /// Deletes the marked particles as LAMMPS does: the last particle moves into the first hole, and so on.
    /// With `renumber`, ids become storage order + 1 afterwards.
    pub fn delete(&mut self, marked: &[bool], renumber: bool) {
        self.gather(&left_after(marked));
        if renumber {
            self.renumber();
        }
    }

    /// Moves particle `old[k]` to index `k`, for as long as [`World::fall_back`] is not called: a run of grains keeps neighbours
    /// near each other in memory. No particle is added or removed.
    pub fn line_up(&mut self, old: &[usize]) {
        if old.iter().enumerate().all(|(new, k)| new == *k) {
            return;
        }
        if self.particles.rank.is_empty() {
            self.particles.rank = (0..self.n() as u32).collect();
        }
        self.particles.gather(old);
        self.columns.gather(old);
        self.slots.gather(old, old.len());
        self.tally.gather(old);
        let rebuild = &mut self.rebuild;
        gather_all(&mut rebuild.held, old);
        gather_all(&mut rebuild.kept.x, old);
        gather_all(&mut rebuild.kept.turns, old);
        // Lists made of indices are void.
        self.rebuild.generation += 1;
        self.rebuild.places += 1;
    }

    /// Puts the particles back into the order in which they were created.
    pub fn fall_back(&mut self) {
        let rank = &self.particles.rank;
        if rank.is_empty() {
            return;
        }
        let mut order: Vec<usize> = (0..rank.len()).collect();
        order.sort_unstable_by_key(|&k| rank[k]);
        self.line_up(&order);
        *self.particles.rank = Vec::new();
    }

    /// Drops the contacts of particles that have gone, between runs: a later particle with the same id is another one.
    pub fn forget_touches(&mut self) {
        let (contacts, walls) = (&mut self.contacts, &mut self.wall_contacts);
        if contacts.is_empty() && walls.is_empty() {
            return;
        }
        let tags = &self.particles.tag;
        let index = Index::new(tags);
        let here = |tag: u32| index.find(tag, tags).is_some();
        let same = |_: &mut [f64]| {};
        for c in contacts.values_mut() {
            c.rename(|[a, b]| (here(a) && here(b)).then_some(([a, b], false)), same);
        }
        for c in walls.values_mut() {
            c.rename(|[a, part]| here(a).then_some(([a, part], false)), same);
        }
    }

    /// Gives every particle its place in storage + 1 as id; contacts and bonds follow.
    pub fn renumber(&mut self) {
        self.rename((1..=self.n() as u32).collect());
    }

    /// Gives particles these ids, in storage order; contacts and bonds follow.
    pub fn rename(&mut self, ids: Vec<u32>) {
        let old = std::mem::replace(&mut *self.particles.tag, ids);
        if self.contacts.is_empty() && self.wall_contacts.is_empty() && self.bonds.list.is_empty() {
            return;
        }
        let new: BTreeMap<u32, u32> = old.into_iter().zip(self.particles.tag.iter().copied()).collect();
        self.bonds.rename(|tag| new.get(&tag).copied());
        let pair = |[a, b]: [u32; 2]| {
            let (a, b) = (*new.get(&a)?, *new.get(&b)?);
            Some(([a.min(b), a.max(b)], a > b))
        };
        for (key, c) in self.contacts.iter_mut() {
            c.rename(pair, if key.under() == Some(Under::Sides) { swap_sides } else { mirror });
        }
        for c in self.wall_contacts.values_mut() {
            c.rename(|[a, part]| Some(([*new.get(&a)?, part], false)), mirror);
        }
    }
}

/// Lets entry `old[k]` stand at `k`, if there is one for each.
fn gather_all<T: Copy>(list: &mut Vec<T>, old: &[usize]) {
    if list.len() == old.len() {
        *list = old.iter().map(|&k| list[k]).collect();
    }
}

/// The particle at each place after the marked ones are gone and each hole was filled from the end.
fn left_after(marked: &[bool]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..marked.len()).collect();
    let mut k = 0;
    while k < order.len() {
        if marked[order[k]] {
            order.swap_remove(k);
        } else {
            k += 1;
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Key;
    use crate::contacts::Contacts;

    #[test]
    fn holes_are_filled_from_the_end() {
        let marked = [false, true, false, true, false, true];
        // By hand: 5 goes (swapped into 1, itself marked), then 4 fills hole 1, then 3 goes.
        assert_eq!(left_after(&marked), [0, 4, 2]);
    }

    #[test]
    fn contacts_of_deleted_particles_are_dropped() {
        let mut w = World::default();
        (1..=3).for_each(|tag| w.particles.push(tag, 1, [f64::from(tag); 3]));
        let own = Key::new("own");
        let two = |keys: [[u32; 2]; 2]| Contacts { keys: keys.to_vec(), width: 1, history: vec![0.5, 0.25] };
        w.contacts.insert(own, two([[1, 2], [2, 3]]));
        w.wall_contacts.insert(own, two([[1, 3], [3, 0]]));
        w.delete(&[false, false, true], false);
        w.particles.push(3, 1, [0.0; 3]);
        w.particles.tag[2] = 4;
        w.forget_touches();
        assert_eq!(
            w.contacts.get(own).map(|c| (&c.keys[..], &c.history[..])),
            Some((&[[1, 2]][..], &[0.5][..]))
        );
        assert_eq!(w.wall_contacts.get(own).map(|c| &c.keys[..]), Some(&[[1, 3]][..]));
    }

    #[test]
    fn lined_up_particles_fall_back_with_all_their_data() {
        let mut w = World::default();
        (1..=4).for_each(|tag| w.particles.push(10 * tag, 1, [f64::from(tag); 3]));
        w.rebuild.held = w.particles.x.to_vec();
        let own = Key::new("own");
        *w.columns.scalar(own, 4) = vec![1.0, 2.0, 3.0, 4.0];
        let before = format!("{:?} {:?} {:?}", w.particles, w.columns, w.rebuild.held);
        w.line_up(&[2, 0, 3, 1]);
        assert_eq!(w.particles.tag, [30, 10, 40, 20]);
        w.line_up(&[1, 0, 2, 3]);
        assert_eq!(w.particles.tag, [10, 30, 40, 20]);
        assert_eq!(w.columns.get_scalar(own).unwrap(), [1.0, 3.0, 4.0, 2.0]);
        // One is lost on the way: the others stand as they would without.
        let mut less = w.clone();
        less.gather(&[0, 2, 3]);
        less.fall_back();
        assert_eq!(less.particles.tag, [10, 20, 40]);
        // A particle that joins meanwhile comes last.
        let mut more = w.clone();
        more.particles.push(50, 1, [5.0; 3]);
        more.columns.resize(5);
        more.fall_back();
        assert_eq!(more.particles.tag, [10, 20, 30, 40, 50]);
        w.fall_back();
        assert_eq!(format!("{:?} {:?} {:?}", w.particles, w.columns, w.rebuild.held), before);
    }
}
