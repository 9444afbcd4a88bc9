//! Which bonds of lattices break: after the forces of a step, from stretches of this step and families of the one before.
//!
//! A bond breaks when its stretch exceeds s00 − alpha max(s_min,i, s_min,j), s_min being the smallest stretch
//! among the bonds a particle had in the previous step, those that broke in it included. Under `compat lammps`
//! it breaks above min(s0_i, s0_j) with one s0 = max(s00 − alpha s) per particle, whatever the pair.
//!
//! Both measures are needed for few particles only: where a bond's stretch exceeds s00 − alpha m with an m that is sure to be
//! no less than max(s_min,i, s_min,j). Its own previous stretch is one, for the bond belongs to both families; the previous
//! stretches of the bonds that were the least ones of both families when these were looked at last are mostly a far better one.

use crate::families::list::ListBody;
use crate::families::{Candidate, Cell, FamilyOptions, Measures};
use crate::law::series::stretch;
use perigrain_base::math::form::Form;

/// A layout, as breaking sees it. Sites are cells or records.
pub trait Bonds: Sync + Sized {
    /// How many sites are measured together.
    const GROUP: usize;
    /// Finds bonds stretched beyond what is sure to allow it, their own previous stretch or more, in order.
    fn candidates(&self, form: Form, found: &mut Vec<Candidate>);
    /// Calls `f(previous stretch, s00, alpha)` for each living bond of a site.
    fn family(&self, site: u32, options: &FamilyOptions, f: impl FnMut(f64, f64, f64));
    /// Gets ready for [`Bonds::candidates`].
    fn prepare(&mut self) {}
    /// The smallest previous stretch of the families of all sites in `groups`, or LAMMPS' critical stretch.
    fn measure(&mut self, form: Form, groups: &[u32], options: &FamilyOptions, values: &mut [f64]);
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

/// Finds what has to break, except bonds of particles that are `spared`.
pub fn find_broken<B: Bonds>(
    form: Form,
    body: &mut B,
    options: &FamilyOptions,
    found: &mut Vec<Candidate>,
    spared: &dyn Fn(u32) -> bool,
) {
    found.clear();
    body.prepare();
    body.candidates(form, found);
    found.retain(|c| !c.ends.iter().any(|site| spared(body.particle(*site))));
    if !found.is_empty() && (options.one_stretch() || found.iter().any(|c| c.alpha != 0.0)) {
        judge(form, body, options, found);
    } else {
        found.retain(|c| c.stretch > c.s00);
    }
}

/// Keeps the candidates that exceed their limit.
fn judge<B: Bonds>(form: Form, body: &mut B, options: &FamilyOptions, found: &mut Vec<Candidate>) {
    let mut measures = std::mem::take(body.measures());
    measures.start(body.sites().div_ceil(B::GROUP));
    for site in found.iter().flat_map(|c| c.ends) {
        measures.ask(site / B::GROUP as u32);
    }
    let (groups, values) = measures.to_fill(B::GROUP);
    body.revive(true);
    body.measure(form, groups, options, values);
    body.revive(false);
    found.retain(|c| {
        let [a, b] = c.ends.map(|site| measures.of(site, B::GROUP));
        let limit = if options.one_stretch() { a.min(b) } else { c.s00 - c.alpha * a.max(b) };
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
    if options.one_stretch() { most } else { least }
}

/// A stretch, or 0 inside the dead band.
pub fn banded(z: f64, length: f64, options: &FamilyOptions) -> f64 {
    if z.abs() < options.dead_band(length) { 0.0 } else { stretch(z) }
}

impl ListBody {
    /// z of the bond between two records, from displacements of this step or of the last one, and |xi|.
    pub(super) fn z(&self, last: bool, i: usize, j: usize, cell: &Cell) -> (f64, f64) {
        let (a, b) = (&self.record[i], &self.record[j]);
        let (mut q, mut square) = (0.0, 0.0);
        let (period, strained) = (&cell.birth, cell.strained());
        let (tilted, mut nearest) = (period.tilted(), [0.0; 3]);
        if tilted {
            nearest = period.nearest(std::array::from_fn(|k| b.reference[k] - a.reference[k]));
        }
        let mut away = [0.0; 3];
        if strained {
            let d: [f64; 3] = std::array::from_fn(|k| b.reference[k] - a.reference[k]);
            let near = period.nearest(d);
            away = cell.shift(last, std::array::from_fn(|k| d[k] - near[k]));
        }
        for k in 0..3 {
            let mut xi = b.reference[k] - a.reference[k];
            let length = period.length[k];
            if tilted {
                xi = nearest[k];
            } else if length > 0.0 && xi.abs() > 0.5 * length {
                xi -= length * (xi / length).round();
            }
            let mut eta = if last { self.last[j][k] - self.last[i][k] } else { b.u[k] - a.u[k] };
            if strained {
                eta -= away[k];
            }
            q += eta * (2.0 * xi + eta);
            square += xi * xi;
        }
        (q / square, square.sqrt())
    }
}
