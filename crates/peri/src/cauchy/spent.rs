//! Bonds whose ends bear nothing any more: both are damaged through, or their families are torn.

use crate::families::bond::Broken;
use crate::families::{Candidate, Families, PeriView};
use crate::shares::{LIST, square};

impl Families {
    /// Adds the living bonds between sites that were found spent in the last evaluation to those that break, but for bonds of particles
    /// that are `spared`.
    pub(crate) fn find_spent(&self, view: &PeriView, spared: &dyn Fn(u32) -> bool, broken: &mut Vec<Broken>) {
        let mut known: Vec<(usize, [u32; 2])> = broken.iter().map(|b| (b.body, b.bond.ends)).collect();
        known.sort_unstable();
        let mut found = |body: usize, ends: [usize; 2], bond: u32, particle: &[u32]| {
            let ends = ends.map(|site| site as u32);
            let particles = ends.map(|site| particle[site as usize]);
            if particles.iter().any(|p| spared(*p)) || known.binary_search(&(body, ends)).is_ok() {
                return;
            }
            let bond = Candidate { ends, bond, stretch: 1.0, s00: 1.0, alpha: 0.0 };
            broken.push(Broken { body, bond, square: square(view, particles) });
        };
        for (k, body) in self.lattices.iter().enumerate() {
            let spent = &body.state.continuum.spent;
            for &site in spent {
                body.around(site as usize, |other, owner, e| {
                    // From its owner, once.
                    if owner == site as usize && body.lives(owner, e) && is_in(spent, other) {
                        found(k, [owner, other], e as u32, &body.particle);
                    }
                });
            }
        }
        let (list, spent) = (&self.list, &self.list.state.continuum.spent);
        for &site in spent {
            for b in list.own(site as usize).filter(|b| list.lives(*b)) {
                let other = list.partner[b] as usize;
                if is_in(spent, other) {
                    found(LIST, [site as usize, other], b as u32, &list.particle);
                }
            }
        }
        broken.sort_by_key(|b| b.body);
    }

    /// Whether any site is spent.
    pub(crate) fn any_spent(&self) -> bool {
        let lattices = self.lattices.iter().map(|body| &body.state);
        lattices.chain([&self.list.state]).any(|state| !state.continuum.spent.is_empty())
    }
}

/// Whether a site is among these, which ascend.
fn is_in(spent: &[u32], site: usize) -> bool {
    spent.binary_search(&(site as u32)).is_ok()
}
