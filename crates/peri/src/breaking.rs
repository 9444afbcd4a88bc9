//! Which bonds break: after the forces of a step, from stretches of this step and families of the one before.
//!
//! A bond breaks when its stretch exceeds s00 − alpha max(s_min,i, s_min,j), s_min being the smallest stretch
//! among the bonds a particle had in the previous step, those that broke in it included. Under `compat lammps`
//! it breaks above min(s0_i, s0_j) with one s0 = max(s00 − alpha s) per particle, whatever the pair.
//!
//! Both measures are needed for few particles only: where a bond's stretch exceeds s00 − alpha m with an m that is sure to be
//! no less than max(s_min,i, s_min,j). Its own previous stretch is one, for the bond belongs to both families; the previous
//! stretches of the bonds that were the least ones of both families when these were looked at last are mostly a far better one.

use super::lattice::MAY_BREAK;
use super::pmb::stretch;
use super::stretching::StretchKernels;
use crate::families::list::{GROUP, ListBody, PairConstants, UNKNOWN};
use crate::families::{Candidate, FamilyOptions, Measures};
use perigrain_base::par::{self, Shared};

/// A layout, as breaking sees it. Sites are cells or records.
pub trait Bonds: Sync + Sized {
    /// How many sites are measured together.
    const GROUP: usize;
    /// Finds bonds stretched beyond what is sure to allow it, their own previous stretch or more, in order.
    fn candidates<K: StretchKernels>(&self, found: &mut Vec<Candidate>);
    /// Calls `f(previous stretch, s00, alpha)` for each living bond of a site.
    fn family(&self, site: u32, options: &FamilyOptions, f: impl FnMut(f64, f64, f64));
    /// Gets ready for [`Bonds::candidates`].
    fn prepare(&mut self) {}
    /// The smallest previous stretch of the families of all sites in `groups`, or LAMMPS' critical stretch.
    fn measure<K: StretchKernels>(&mut self, groups: &[u32], options: &FamilyOptions, values: &mut [f64]);
    /// Sets whether the bonds that broke in the previous step live.
    fn revive(&mut self, lives: bool);
    /// Breaks bonds and remembers them as those of this step.
    fn break_all(&mut self, bonds: &[Candidate]);
    /// Memory for measures of sites.
    fn measures(&mut self) -> &mut Measures;
    /// Number of sites.
    fn sites(&self) -> usize;
    /// The particle at a site.
    fn particle(&self, site: u32) -> u32;
}

/// Breaks what has to break, except bonds of particles that are `spared`; `found` is scratch.
pub fn break_bonds<K: StretchKernels, B: Bonds>(
    body: &mut B,
    options: &FamilyOptions,
    found: &mut Vec<Candidate>,
    spared: &dyn Fn(u32) -> bool,
) {
    found.clear();
    body.prepare();
    body.candidates::<K>(found);
    found.retain(|c| !c.ends.iter().any(|site| spared(body.particle(*site))));
    if !found.is_empty() && (options.compat_lammps || found.iter().any(|c| c.alpha != 0.0)) {
        judge::<K, B>(body, options, found);
    } else {
        found.retain(|c| c.stretch > c.s00);
    }
    body.break_all(found);
}

/// Keeps the candidates that exceed their limit.
fn judge<K: StretchKernels, B: Bonds>(body: &mut B, options: &FamilyOptions, found: &mut Vec<Candidate>) {
    let mut measures = std::mem::take(body.measures());
    measures.start(body.sites().div_ceil(B::GROUP));
    for site in found.iter().flat_map(|c| c.ends) {
        measures.ask(site / B::GROUP as u32);
    }
    let (groups, values) = measures.to_fill(B::GROUP);
    body.revive(true);
    body.measure::<K>(groups, options, values);
    body.revive(false);
    found.retain(|c| {
        let [a, b] = c.ends.map(|site| measures.of(site, B::GROUP));
        let limit = if options.compat_lammps { a.min(b) } else { c.s00 - c.alpha * a.max(b) };
        c.stretch > limit
    });
    *body.measures() = measures;
}

/// The smallest previous stretch of a site's family, or LAMMPS' critical stretch.
pub fn measure<B: Bonds>(body: &B, site: u32, options: &FamilyOptions) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    body.family(site, options, |stretch, s00, alpha| {
        least = least.min(stretch);
        most = most.max(s00 - alpha * stretch);
    });
    if options.compat_lammps { most } else { least }
}

/// A stretch, or 0 inside the dead band.
pub fn banded(z: f64, length: f64, options: &FamilyOptions) -> f64 {
    if z.abs() < options.dead_band(length) { 0.0 } else { stretch(z) }
}

impl ListBody {
    /// z of the bond between two records, from displacements of this step or of the last one, and |xi|.
    pub(super) fn z(&self, last: bool, i: usize, j: usize, period: [f64; 3]) -> (f64, f64) {
        let (z, square) = self.z_and_square(last, i, j, period);
        (z, square.sqrt())
    }

    /// The same with |xi|².
    #[inline]
    fn z_and_square(&self, last: bool, i: usize, j: usize, period: [f64; 3]) -> (f64, f64) {
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
        (q / square, square)
    }
}

/// The list with the box it is in.
pub struct Periodic<'a>(pub &'a mut ListBody, pub [f64; 3]);

impl Periodic<'_> {
    /// The least z of a record's living bonds in the step before, 0 inside the dead band, and which bond has it.
    fn slackest_of(&self, i: usize, options: &FamilyOptions) -> (f64, u32) {
        let (body, mut least) = (&*self.0, (f64::INFINITY, UNKNOWN));
        body.around(i, |other, b| {
            if body.lives(b) {
                let (z, square) = body.z_and_square(true, i, other, self.1);
                let z = if z.abs() < options.dead_band(square.sqrt()) { 0.0 } else { z };
                if z < least.0 {
                    least = (z, b as u32);
                }
            }
        });
        least
    }
}

/// No less than the stretch of a bond in the step before (s ≤ z/2), nor than 0 if that is next to nothing; infinite once it is
/// broken.
fn known(body: &ListBody, b: usize, period: [f64; 3]) -> f64 {
    if !body.lives(b) {
        return f64::INFINITY;
    }
    let (i, j) = (body.owner[b / GROUP] as usize, body.partner[b] as usize);
    let half = 0.5 * body.z_and_square(true, i, j, period).0;
    if half > -1e-9 { half.max(0.0) } else { half }
}

impl Bonds for Periodic<'_> {
    const GROUP: usize = 1;

    fn prepare(&mut self) {
        let Self(body, period) = self;
        if !body.flagged.iter().any(|flag| flag & MAY_BREAK != 0) {
            return;
        }
        let mut bound = std::mem::take(&mut body.bound);
        bound.clear();
        bound.resize(body.record.len(), f64::INFINITY);
        if body.slackest.len() == body.record.len() {
            let (body, period) = (&**body, *period);
            par::each((&mut bound[..], &body.slackest[..]), |_, (bound, slackest)| {
                for (bound, &b) in bound.iter_mut().zip(slackest).filter(|(_, b)| **b != UNKNOWN) {
                    *bound = known(body, b as usize, period);
                }
            });
        }
        body.bound = bound;
    }

    fn candidates<K: StretchKernels>(&self, found: &mut Vec<Candidate>) {
        let body = &*self.0;
        for i in (0..body.record.len()).filter(|&i| body.flagged[i] & MAY_BREAK != 0) {
            for b in body.own(i).filter(|&b| body.lives(b)) {
                let j = body.partner[b] as usize;
                let (s00, alpha) = (body.constants(b).s00, body.constants(b).alpha);
                let z = body.z_and_square(false, i, j, self.1).0;
                // s ≤ z/2: these limits are no higher than the true one, and rounding takes far less than 1e-12.
                let least = body.bound[i].max(body.bound[j]);
                let bears = |least: f64| {
                    let limit = s00 - alpha * least;
                    0.5 * z < limit - 1e-12 * limit.abs()
                };
                if bears(least) || bears(least.min(0.5 * body.z_and_square(true, i, j, self.1).0.max(0.0))) {
                    continue;
                }
                let ends = [i as u32, j as u32];
                found.push(Candidate { ends, bond: b as u32, stretch: stretch(z), s00, alpha });
            }
        }
    }

    fn family(&self, site: u32, options: &FamilyOptions, mut f: impl FnMut(f64, f64, f64)) {
        let body = &*self.0;
        body.around(site as usize, |other, b| {
            if body.lives(b) {
                let pair = body.constants(b);
                let (z, length) = body.z(true, site as usize, other, self.1);
                f(banded(z, length, options), pair.s00, pair.alpha);
            }
        });
    }

    fn measure<K: StretchKernels>(&mut self, groups: &[u32], options: &FamilyOptions, values: &mut [f64]) {
        let [PairConstants { s00, alpha, .. }] = self.0.pairs[..] else {
            // Bonds of several pairs have several limits: which is the least stretched says nothing of the others.
            let body = &*self;
            par::each((values, groups), |_, (values, groups)| {
                for (value, &site) in values.iter_mut().zip(groups) {
                    *value = measure(body, site, options);
                }
            });
            return;
        };
        let mut slackest = std::mem::take(&mut self.0.slackest);
        slackest.resize(self.0.record.len(), UNKNOWN);
        let (shared, body) = (Shared::new(&mut slackest), &*self);
        par::each((values, groups), |_, (values, groups)| {
            for (value, &site) in values.iter_mut().zip(groups) {
                let (z, bond) = body.slackest_of(site as usize, options);
                // A larger z is a larger stretch, and alpha is not negative.
                *value = match (bond, options.compat_lammps) {
                    (UNKNOWN, true) => f64::NEG_INFINITY,
                    (UNKNOWN, false) => f64::INFINITY,
                    (_, true) => s00 - alpha * stretch(z),
                    (_, false) => stretch(z),
                };
                // SAFETY: each site is asked for once.
                unsafe { shared.get(site as usize..site as usize + 1)[0] = bond };
            }
        });
        self.0.slackest = slackest;
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

    fn measures(&mut self) -> &mut Measures {
        &mut self.0.measures
    }

    fn sites(&self) -> usize {
        self.0.record.len()
    }
    fn particle(&self, site: u32) -> u32 {
        self.0.particle[site as usize]
    }
}
