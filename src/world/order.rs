//! Which particle stands where: deletion and renumbering.

use super::World;
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

    /// Gives every particle its place in storage + 1 as id; contacts and bonds follow.
    pub fn renumber(&mut self) {
        self.rename((1..=self.n() as u32).collect());
    }

    /// Gives particles these ids, in storage order; contacts and bonds follow.
    pub fn rename(&mut self, ids: Vec<u32>) {
        let old = std::mem::replace(&mut self.particles.tag, ids);
        if self.contacts.is_empty() && self.wall_contacts.is_empty() && self.bonds.list.is_empty() {
            return;
        }
        let new: BTreeMap<u32, u32> = old.into_iter().zip(self.particles.tag.iter().copied()).collect();
        self.bonds.rename(|tag| new.get(&tag).copied());
        let pair = |[a, b]: [u32; 2]| {
            let (a, b) = (*new.get(&a)?, *new.get(&b)?);
            Some(([a.min(b), a.max(b)], a > b))
        };
        for c in self.contacts.values_mut() {
            c.rename(pair);
        }
        for c in self.wall_contacts.values_mut() {
            c.rename(|[a, part]| Some(([*new.get(&a)?, part], false)));
        }
    }
}

/// Who stands where after the marked ones are gone and each hole was filled from the end.
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

    #[test]
    fn holes_are_filled_from_the_end() {
        let marked = [false, true, false, true, false, true];
        // By hand: 5 goes (swapped into 1, itself marked), then 4 fills hole 1, then 3 goes.
        assert_eq!(left_after(&marked), [0, 4, 2]);
    }
}
