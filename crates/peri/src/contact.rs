//! Short-range repulsion: unbonded pairs that are near, and bonded ones that are squeezed.

use crate::build::detect::distance;
use crate::families::lattice::LANES;
use crate::families::list::CLOSE;
use crate::families::{Families, FamilyOptions, ForceUnit, Influence, PeriTally, PeriView, PmbTable};
use crate::lattice::sweep::SQUEEZED;
use perigrain_base::math::vec3::length;

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
        if rsq >= reach * reach || view.excludes(a, b) {
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

impl Repulsion<'_, '_, '_> {
    /// The push of a broken bond of this shape that is shorter than at the start: c w s as before it broke.
    fn broken(&mut self, i: usize, j: usize, length: f64, (shape, weight): (Influence, f64)) {
        let view = self.view;
        let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { return };
        let d = view.bounds.nearest([0, 1, 2].map(|k| view.x[i][k] - view.x[j][k]));
        let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let s = r / length - 1.0;
        if s >= 0.0 || r == 0.0 {
            return;
        }
        let c = coeff.c * shape.shape(length, coeff.horizon) * weight;
        let pull = -c * s / r;
        let ((vi, vj), newton) = ((view.volume[i], view.volume[j]), self.options.unit == ForceUnit::Newton);
        let (own, far) = if newton { (vi * vj, vi * vj) } else { (vj, vi) };
        for k in 0..3 {
            self.f[i][k] += d[k] * pull * own;
            self.f[j][k] -= d[k] * pull * far;
        }
        if let Some(t) = self.tally.as_deref_mut() {
            let e = 0.25 * c * s * s * length;
            add(t, (i, e * own), (j, e * far), pull * vi * vj, d);
        }
    }
}

/// The pushes of all broken bonds under `peri_modify broken compress yes`, in the order of particles.
pub fn push_apart(families: &Families, repulsion: &mut Repulsion) {
    if !families.options.compress {
        return;
    }
    let view = repulsion.view;
    // State-based solids push with their short-range modulus, which has no shape.
    let states = !families.law.kind.bond_based();
    let shape = if states { Influence::One } else { families.law.influence };
    for i in (0..families.damaged.len()).filter(|&i| families.damaged[i]) {
        families.each(i, |n| {
            let j = n.partner as usize;
            if n.alive || j < i {
                return;
            }
            let Some(coeff) = families.table.get(view.kind[i], view.kind[j]) else { return };
            let length = length(families.first_bond(view, i, j));
            let weight = families.share_of(i, &n, length, coeff.horizon);
            repulsion.broken(i, j, length, (shape, weight));
        });
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
            let [i, j] = pair.ends;
            if distance(repulsion.view, i, j).0 < f64::from(pair.within) {
                repulsion.pair(i, j);
            }
        }
    }
    for body in &families.lattices {
        for (chunk, _) in body.flagged.iter().enumerate().filter(|(_, flag)| **flag & SQUEEZED != 0) {
            let alive = &body.alive[chunk * body.stencil.len()..][..body.stencil.len()];
            for lead in body.leads_of(body.slot_of(chunk * LANES)) {
                let mut bits = alive[lead.e as usize];
                while bits != 0 {
                    let cell = chunk * LANES + bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let to = cell.wrapping_add_signed(lead.to as isize);
                    repulsion.pair(body.particle[cell], body.particle[to]);
                }
            }
        }
    }
    let list = &families.list;
    let mut pair = |i: usize, b: usize| {
        if list.lives(b) {
            repulsion.pair(list.particle[i], list.particle[list.partner[b] as usize]);
        }
    };
    for (i, &low) in list.lowest.iter().enumerate() {
        if low < CLOSE {
            list.own(i).for_each(|b| pair(i, b));
            continue;
        }
        let close = &list.close[list.close_start[i] as usize..list.close_start[i + 1] as usize];
        for &(_, b) in close.iter().take_while(|(z, _)| *z >= low) {
            pair(i, b as usize);
        }
    }
}
