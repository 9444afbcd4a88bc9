//! The end of a step: bonds break, and the step becomes the previous one.

use crate::breaking::{Bonds, find_broken};
use crate::evaluate::periods;
use crate::families::{Candidate, Cell, Families, Moved, PeriView};
use crate::lanes::isa::Isa;
use crate::list;
use crate::list::kernel::Rules;
use crate::shares::{Broken, broken_everywhere, square};

impl Families {
    /// Breaks bonds and makes this step the previous one. `shared`: whether bonds of any rank may break, where work is shared out.
    pub(super) fn advance<K: Isa>(&mut self, view: &PeriView, cell: &Cell, shared: Option<bool>) {
        if self.breaking_enabled {
            match shared {
                Some(breaks) => self.break_bonds::<K>(view, cell, breaks),
                None => self.break_and_count::<K>(view, cell),
            }
        }
        self.breaking_enabled = true;
        self.before = periods(&view.bounds).into();
        for body in &mut self.lattices {
            body.u.swap(0, 1);
        }
        list::keep(&mut self.list);
        list::breaking::roll(&mut self.list);
    }

    /// Breaks bonds; where some of other ranks may break too (`shared`), all ranks break the same.
    pub(super) fn break_bonds<K: Isa>(&mut self, view: &PeriView, cell: &Cell, shared: bool) {
        let mut found: Vec<Candidate> = std::mem::take(&mut self.scratch.candidates);
        let mut ends = std::mem::take(&mut self.scratch.ends);
        ends.clear();
        let lasting = &self.lasting;
        let spared = |p: u32| lasting.get(p as usize).copied().unwrap_or(false);
        let (kind, frees) = (self.law.kind, self.law.kind.frees(self.options.compat_lammps));
        let mut all = vec![];
        for (k, body) in self.lattices.iter_mut().enumerate() {
            find_broken::<K, _>(body, &self.options, &mut found, &spared);
            if shared {
                let of = |bond: &Candidate| square(view, bond.ends.map(|cell| body.particle[cell as usize]));
                all.extend(found.iter().map(|bond| Broken { body: k, bond: *bond, square: of(bond) }));
                continue;
            }
            body.break_all(&found);
            for c in found.iter().filter(|_| frees) {
                body.free(c.ends[0] as usize, c.bond as usize, kind, Moved::Now);
            }
            ends.extend(found.iter().map(|c| c.ends.map(|cell| body.particle[cell as usize])));
        }
        let all = if shared { broken_everywhere(all) } else { all };
        for (k, body) in self.lattices.iter_mut().enumerate().filter(|_| shared) {
            let own = all.iter().filter(|broken| broken.body == k).map(|broken| broken.bond);
            found.clear();
            found.extend(own);
            body.break_all(&found);
            for c in found.iter().filter(|_| frees) {
                body.free(c.ends[0] as usize, c.bond as usize, kind, Moved::Now);
            }
            ends.extend(found.iter().map(|c| c.ends.map(|cell| body.particle[cell as usize])));
        }
        let rules = Rules::new(cell, &self.options, &self.law);
        list::breaking::candidates::<K>(&mut self.list, (&rules, &self.options), &mut found);
        self.list.break_all(&mut found, &spared);
        for c in found.iter().filter(|_| frees) {
            self.list.free(c.bond as usize, &self.law, cell, Moved::Now);
        }
        ends.extend(found.iter().map(|c| c.ends.map(|record| self.list.particle[record as usize])));
        for (k, &[i, j]) in ends.iter().enumerate() {
            self.damaged[i as usize] = true;
            self.damaged[j as usize] = true;
            // The ends of other ranks' bonds are up to date on those ranks alone, which have sent the square.
            let told = all.get(k).map(|broken| broken.square);
            self.add_broken(view, (i, j), told.unwrap_or_else(|| square(view, [i, j])));
        }
        self.scratch.candidates = found;
        self.scratch.ends = ends;
    }
}
