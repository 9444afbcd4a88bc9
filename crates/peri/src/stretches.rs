//! What single bonds and particles show of their stretches: LAMMPS' critical stretch, first lengths, their pull.

use crate::breaking::{Bonds, banded};
use crate::families::list::GROUP;
use crate::families::{Families, PeriView};
use crate::law::kernels::Alone;
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::weighing::{self, Weighing};
use perigrain_base::math::vec3::{Vec3, sub};

impl Families {
    /// s0 = max (s00 − alpha s) over the bonds that each particle had before the last step broke some, s being their
    /// stretches in that step; the largest number there is for particles that had none, and for all before the first step.
    pub fn critical_stretches(&self, view: &PeriView) -> Vec<f64> {
        let mut all = vec![f64::MAX; view.x.len()];
        if !self.breaking_enabled {
            return all;
        }
        for body in &self.lattices {
            let mut most = vec![f64::NEG_INFINITY; body.sites()];
            for (cell, most) in most.iter_mut().enumerate().filter(|(c, _)| body.particle[*c] != u32::MAX) {
                body.family(cell as u32, &self.options, |s, s00, alpha| *most = most.max(s00 - alpha * s));
            }
            for &(cell, e) in &body.broken {
                let (cell, e) = (cell as usize, usize::from(e));
                let Some(to) = body.ahead(body.slot_of(cell), cell, e) else { continue };
                let length = body.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                let [_, s00, alpha] = body.pair(cell, to);
                let critical = s00 - alpha * banded(body.z(0, cell, to, e), length, &self.options);
                for site in [cell, to] {
                    most[site] = most[site].max(critical);
                }
            }
            show(&mut all, &body.particle, &most);
        }
        self.critical_of_list(view, &mut all);
        all
    }

    fn critical_of_list(&self, view: &PeriView, all: &mut [f64]) {
        let (list, cell) = (&self.list, self.cell(view));
        let mut most = vec![f64::NEG_INFINITY; list.record.len()];
        let mut count = |i: usize, b: usize| {
            let (j, pair) = (list.partner[b] as usize, list.constants(b));
            let (z, length) = list.z(true, i, j, &cell);
            let s00 = pair.s00 * list.scatter.strength([i, j]);
            let critical = s00 - pair.alpha * banded(z, length, &self.options);
            for site in [i, j] {
                most[site] = most[site].max(critical);
            }
        };
        for i in 0..list.record.len() {
            list.own(i).filter(|b| list.lives(*b)).for_each(|b| count(i, b));
        }
        for &b in &list.broken {
            count(list.owner[b as usize / GROUP] as usize, b as usize);
        }
        show(all, &list.particle, &most);
    }

    /// The bond from particle `i` to particle `j` at the start, by the shortest way where the box repeats.
    pub fn first_bond(&self, view: &PeriView, i: usize, j: usize) -> Vec3 {
        let at = self.reference.as_deref().unwrap_or(view.x0);
        self.birth.periods().nearest(sub(at[j], at[i]))
    }

    /// The pull of a bond between particles of two types, at first `r0` long and now `r`, and its energy, both over the
    /// volumes that count for it. Its law must know it by its stretch alone.
    pub fn bond_alone(&self, kinds: [u16; 2], r0: f64, r: f64) -> [f64; 2] {
        let (law, options) = (&self.law, &self.options);
        debug_assert!(law.kind.about(options.compat_lammps).columns == 0 && law.kind.memory() == 0);
        let Some(coeff) = self.table.get(kinds[0], kinds[1]) else { return [0.0; 2] };
        let mut bond = weighing::banded((r - r0) * (r + r0) / (r0 * r0), r0, options);
        bond.limit = coeff.s00;
        let weight = options.volume.weight(r0, coeff.horizon, options.lattice_spacing);
        let constants = (coeff.c, coeff.horizon, law.yields(kinds[0], kinds[1]));
        let (omega, share) = Weighing::of(law).weigh(r0, weight, constants);
        let alone = Alone { stretch: bond, omega, ends: [[0.0; COLUMNS]; 2], memory: [0.0; 2], angles: None };
        let [squares, pulls] = law.kind.loops(options.compat_lammps).alone(&alone, &Moment::default());
        let [energy, pull] = [squares, pulls].map(|both| both[0] + both[1]);
        [0.5 * pull * share * r, 0.25 * energy * share * r0 * r0]
    }
}

/// Hands what sites have found to their particles.
fn show(all: &mut [f64], particle: &[u32], most: &[f64]) {
    for (&p, &most) in particle.iter().zip(most) {
        if p != u32::MAX && most > f64::NEG_INFINITY {
            all[p as usize] = most;
        }
    }
}
