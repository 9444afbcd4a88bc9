//! Which bonds break: after the forces of a step, from stretches of this step and families of the one before.
//!
//! A bond breaks when its stretch exceeds s00 − alpha max(s_min,i, s_min,j), s_min being the smallest stretch
//! among the bonds a particle had in the previous step, those that broke in it included. Under `compat lammps`
//! it breaks above min(s0_i, s0_j) with one s0 = max(s00 − alpha s) per particle, whatever the pair.
//!
//! Both measures are needed for few particles only. They are computed when a bond's stretch exceeds
//! s00 − alpha times its own previous stretch: never less than the true limit, for a bond belongs to both families.

use super::lattice::MAY_BREAK;
use super::pmb::stretch;
use crate::par::{self, Shared};
use crate::world::families::lattice::{LANES, LatticeBody};
use crate::world::families::list::ListBody;
use crate::world::families::{Candidate, FamilyOptions};

/// A layout, as breaking sees it. Sites are cells or records.
pub trait Bonds: Sync {
    /// Finds bonds stretched beyond what their own previous stretch allows, in order.
    fn candidates(&self, found: &mut Vec<Candidate>);
    /// Calls `f(previous stretch, s00, alpha)` for each living bond of a site.
    fn family(&self, site: u32, options: &FamilyOptions, f: impl FnMut(f64, f64, f64));
    /// Sets whether the bonds that broke in the previous step live.
    fn revive(&mut self, lives: bool);
    /// Breaks bonds and remembers them as those of this step.
    fn break_all(&mut self, bonds: &[Candidate]);
    /// Memory for measures of sites.
    fn measured(&mut self) -> &mut Vec<f64>;
    /// Number of sites.
    fn sites(&self) -> usize;
}

/// Breaks what has to break; `found` is scratch.
pub fn break_bonds<B: Bonds>(body: &mut B, options: &FamilyOptions, found: &mut Vec<Candidate>) {
    found.clear();
    body.candidates(found);
    if options.compat_lammps || found.iter().any(|c| c.alpha != 0.0) {
        judge(body, options, found);
    }
    body.break_all(found);
}

/// Keeps the candidates that exceed their limit.
fn judge<B: Bonds>(body: &mut B, options: &FamilyOptions, found: &mut Vec<Candidate>) {
    let mut measured = std::mem::take(body.measured());
    measured.resize(body.sites(), f64::NAN);
    let mut asked: Vec<u32> = found.iter().flat_map(|c| c.ends).collect();
    asked.sort_unstable();
    asked.dedup();
    body.revive(true);
    let shared = Shared::new(&mut measured);
    par::for_chunks(asked.len(), |range| {
        for &site in &asked[range] {
            let value = measure(body, site, options);
            // SAFETY: sites are asked for once.
            unsafe { shared.get(site as usize..site as usize + 1)[0] = value };
        }
    });
    body.revive(false);
    found.retain(|c| {
        let [a, b] = c.ends.map(|site| measured[site as usize]);
        let limit = if options.compat_lammps { a.min(b) } else { c.s00 - c.alpha * a.max(b) };
        c.stretch > limit
    });
    for site in asked {
        measured[site as usize] = f64::NAN;
    }
    *body.measured() = measured;
}

/// The smallest previous stretch of a site's family, or LAMMPS' critical stretch.
fn measure<B: Bonds>(body: &B, site: u32, options: &FamilyOptions) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    body.family(site, options, |stretch, s00, alpha| {
        least = least.min(stretch);
        most = most.max(s00 - alpha * stretch);
    });
    if options.compat_lammps { most } else { least }
}

/// A stretch, or 0 inside the dead band.
fn banded(z: f64, length: f64, options: &FamilyOptions) -> f64 {
    if z.abs() < options.dead_band(length) { 0.0 } else { stretch(z) }
}

impl LatticeBody {
    /// Micromodulus, s00 and alpha of the bond between two cells.
    fn pair(&self, i: usize, j: usize) -> [f64; 3] {
        let kind = |cell: usize| {
            let row = &self.rows[self.slot_of(cell)];
            if self.cell_kind.is_empty() {
                usize::from(row.kind)
            } else {
                usize::from(self.cell_kind[crate::world::families::lattice::PAD + cell])
            }
        };
        self.pairs[kind(i) * self.kinds.len() + kind(j)]
    }
}

impl Bonds for LatticeBody {
    fn candidates(&self, found: &mut Vec<Candidate>) {
        let entries = self.stencil.len();
        for (slot, row) in self.rows.iter().enumerate() {
            for chunk in row.start as usize / LANES..(row.start + row.len) as usize / LANES {
                if self.flagged[chunk] & MAY_BREAK == 0 {
                    continue;
                }
                for e in 0..entries {
                    let bits = self.alive[chunk * entries + e];
                    for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
                        let i = chunk * LANES + lane;
                        let Some(j) = self.ahead(slot, i, e) else { continue };
                        let [_, s00, alpha] = self.pair(i, j);
                        let stretch_now = stretch(self.z(1, i, j, e));
                        if stretch_now > s00 - alpha * stretch(self.z(0, i, j, e)).max(0.0) {
                            let ends = [i as u32, j as u32];
                            found.push(Candidate { ends, bond: e as u32, stretch: stretch_now, s00, alpha });
                        }
                    }
                }
            }
        }
    }

    fn family(&self, site: u32, options: &FamilyOptions, mut f: impl FnMut(f64, f64, f64)) {
        self.around(site as usize, |other, owner, e| {
            if self.lives(owner, e) {
                let to = if owner == other { site as usize } else { other };
                let length = self.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                let [_, s00, alpha] = self.pair(owner, to);
                f(banded(self.z(0, owner, to, e), length, options), s00, alpha);
            }
        });
    }

    fn revive(&mut self, lives: bool) {
        let broken = std::mem::take(&mut self.broken);
        for &(cell, e) in &broken {
            self.set(cell as usize, usize::from(e), lives);
        }
        self.broken = broken;
    }

    fn break_all(&mut self, bonds: &[Candidate]) {
        self.broken.clear();
        for c in bonds {
            self.broken.push((c.ends[0], c.bond as u16));
            self.set(c.ends[0] as usize, c.bond as usize, false);
            self.intact[c.ends[0] as usize / LANES] = false;
        }
    }

    fn measured(&mut self) -> &mut Vec<f64> {
        &mut self.measured
    }

    fn sites(&self) -> usize {
        self.particle.len()
    }
}

impl ListBody {
    /// z of the bond between two records, from displacements of this step or of the last one, and |xi|.
    pub(super) fn z(&self, last: bool, i: usize, j: usize, period: [f64; 3]) -> (f64, f64) {
        let (a, b) = (&self.record[i], &self.record[j]);
        let (mut q, mut square) = (0.0, 0.0);
        for k in 0..3 {
            let mut xi = b.reference[k] - a.reference[k];
            if xi.abs() > 0.5 * period[k] {
                xi -= period[k] * (xi / period[k]).round();
            }
            let eta = if last { self.last[j][k] - self.last[i][k] } else { b.u[k] - a.u[k] };
            q += eta * (2.0 * xi + eta);
            square += xi * xi;
        }
        (q / square, square.sqrt())
    }
}

/// The list with the box it is in.
pub struct Periodic<'a>(pub &'a mut ListBody, pub [f64; 3]);

impl Bonds for Periodic<'_> {
    fn candidates(&self, found: &mut Vec<Candidate>) {
        let body = &*self.0;
        for i in (0..body.record.len()).filter(|&i| body.flagged[i] & MAY_BREAK != 0) {
            for b in body.own(i).filter(|&b| body.lives(b)) {
                let j = body.partner[b] as usize;
                let pair =
                    &body.pairs[usize::from(body.kind[i]) * body.kinds.len() + usize::from(body.kind[j])];
                let now = stretch(body.z(false, i, j, self.1).0);
                if now > pair.s00 - pair.alpha * stretch(body.z(true, i, j, self.1).0).max(0.0) {
                    let ends = [i as u32, j as u32];
                    let (s00, alpha) = (pair.s00, pair.alpha);
                    found.push(Candidate { ends, bond: b as u32, stretch: now, s00, alpha });
                }
            }
        }
    }

    fn family(&self, site: u32, options: &FamilyOptions, mut f: impl FnMut(f64, f64, f64)) {
        let body = &*self.0;
        body.around(site as usize, |other, b| {
            if body.lives(b) {
                let kinds = [other, site as usize].map(|r| usize::from(body.kind[r]));
                let pair = &body.pairs[kinds[0] * body.kinds.len() + kinds[1]];
                let (z, length) = body.z(true, site as usize, other, self.1);
                f(banded(z, length, options), pair.s00, pair.alpha);
            }
        });
    }

    fn revive(&mut self, lives: bool) {
        for b in self.0.broken.clone() {
            self.0.set(b as usize, lives);
        }
    }

    fn break_all(&mut self, bonds: &[Candidate]) {
        self.0.broken.clear();
        for c in bonds {
            self.0.broken.push(c.bond);
            self.0.set(c.bond as usize, false);
        }
    }

    fn measured(&mut self) -> &mut Vec<f64> {
        &mut self.0.measured
    }

    fn sites(&self) -> usize {
        self.0.record.len()
    }
}
