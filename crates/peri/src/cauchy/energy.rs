//! Energy and virial of sites under correspondence, of the last evaluation.
//!
//! ```text
//! U_i = V_i [W(F_i) + ½ γ_i tr Z_i]        Z_i = Σ ω w z⊗z V_j,   z = eta − E xi
//! virial_i = −V_i [P Fᵀ + γ_i Z_i]         whose sum over sites is −Σ f⊗y over bonds
//! ```
//!
//! A pass over all bonds of each site, from both ends: sums of squares of eta and E would lose the digits of z in bodies that turn.

use crate::cauchy::site::{Places, gradient};
use crate::families::lattice::{LatticeBody, PAD};
use crate::families::list::ListBody;
use crate::families::view::Sums;
use crate::families::{Cell, Families, ForceUnit, PeriTally, PeriView};
use crate::law::state::SiteState;
use perigrain_base::math::vec3::SIX;
use perigrain_base::par::{self, CHUNK, Shared};
use perigrain_constitutive::Mat3;

/// One bond of a site: xi, eta, and ω w V of the other end.
type Bond = ([f64; 3], [f64; 3], f64);

/// Calls a function for each bond of a site.
type Each<'a> = &'a (dyn Fn(usize, &mut dyn FnMut(Bond)) + Sync);

/// Adds energy and virial of all sites as of the last evaluation.
pub(crate) fn tally(families: &mut Families, view: &PeriView, cell: &Cell, t: &mut PeriTally) {
    let mut rows = std::mem::take(&mut families.scratch.rows);
    for body in &families.lattices {
        let (law, options) = (&families.law, &families.options);
        let weigh = |e: usize| {
            let xi = body.xi(e);
            let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
            let weight = options.volume.weight(length, body.horizon, options.lattice_spacing);
            (xi, law.influence.of(length, body.horizon) * weight)
        };
        let stencil: Vec<_> = (0..body.stencil.len()).map(weigh).collect();
        let each = |cell: usize, f: &mut dyn FnMut(Bond)| bonds_of_cell(body, view, &stencil, cell, f);
        let places = Places::columns(body.stride);
        sites(families, (&body.state, &body.particle, PAD), (view, places), (&each, &mut rows), t);
    }
    let (list, law) = (&families.list, &families.law);
    let each = |record: usize, f: &mut dyn FnMut(Bond)| {
        list.around(record, |other, b| {
            if list.lives(b) {
                let (xi, eta) = list.bond(record, other, cell);
                let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
                let omega = law.influence.of(length, list.constants(b).horizon);
                f((xi, eta, omega * list.weight(b, length) * list.record[other].volume));
            }
        });
    };
    sites(families, (&list.state, &list.particle, 0), (view, Places::RECORDS), (&each, &mut rows), t);
    families.scratch.rows = rows;
}

/// Calls `f` for each living bond of a cell.
fn bonds_of_cell(
    body: &LatticeBody,
    view: &PeriView,
    stencil: &[([f64; 3], f64)],
    cell: usize,
    f: &mut dyn FnMut(Bond),
) {
    let u = |k: usize, c: usize| body.u[1][k * body.stride + PAD + c];
    body.around(cell, |other, owner, e| {
        if body.lives(owner, e) {
            let (xi, share) = &stencil[e];
            let sign = if owner == cell { 1.0 } else { -1.0 };
            let eta = [0, 1, 2].map(|k| u(k, other) - u(k, cell));
            f((xi.map(|x| sign * x), eta, share * view.volume[body.particle[other] as usize]));
        }
    });
}

/// Adds the sites of a body, whose columns have so many unused entries; `each` calls a function for the bonds of a site.
fn sites(
    families: &Families,
    (state, particle, pad): (&SiteState, &[u32], usize),
    (view, places): (&PeriView, Places),
    (each, rows): (Each, &mut Vec<Sums>),
    t: &mut PeriTally,
) {
    let own = &state.continuum;
    if own.energy.len() != particle.len() || own.inverse.len() != particle.len() {
        // Nothing has been evaluated.
        return;
    }
    let (law, newton) = (&families.law, families.options.unit == ForceUnit::Newton);
    let site = |site: usize| -> Option<Sums> {
        let p = particle[site] as usize;
        let (kind, volume) = (*view.kind.get(p)?, *view.volume.get(p)?);
        if own.inverse[site][0] <= 0.0 {
            return None;
        }
        let h: Mat3 = std::array::from_fn(|a| std::array::from_fn(|c| state.sums[places.at(site, a, c)]));
        let e = gradient(&h, &own.inverse[site]);
        let gamma = law.control * 15.0 * law.of(kind).shear / state.weighted[pad + site];
        let mut apart = [0.0; 6];
        each(site, &mut |(xi, eta, share)| {
            let z = [0, 1, 2].map(|a| eta[a] - (e[a][0] * xi[0] + e[a][1] * xi[1] + e[a][2] * xi[2]));
            apart.iter_mut().zip(SIX).for_each(|(sum, (a, b))| *sum += share * z[a] * z[b]);
        });
        let energy = own.energy[site] + 0.5 * gamma * (apart[0] + apart[1] + apart[2]);
        let mut sums = [if newton { energy * volume } else { energy }; 7];
        for k in 0..6 {
            sums[1 + k] = -volume * (own.stress[site][k] + gamma * apart[k]);
        }
        Some(sums)
    };
    if t.per_atom() {
        for k in 0..particle.len() {
            let (p, Some(sums)) = (particle[k] as usize, site(k)) else { continue };
            if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
                atoms[p] += sums[0];
            }
            if let Some(atoms) = t.per_atom_virial.as_deref_mut() {
                atoms[p].iter_mut().zip(&sums[1..]).for_each(|(v, own)| *v += own);
            }
            t.collect(&[sums]);
        }
        return;
    }
    rows.clear();
    rows.resize(particle.len().div_ceil(CHUNK), [0.0; 7]);
    let shared = Shared::new(rows);
    par::for_chunks(particle.len(), |range| {
        let row = range.start / CHUNK;
        // SAFETY: each chunk has a row of its own.
        let row = unsafe { &mut shared.get(row..row + 1)[0] };
        for sums in range.filter_map(site) {
            row.iter_mut().zip(sums).for_each(|(row, own)| *row += own);
        }
    });
    t.collect(rows);
}

impl ListBody {
    /// xi and eta of the bond between two records.
    fn bond(&self, i: usize, j: usize, cell: &Cell) -> ([f64; 3], [f64; 3]) {
        let (a, b) = (&self.record[i], &self.record[j]);
        let apart: [f64; 3] = std::array::from_fn(|k| b.reference[k] - a.reference[k]);
        let xi = cell.birth.nearest(apart);
        let mut eta: [f64; 3] = std::array::from_fn(|k| b.u[k] - a.u[k]);
        if cell.strained() {
            let away = cell.shift(false, std::array::from_fn(|k| apart[k] - xi[k]));
            eta.iter_mut().zip(away).for_each(|(eta, away)| *eta -= away);
        }
        (xi, eta)
    }
}
