//! The end of a step: bonds break, and the step becomes the previous one.

use crate::breaking::{Bonds, find_broken};
use crate::evaluate::periods;
use crate::families::shares::BodyShare;
use crate::families::{Candidate, Cell, Families, Moved, PeriView};
use crate::lanes::isa::Isa;
use crate::list;
use crate::list::kernel::Rules;
use crate::shares::{Agreed, Broken, LIST, broken_everywhere, square};

/// What all ranks have agreed upon where work is shared out to them, and this rank's share of the list.
type Together<'a> = (Agreed, Option<&'a mut BodyShare>);

impl Families {
    /// Breaks bonds and makes this step the previous one.
    pub(super) fn advance<K: Isa>(&mut self, view: &PeriView, cell: &Cell, shared: Option<Together>) {
        let top = shared.as_ref().map(|(agreed, _)| agreed.top);
        if self.breaking_enabled {
            match shared {
                Some(shared) => self.break_bonds::<K>(view, cell, Some(shared)),
                None => self.break_and_count::<K>(view, cell),
            }
        }
        self.breaking_enabled = true;
        self.before = periods(&view.bounds).into();
        for body in &mut self.lattices {
            body.u.swap(0, 1);
        }
        list::keep(&mut self.list);
        list::breaking::roll(&mut self.list, top);
    }

    /// Breaks bonds; where work is shared out, all ranks break the same, in the order in which one process finds them.
    pub(super) fn break_bonds<K: Isa>(&mut self, view: &PeriView, cell: &Cell, shared: Option<Together>) {
        let (agreed, share) = shared.unzip();
        let mut found: Vec<Candidate> = std::mem::take(&mut self.scratch.candidates);
        let mut ends = std::mem::take(&mut self.scratch.ends);
        ends.clear();
        let lasting = &self.lasting;
        let spared = |p: u32| lasting.get(p as usize).copied().unwrap_or(false);
        let (kind, frees) = (self.law.kind, self.law.kind.frees(self.options.compat_lammps));
        let together = agreed.is_some_and(|agreed| agreed.breaks || agreed.strained);
        let mut all = vec![];
        for (k, body) in self.lattices.iter_mut().enumerate() {
            find_broken::<K, _>(body, &self.options, &mut found, &spared);
            if together {
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
        let rules = Rules::new(cell, &self.options, &self.law);
        let some = agreed.map_or_else(|| self.list.is_strained(), |agreed| agreed.strained);
        let scene = (&rules, &self.options);
        list::breaking::candidates::<K>(&mut self.list, scene, (share.flatten(), some), &mut found);
        self.list.spare(&mut found, &spared);
        if together {
            let particle = &self.list.particle;
            let of = |bond: &Candidate| square(view, bond.ends.map(|record| particle[record as usize]));
            all.extend(found.iter().map(|bond| Broken { body: LIST, bond: *bond, square: of(bond) }));
            all = broken_everywhere(all);
        }
        for (k, body) in self.lattices.iter_mut().enumerate().filter(|_| together) {
            found.clear();
            found.extend(all.iter().filter(|broken| broken.body == k).map(|broken| broken.bond));
            body.break_all(&found);
            for c in found.iter().filter(|_| frees) {
                body.free(c.ends[0] as usize, c.bond as usize, kind, Moved::Now);
            }
            ends.extend(found.iter().map(|c| c.ends.map(|cell| body.particle[cell as usize])));
        }
        if together {
            found.clear();
            found.extend(all.iter().filter(|broken| broken.body == LIST).map(|broken| broken.bond));
        }
        self.list.break_all(&found);
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
