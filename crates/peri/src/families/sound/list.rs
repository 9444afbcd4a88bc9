//! Whether bonds kept as a list fit together: records in slabs, groups of bonds, and the ways back.

use super::{Fault, equal, must, numbers, states, states_are_numbers, works};
use crate::families::Law;
use crate::families::list::{GROUP, ListBody};
use perigrain_base::math::vec3::Vec3;

impl ListBody {
    /// See `Families::sound`.
    pub(super) fn sound(&self, (law, types, of_bonds): (&Law, usize, usize), reference: &[Vec3]) -> Fault {
        self.columns_are_sound(types, of_bonds)?;
        let slab_of = self.slabs_are_sound()?;
        self.bonds_are_sound(&slab_of)?;
        self.ways_back_are_sound()?;
        for (record, &p) in self.record.iter().zip(&self.particle).filter(|(_, p)| **p != u32::MAX) {
            let Some(&x) = reference.get(p as usize) else {
                return Err(format!("particle number {p} is none of the scene"));
            };
            let known = record.reference == x || !x.iter().all(|x| x.is_finite());
            must(known, "a record's reference position is not where its particle was")?;
        }
        let n = self.record.len();
        states(&self.state, &law.kind, (n, 0, self.partner.len()))?;
        states_are_numbers(&self.state)?;
        works((&self.work, &self.life), self.partner.len())?;
        numbers("former displacements", self.last.as_flattened())?;
        let constants =
            self.pairs.iter().flat_map(|p| [&p.c, &p.shape, &p.s00, &p.alpha, &p.horizon, &p.yields]);
        numbers("constants", constants)?;
        let touched = self.state.touched.len();
        must(touched == 0 || touched == n, "its records and those that are touched differ in number")?;
        let awake = self.state.awake.len();
        must(awake == 0 || awake == self.slabs(), "its slabs and those that ever woke differ in number")
    }

    /// Columns have an entry for each record or group; types and constants are there.
    fn columns_are_sound(&self, types: usize, of_bonds: usize) -> Fault {
        let (n, groups, kinds) = (self.record.len(), self.owner.len(), self.kinds.len());
        // A list without bonds has no such ends.
        let ends = |len: usize| if n == 0 && len == 0 { 0 } else { n + 1 };
        for (what, len, expected) in [
            ("particles", self.particle.len(), n),
            ("former displacements", self.last.len(), n),
            ("types of records", self.kind.len(), n),
            ("smallest stretches", self.lowest.len(), n),
            ("first groups", self.start.len(), ends(self.start.len())),
            ("first ways back", self.back_start.len(), ends(self.back_start.len())),
            ("first close bonds", self.close_start.len(), ends(self.close_start.len())),
            ("partners", self.partner.len(), GROUP * groups),
            ("bits of bonds", self.alive.len(), groups),
            ("types of groups", self.group_kind.len(), groups),
            ("moving slabs", self.moving.len(), self.slabs()),
            ("pairs of types", self.pairs.len(), if of_bonds > 0 { of_bonds } else { kinds * kinds }),
        ] {
            equal(&format!("the number of its {what} is"), len, expected)?;
        }
        let own = &self.own_weight;
        must(own.is_empty() || own.len() == GROUP * groups, "its weights and bonds differ in number")?;
        must(own.iter().all(|w| w.is_finite() && *w >= 0.0), "a bond weighs less than nothing")?;
        must(self.scatter.fits(n), "it has factors of more or fewer records")?;
        must(self.partner.len() < u32::MAX as usize, "it has more bonds than can be numbered")?;
        must(of_bonds == 0 || kinds <= 1, "it has several types beside those of bonds")?;
        must(
            self.kinds.iter().all(|k| (1..=types).contains(&usize::from(*k))),
            "a type of it is none of the scene",
        )?;
        must(self.kind.iter().all(|k| usize::from(*k) < kinds), "the type of a record is none of its types")?;
        let most = if of_bonds > 0 { of_bonds } else { kinds };
        must(
            self.group_kind.iter().all(|k| usize::from(*k) < most),
            "the type of a group is none of its types",
        )
    }

    /// Slabs follow each other; the slab of each record.
    fn slabs_are_sound(&self) -> Result<Vec<u32>, String> {
        let n = self.record.len();
        ascends(&self.slab, n, "slabs")?;
        must(n > 0 || self.slabs() == 0, "it has slabs and no records")?;
        let mut slab_of = vec![0; n];
        for (s, ends) in self.slab.windows(2).enumerate() {
            slab_of[ends[0] as usize..ends[1] as usize].fill(s as u32);
        }
        Ok(slab_of)
    }

    /// Bonds lead from their owner to a later record, or in a ring from a slab to an earlier one; living ones from particle to particle.
    fn bonds_are_sound(&self, slab_of: &[u32]) -> Fault {
        ascends(&self.start, self.owner.len(), "first groups")?;
        for i in 0..self.record.len() {
            for b in self.own(i) {
                equal("the owner of a group is", self.owner[b / GROUP] as usize, i)?;
                let j = self.partner[b] as usize;
                let Some(&slab) = slab_of.get(j) else { return Err("a bond leads to no record".into()) };
                let closes = self.ring && slab < slab_of[i];
                must(j >= i || closes, "a bond leads back to a record before its owner")?;
                let there = |r: usize| self.particle[r] != u32::MAX;
                must(
                    !self.lives(b) || (j != i && there(i) && there(j)),
                    "a living bond leads to no particle",
                )?;
            }
        }
        let places = self.partner.len();
        must(self.broken.iter().all(|b| (*b as usize) < places), "a bond that broke was none")
    }

    /// All bonds are found from their other end, and those that can come close from their own.
    fn ways_back_are_sound(&self) -> Fault {
        ascends(&self.back_start, self.back.len(), "first ways back")?;
        ascends(&self.close_start, self.close.len(), "first close bonds")?;
        let bonds = (0..self.partner.len()).filter(|b| self.partner[*b] != self.owner[b / GROUP]).count();
        equal("the number of its ways back is", self.back.len(), bonds)?;
        for i in 0..self.record.len() {
            let back = &self.back[self.back_start[i] as usize..self.back_start[i + 1] as usize];
            let leads = |b: &u32| {
                let b = *b as usize;
                self.partner.get(b) == Some(&(i as u32)) && self.owner[b / GROUP] as usize != i
            };
            must(
                back.is_sorted_by(|a, b| a < b) && back.iter().all(leads),
                "a way back leads to another bond",
            )?;
            if self.close_start.is_empty() {
                continue;
            }
            let close = &self.close[self.close_start[i] as usize..self.close_start[i + 1] as usize];
            must(
                close.iter().all(|c| self.own(i).contains(&(c.1 as usize))),
                "a close bond is another record's",
            )?;
            must(close.is_sorted_by(|a, b| a.0 >= b.0), "close bonds are out of order")?;
        }
        Ok(())
    }
}

/// A fault unless places begin with 0, never fall, and end with `end`; none are fine where there is nothing.
fn ascends(places: &[u32], end: usize, what: &str) -> Fault {
    let well = match (places.first(), places.last()) {
        (Some(first), Some(last)) => *first == 0 && places.is_sorted() && *last as usize == end,
        _ => end == 0,
    };
    if well { Ok(()) } else { Err(format!("its {what} are out of order")) }
}
