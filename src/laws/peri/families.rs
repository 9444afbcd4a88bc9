//! Bonds of the prototype microelastic brittle model: building families, forces, breaking, damage.

use crate::diag::{Code, Diagnostic, Result};
use crate::neigh::family::Cells;
use crate::world::families::{Families, FamilyOptions, ForceUnit, PeriTally, PeriView, PmbTable};

/// A bond length change below this counts as none (LAMMPS' absolute threshold, `compat lammps` only).
const NEAR_ZERO: f64 = 2.2204e-16;
/// A bond stretched less than this carries exactly no force.
const DEAD_BAND: f64 = 4e-13;

impl Families {
    /// Finds all bonds: partners closer than the horizon of their types in the present positions.
    ///
    /// # Errors
    /// A periodic box shorter than two horizons is refused: a bond would meet its own image.
    pub fn build(view: &PeriView, table: &PmbTable, options: FamilyOptions) -> Result<Self> {
        let n = view.x.len();
        let lc = options.lattice_spacing;
        let far = table.iter().map(|c| options.volume.reach(c.horizon, lc)).fold(0.0, f64::max);
        let bounds = &view.bounds;
        for k in 0..3 {
            let length = bounds.hi[k] - bounds.lo[k];
            if bounds.periodic[k] && length < 2.0 * far {
                let name = ["x", "y", "z"][k];
                let message = format!(
                    "the periodic box is {length} long in {name}, less than twice the horizon {far}: \
                     bonds would meet their own images"
                );
                let help = "make the box longer, the horizon shorter, or this boundary f, s or m";
                return Err(Diagnostic::error(Code::CONFLICT, None, message).help(help).into());
            }
        }
        let mut pairs = Vec::new();
        if far > 0.0 {
            let mut cells = Cells::default();
            cells.fill(view.x, 0..n as u32, bounds, far);
            cells.pairs(|i, j| {
                let Some(coeff) = table.get(view.kind[i as usize], view.kind[j as usize]) else { return };
                let rsq = squared(between(view.x, i, j, view));
                let cut = options.volume.reach(coeff.horizon, lc);
                if rsq <= cut * cut {
                    pairs.push((i, j, rsq.sqrt()));
                    pairs.push((j, i, rsq.sqrt()));
                }
            });
        }
        pairs.sort_unstable_by_key(|&(i, j, _)| (i, j));
        let mut start = vec![0; n + 1];
        let mut family_volume = vec![0.0; n];
        for &(i, j, _) in &pairs {
            start[i as usize + 1] += 1;
            family_volume[i as usize] += view.volume[j as usize];
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        Ok(Self {
            table: table.clone(),
            options,
            armed: false,
            start,
            alive: vec![true; pairs.len()],
            partner: pairs.iter().map(|p| p.1).collect(),
            r0: pairs.iter().map(|p| p.2).collect(),
            family_volume,
            limit: vec![0.0; n],
        })
    }

    /// Adds the forces of all bonds and of short-range contact to `f`. With `advance`, overstretched bonds
    /// then break and the families' smallest stretches are those of this step.
    pub fn force(
        &mut self,
        view: &PeriView,
        f: &mut [[f64; 3]],
        advance: bool,
        mut tally: Option<&mut PeriTally>,
    ) {
        self.short_range(view, f, tally.as_deref_mut());
        let compat = self.options.compat_lammps;
        let lc = self.options.lattice_spacing;
        let mut next = vec![if compat { f64::MAX } else { f64::INFINITY }; self.limit.len()];
        let mut broken = Vec::new();
        for i in 0..self.limit.len() {
            let mut first = true;
            for b in self.start[i]..self.start[i + 1] {
                if !self.alive[b] {
                    continue;
                }
                let j = self.partner[b] as usize;
                let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { continue };
                let (d, r0) = (between(view.x, i as u32, j as u32, view), self.r0[b]);
                let r = squared(d).sqrt();
                let mut dr = r - r0;
                let tiny = if compat { NEAR_ZERO } else { DEAD_BAND * r0 };
                if dr.abs() < tiny {
                    dr = 0.0;
                }
                let stretch = dr / r0;
                let weight = self.options.volume.weight(r0, coeff.horizon, lc);
                let rk = coeff.c * self.volumes(view, i, j) * weight * stretch;
                let pull = if r > 0.0 { -(rk / r) } else { 0.0 };
                for k in 0..3 {
                    f[i][k] += d[k] * pull;
                }
                if let Some(t) = tally.as_deref_mut() {
                    add(
                        t,
                        0.25 * rk * dr,
                        0.25 * rk * dr,
                        (i, i),
                        0.5 * pull * self.virial_volume(view, i),
                        d,
                    );
                }
                if self.armed && stretch > self.critical(coeff.s00, coeff.alpha, i, j) {
                    broken.push(b);
                }
                let own = coeff.s00 - coeff.alpha * stretch;
                next[i] = match (compat, first) {
                    (true, true) => own,
                    (true, false) => next[i].max(own),
                    (false, _) => next[i].min(stretch),
                };
                first = false;
            }
        }
        if advance {
            broken.into_iter().for_each(|b| self.alive[b] = false);
            self.limit = next;
            self.armed = true;
        }
    }

    /// The stretch at which the bond between `i` and `j` breaks.
    fn critical(&self, s00: f64, alpha: f64, i: usize, j: usize) -> f64 {
        if self.options.compat_lammps {
            return self.limit[i].min(self.limit[j]);
        }
        s00 - alpha * self.limit[i].max(self.limit[j])
    }

    fn volumes(&self, view: &PeriView, i: usize, j: usize) -> f64 {
        match self.options.unit {
            ForceUnit::Density => view.volume[j],
            ForceUnit::Newton => view.volume[i] * view.volume[j],
        }
    }

    fn virial_volume(&self, view: &PeriView, i: usize) -> f64 {
        match self.options.unit {
            ForceUnit::Density => view.volume[i],
            ForceUnit::Newton => 1.0,
        }
    }

    /// Repulsion of all pairs closer than min(0.9 of their distance at creation, 1.35 lattice spacings).
    fn short_range(&self, view: &PeriView, f: &mut [[f64; 3]], mut tally: Option<&mut PeriTally>) {
        let lc = self.options.lattice_spacing;
        let mut cells = Cells::default();
        cells.fill(view.x, 0..view.x.len() as u32, &view.bounds, 1.35 * lc);
        cells.pairs(|a, b| {
            let (i, j) = (a.min(b) as usize, a.max(b) as usize);
            let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { return };
            let d = between(view.x, i as u32, j as u32, view);
            let rsq = squared(d);
            let d0 = between(view.x0, i as u32, j as u32, view);
            let contact = (0.9 * squared(d0).sqrt()).min(1.35 * lc);
            if rsq >= contact * contact {
                return;
            }
            let r = rsq.sqrt();
            let k = 15.0 * coeff.c * (r - contact) / coeff.horizon;
            let vj = self.volumes(view, i, j);
            let compat_density = self.options.compat_lammps && self.options.unit == ForceUnit::Density;
            let vi = if compat_density { vj } else { self.volumes(view, j, i) };
            let pull = if r > 0.0 { -(k / r) } else { 0.0 };
            for m in 0..3 {
                f[i][m] += d[m] * pull * vj;
                f[j][m] -= d[m] * pull * vi;
            }
            if let Some(t) = tally.as_deref_mut() {
                let e = 0.25 * k * (r - contact);
                add(t, e * vj, e * vi, (i, j), pull * vj * self.virial_volume(view, i), d);
            }
        });
    }

    /// The share of a particle's family (by volume) whose bonds are broken.
    pub fn damage(&self, i: usize, volume: &[f64]) -> f64 {
        if i >= self.family_volume.len() || self.family_volume[i] == 0.0 {
            return 0.0;
        }
        let live: f64 = self.neighbours(i).filter(|n| n.alive).map(|n| volume[n.partner as usize]).sum();
        1.0 - live / self.family_volume[i]
    }

    /// The damage of the particles `0..out.len()`.
    pub fn damage_all(&self, volume: &[f64], out: &mut [f64]) {
        for (i, d) in out.iter_mut().enumerate() {
            *d = self.damage(i, volume);
        }
    }

    /// Bonds at the start, each counted from both ends as LAMMPS prints them.
    pub fn bonds(&self) -> usize {
        self.partner.len()
    }

    /// Bonds that still live, each counted from both ends.
    pub fn live_bonds(&self) -> usize {
        self.alive.iter().filter(|&&a| a).count()
    }

    /// All partners of a particle, broken bonds included.
    pub fn neighbours(&self, i: usize) -> impl Iterator<Item = Neighbour> + '_ {
        let row = if i < self.limit.len() { self.start[i]..self.start[i + 1] } else { 0..0 };
        row.map(|b| Neighbour { partner: self.partner[b], r0: self.r0[b], alive: self.alive[b] })
    }

    /// Renumbers particles; `None` marks a removed one, whose bonds end (and count as damage of its partners).
    pub fn remap(&mut self, old_to_new: &[Option<u32>]) {
        let kept = self.limit.len();
        let mut rows: Vec<(u32, usize)> =
            (0..kept).filter_map(|i| old_to_new[i].map(|new| (new, i))).collect();
        rows.sort_unstable();
        let n = rows.last().map_or(0, |r| r.0 as usize + 1);
        let mut new = Self {
            table: self.table.clone(),
            options: self.options,
            armed: self.armed,
            start: vec![0; n + 1],
            partner: vec![],
            r0: vec![],
            alive: vec![],
            family_volume: vec![0.0; n],
            limit: vec![0.0; n],
        };
        for (to, i) in rows {
            let to = to as usize;
            new.family_volume[to] = self.family_volume[i];
            new.limit[to] = self.limit[i];
            for n in self.neighbours(i) {
                if let Some(partner) = old_to_new[n.partner as usize] {
                    new.partner.push(partner);
                    new.r0.push(n.r0);
                    new.alive.push(n.alive);
                }
            }
            new.start[to + 1] = new.partner.len();
        }
        for i in 0..n {
            new.start[i + 1] = new.start[i + 1].max(new.start[i]);
        }
        *self = new;
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.partner.len() * 13 + self.start.len() * 24
    }
}

/// One partner of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// The partner's index.
    pub partner: u32,
    /// Reference length of the bond.
    pub r0: f64,
    /// Whether the bond still lives.
    pub alive: bool,
}

fn between(x: &[[f64; 3]], i: u32, j: u32, view: &PeriView) -> [f64; 3] {
    let (a, b) = (x[i as usize], x[j as usize]);
    view.bounds.nearest([a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}

fn squared(d: [f64; 3]) -> f64 {
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

/// Adds energies `e_i`, `e_j` of a pair and the virial of the force `pull` times `d`.
fn add(t: &mut PeriTally, e_i: f64, e_j: f64, (i, j): (usize, usize), pull: f64, d: [f64; 3]) {
    t.energy += e_i;
    if i != j {
        t.energy += e_j;
    }
    for (v, (a, b)) in t.virial.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
        *v += pull * d[a] * d[b];
    }
    if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
        atoms[i] += e_i;
        if i != j {
            atoms[j] += e_j;
        }
    }
}
