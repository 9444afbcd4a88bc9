//! Which particles belonged to one family at the start, and whether the bond between two still lives: for contacts.

use crate::families::Families;
use crate::families::list::GROUP;

impl Families {
    /// Whether two particles are kept from touching by their family: they belonged to one at the start, by their distance
    /// then, and, where those whose bond is broken meet again, their bond lives. Families from a table of bonds leave this
    /// to `special_bonds`.
    pub fn related(&self, x0: &[[f64; 3]], kind: &[u16], i: usize, j: usize) -> bool {
        if !self.of_bonds.is_empty() {
            return false;
        }
        let has = |i: usize| self.family_size.get(i).is_some_and(|n| *n > 0);
        let Some(coeff) = self.table.get(kind[i], kind[j]).filter(|_| has(i) && has(j)) else { return false };
        let start = self.reference.as_deref().unwrap_or(x0);
        let reach = self.options.volume.reach(coeff.horizon, self.options.lattice_spacing);
        let period = self.birth.periods();
        let turns = period.turns(std::array::from_fn(|d| start[i][d] - start[j][d]));
        let by = period.shift(turns);
        let square = |d: usize| (start[i][d] - start[j][d] - by[d]).powi(2);
        square(0) + square(1) + square(2) <= reach * reach
            && (!self.options.reunite || self.lives_between(i, j))
    }

    /// Whether a living bond joins two particles.
    fn lives_between(&self, i: usize, j: usize) -> bool {
        let (i, j) = (i as u32, j as u32);
        self.body_of(i) == self.body_of(j) && self.bonded(i, j)
    }

    /// Whether a living bond joins two particles of one body.
    pub fn bonded(&self, i: u32, j: u32) -> bool {
        let (a, b) = (self.place[i as usize], self.place[j as usize]);
        let body = self.body_of(i) as usize;
        let Some(lattice) = self.lattices.get(body) else {
            let (a, b) = (a - self.list.first_place, b - self.list.first_place);
            let list = &self.list;
            let joins = |i: u32, j: u32| {
                let groups = list.start[i as usize] as usize..list.start[i as usize + 1] as usize;
                // Groups are compared as wholes.
                groups.into_iter().filter(|group| list.alive[*group] != 0).any(|group| {
                    let partners = &list.partner[GROUP * group..GROUP * (group + 1)];
                    let equal = (0..GROUP).fold(0, |bits, k| bits | u8::from(partners[k] == j) << k);
                    equal & list.alive[group] != 0
                })
            };
            return joins(a, b) || joins(b, a);
        };
        let (a, b) = ((a - lattice.first_place) as usize, (b - lattice.first_place) as usize);
        let step = lattice.step(a, b);
        let after = (step[2], step[1], step[0]) > (0, 0, 0);
        let (from, step) = if after { (a, step) } else { (b, step.map(|s| -s)) };
        let found =
            lattice.stencil.binary_search_by_key(&(step[0], step[2], step[1]), |s| (s[0], s[2], s[1]));
        found.is_ok_and(|e| lattice.lives(from, e))
    }

    /// Which body a particle belongs to: lattices from 0, then the list; every loose particle is its own.
    pub(crate) fn body_of(&self, p: u32) -> u32 {
        let place = self.place.get(p as usize).copied().unwrap_or(u32::MAX);
        if place == u32::MAX {
            return u32::MAX;
        }
        self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place) as u32
    }

    /// Whether a bond between two particles that `meet` says yes to has broken in the step that was just advanced.
    pub fn parted(&self, meet: impl Fn(usize) -> bool) -> bool {
        self.scratch.ends.iter().any(|ends| ends.iter().all(|&i| meet(i as usize)))
    }
}
