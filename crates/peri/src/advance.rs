//! The end of a step: bonds break, and the step becomes the previous one.

use crate::breaking::{Bonds, find_broken};
use crate::evaluate::periods;
use crate::families::bond::Broken;
use crate::families::shares::BodyShare;
use crate::families::{Candidate, Cell, Criterion, Families, Moved, PeriView};
use crate::list;
use crate::list::breaking::candidates;
use crate::list::kernel::Rules;
use crate::shares::{Agreed, LIST, broken_everywhere, square};

/// What all ranks have agreed upon where work is shared out to them, and this rank's share of the list.
type Together<'a> = (Agreed, Option<&'a mut BodyShare>);

impl Families {
    /// Breaks bonds and makes this step the previous one.
    pub(super) fn advance(&mut self, view: &PeriView, cell: &Cell, shared: Option<Together>) {
        let top = shared.as_ref().map(|(agreed, _)| agreed.top);
        if self.options.criterion == Criterion::Work {
            self.work_on_bonds(view, cell);
        }
        if self.breaking_enabled {
            match shared {
                Some(shared) => self.break_bonds(view, cell, Some(shared)),
                None => self.break_and_count(view, cell),
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
    pub(super) fn break_bonds(&mut self, view: &PeriView, cell: &Cell, shared: Option<Together>) {
        let (agreed, share) = shared.unzip();
        let mut broken = std::mem::take(&mut self.scratch.broken);
        broken.clear();
        let some = agreed.map_or_else(|| self.list.is_strained(), |agreed| agreed.strained);
        match self.options.criterion {
            Criterion::Stretch => self.find_all(view, cell, (share.flatten(), some), &mut broken),
            _ => self.find_by_criterion(view, cell, &mut broken),
        }
        if let Some(share) = self.breaking_share {
            keep_weakest(&mut broken, share);
        }
        if self.any_spent() {
            let spared = |p: u32| self.lasting.get(p as usize).copied().unwrap_or(false);
            self.find_spent(view, &spared, &mut broken);
        }
        if agreed.is_some_and(|agreed| agreed.breaks || agreed.strained) {
            broken = broken_everywhere(broken);
        }
        self.tear(view, cell, &broken, Moved::Now);
        self.scratch.broken = broken;
    }

    /// Breaks bonds, those of each body together and those of the list last; what they remember belongs to the displacements `moved`.
    pub(super) fn tear(&mut self, view: &PeriView, cell: &Cell, broken: &[Broken], moved: Moved) {
        let (kind, frees) = (self.law.kind, self.law.kind.frees(self.options.compat_lammps));
        let mut bonds = std::mem::take(&mut self.scratch.candidates);
        let mut ends = std::mem::take(&mut self.scratch.ends);
        ends.clear();
        let mut rest = broken;
        for (k, body) in self.lattices.iter_mut().enumerate() {
            let own;
            (own, rest) = rest.split_at(rest.partition_point(|broken| broken.body <= k));
            bonds.clear();
            bonds.extend(own.iter().map(|broken| broken.bond));
            body.break_all(&bonds);
            for c in bonds.iter().filter(|_| frees) {
                body.free(c.ends[0] as usize, c.bond as usize, &kind, moved);
            }
            ends.extend(bonds.iter().map(|c| c.ends.map(|cell| body.particle[cell as usize])));
        }
        bonds.clear();
        bonds.extend(rest.iter().map(|broken| broken.bond));
        self.list.break_all(&bonds);
        for c in bonds.iter().filter(|_| frees) {
            self.list.free(c.bond as usize, &self.law, cell, moved);
        }
        ends.extend(bonds.iter().map(|c| c.ends.map(|record| self.list.particle[record as usize])));
        for (&[i, j], broken) in ends.iter().zip(broken) {
            self.damaged[i as usize] = true;
            self.damaged[j as usize] = true;
            self.add_broken(view, (i, j), broken.square);
        }
        if kind.correspondence {
            self.reshape(view, &ends);
        }
        (self.scratch.candidates, self.scratch.ends) = (bonds, ends);
    }

    /// Finds the bonds that break, body by body, those of the list last; see [`candidates`] for `list`.
    fn find_all(
        &mut self,
        view: &PeriView,
        cell: &Cell,
        list: (Option<&mut BodyShare>, bool),
        broken: &mut Vec<Broken>,
    ) {
        let (form, mut found) = (self.form(), std::mem::take(&mut self.scratch.candidates));
        let lasting = &self.lasting;
        let spared = |p: u32| lasting.get(p as usize).copied().unwrap_or(false);
        let mut note = |body: usize, found: &[Candidate], particle: &[u32]| {
            let square = |bond: &Candidate| square(view, bond.ends.map(|site| particle[site as usize]));
            broken.extend(found.iter().map(|bond| Broken { body, bond: *bond, square: square(bond) }));
        };
        for (k, body) in self.lattices.iter_mut().enumerate() {
            find_broken(form, body, &self.options, &mut found, &spared);
            note(k, &found, &body.particle);
        }
        let rules = Rules::new(cell, &self.options, self.law.counting());
        candidates(form, &mut self.list, (&rules, &self.options), list, &mut found);
        self.list.spare(&mut found, &spared);
        note(LIST, &found, &self.list.particle);
        self.scratch.candidates = found;
    }
}

/// Stretches over the critical one that differ by no more than this are equal: those of bonds that a symmetry maps to each other.
const EQUAL: f64 = 1e-9;

/// Keeps the bonds stretched most over their critical stretch, those that are as stretched, and a share of the others, the
/// most stretched first; in their order.
fn keep_weakest(broken: &mut Vec<Broken>, share: f64) {
    let ratio = |broken: &Broken| broken.bond.stretch / broken.bond.s00;
    let mut ratios: Vec<f64> = broken.iter().map(ratio).collect();
    ratios.sort_unstable_by(|a, b| b.total_cmp(a));
    let Some(most) = ratios.first().copied() else { return };
    let some = (share * ratios.len() as f64).floor() as usize;
    let limit = ratios.get(some).copied().map_or(most, |r| r.min(most)) * (1.0 - EQUAL);
    broken.retain(|bond| ratio(bond) >= limit);
}
