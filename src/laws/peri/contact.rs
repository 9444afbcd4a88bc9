//! Short-range repulsion: unbonded pairs that are near, and bonded ones that are squeezed.

use super::lattice::SQUEEZED;
use crate::world::families::lattice::LANES;
use crate::world::families::{Families, FamilyOptions, ForceUnit, PeriTally, PeriView, PmbTable};

/// Everything a pair's repulsion depends on, and where it goes.
pub struct Repulsion<'a, 'b, 't> {
    /// Particles.
    pub view: &'a PeriView<'a>,
    /// Coefficients.
    pub table: &'a PmbTable,
    /// Rules.
    pub options: &'a FamilyOptions,
    /// Forces, added to.
    pub f: &'b mut [[f64; 3]],
    /// Energy and virial, added to.
    pub tally: Option<&'b mut PeriTally<'t>>,
}

impl Repulsion<'_, '_, '_> {
    /// f = 15 c V (d − r)/delta for r < d = min(0.9 |x0_i − x0_j|, 1.35 dx) (Parks et al. 2008, LAMMPS' peri
    /// styles), V being the partner's volume; LAMMPS takes that of the second particle for both ends.
    pub fn pair(&mut self, a: u32, b: u32) {
        let (i, j) = (a.min(b) as usize, a.max(b) as usize);
        let view = self.view;
        let reach = 1.35 * self.options.lattice_spacing;
        let d = view.bounds.nearest([0, 1, 2].map(|k| view.x[i][k] - view.x[j][k]));
        let rsq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if rsq >= reach * reach {
            return;
        }
        let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { return };
        let contact = self.options.contact_range(view, i as u32, j as u32);
        if rsq >= contact * contact {
            return;
        }
        let r = rsq.sqrt();
        let k = 15.0 * coeff.c * (r - contact) / coeff.horizon;
        let (vi, vj) = self.volumes(i, j);
        let pull = if r > 0.0 { -k / r } else { 0.0 };
        for m in 0..3 {
            self.f[i][m] += d[m] * pull * vj;
            self.f[j][m] -= d[m] * pull * vi;
        }
        let scale = if self.options.unit == ForceUnit::Density { view.volume[i] } else { 1.0 };
        if let Some(t) = self.tally.as_deref_mut() {
            let e = 0.25 * k * (r - contact);
            add(t, (i, e * vj), (j, e * vi), pull * vj * scale, d);
        }
    }

    /// The volumes in the forces on `j` and on `i`.
    fn volumes(&self, i: usize, j: usize) -> (f64, f64) {
        let (vi, vj) = (self.view.volume[i], self.view.volume[j]);
        match self.options.unit {
            ForceUnit::Newton => (vi * vj, vi * vj),
            ForceUnit::Density if self.options.compat_lammps => (vj, vj),
            ForceUnit::Density => (vi, vj),
        }
    }
}

/// Adds energies of both ends and the virial of the force `pull` times `d` on the first.
pub fn add(t: &mut PeriTally, (i, e_i): (usize, f64), (j, e_j): (usize, f64), pull: f64, d: [f64; 3]) {
    t.energy += e_i + e_j;
    t.add_virial(i, j, pull, d);
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[i] += e_i;
        atoms[j] += e_j;
    }
}

/// All repulsion of one step: near pairs that may be `closer` by now than their gap was, then squeezed bonds.
pub fn repel(families: &Families, closer: [f64; 2], repulsion: &mut Repulsion) {
    for (pairs, closer) in families.near.pairs.iter().zip(closer) {
        for pair in pairs.iter().filter(|pair| f64::from(pair.after) <= closer) {
            repulsion.pair(pair.ends[0], pair.ends[1]);
        }
    }
    for body in &families.lattices {
        for (chunk, _) in body.flagged.iter().enumerate().filter(|(_, flag)| **flag & SQUEEZED != 0) {
            let slot = body.slot_of(chunk * LANES);
            for cell in chunk * LANES..(chunk + 1) * LANES {
                for e in (0..body.stencil.len()).filter(|&e| body.lives(cell, e)) {
                    if let Some(to) = body.ahead(slot, cell, e) {
                        repulsion.pair(body.particle[cell], body.particle[to]);
                    }
                }
            }
        }
    }
    let list = &families.list;
    for i in (0..list.record.len()).filter(|&i| list.flagged[i] & SQUEEZED != 0) {
        for b in list.own(i).filter(|&b| list.lives(b)) {
            repulsion.pair(list.particle[i], list.particle[list.partner[b] as usize]);
        }
    }
}
