//! How near bonds are to their limits, in the latest evaluation of forces.

use crate::breaking::{Bonds, banded, measure};
use crate::families::list::ListBody;
use crate::families::{Cell, Criterion, Families, FamilyOptions, PeriView};
use perigrain_base::par;
use std::ops::Range;

/// A living bond: the site at its other end, its stretch less thermal strain, s00 and alpha.
type Pulled = (usize, f64, f64, f64);

impl Families {
    /// The largest load ratio ρ of the bonds that live: stretch over critical stretch, or what another criterion compares, as
    /// breaking judges it from this evaluation and the last one that advanced. Bonds break where it is above 1. It is 0 where no bond is pulled or none can break;
    /// bonds of particles that are spared do not count.
    pub fn load_ratio(&self, view: &PeriView) -> f64 {
        let (cell, options) = (self.cell(view), &self.options);
        if options.criterion != Criterion::Stretch {
            return self.largest_ratio(view, &cell);
        }
        let lasts = |p: u32| self.lasting.get(p as usize).copied().unwrap_or(false);
        let mut most = 0.0;
        for body in &self.lattices {
            let bonds = |site: usize, each: &mut dyn FnMut(Pulled)| {
                let slot = body.slot_of(site);
                for e in 0..body.stencil.len() {
                    let Some(to) = body.ahead(slot, site, e).filter(|_| body.lives(site, e)) else {
                        continue;
                    };
                    if lasts(body.particle[to]) {
                        continue;
                    }
                    let length = body.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                    let [_, s00, alpha] = body.pair(site, to);
                    let stretch = banded(body.z(1, site, to, e), length, options);
                    each((to, stretch - body.scatter.strain_between([site, to]), s00, alpha));
                }
            };
            let breaks = |site: usize| body.particle[site] != u32::MAX && !lasts(body.particle[site]);
            let measured = |site: usize| measure(body, site as u32, options);
            most = f64::max(most, largest(body.sites(), options, breaks, bonds, measured));
        }
        let list = &self.list;
        let bonds = |site: usize, each: &mut dyn FnMut(Pulled)| {
            for b in list.own(site).filter(|b| list.lives(*b)) {
                let (to, pair) = (list.partner[b] as usize, list.constants(b));
                if lasts(list.particle[to]) {
                    continue;
                }
                let (z, length) = list.z(false, site, to, &cell);
                let s00 = pair.s00 * list.scatter.strength([site, to]);
                let stretch = banded(z, length, options) - list.scatter.strain_between([site, to]);
                each((to, stretch, s00, pair.alpha));
            }
        };
        let breaks = |site: usize| list.particle[site] != u32::MAX && !lasts(list.particle[site]);
        let measured = |site: usize| least(list, site, &cell, options);
        most.max(largest(list.record.len(), options, breaks, bonds, measured))
    }
}

/// The smallest stretch of a record's family in the last evaluation that advanced, or LAMMPS' critical stretch.
fn least(list: &ListBody, site: usize, cell: &Cell, options: &FamilyOptions) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    list.around(site, |other, b| {
        if list.lives(b) {
            let (z, length) = list.z(true, site, other, cell);
            let (stretch, pair) = (banded(z, length, options), list.constants(b));
            let s00 = pair.s00 * list.scatter.strength([site, other]);
            (least, most) = (least.min(stretch), most.max(s00 - pair.alpha * stretch));
        }
    });
    if options.one_stretch() { most } else { least }
}

/// The largest ratio of a body's bonds, of which each site has those that it owns; only at some sites they break.
fn largest(
    sites: usize,
    options: &FamilyOptions,
    breaks: impl Fn(usize) -> bool + Sync,
    bonds: impl Fn(usize, &mut dyn FnMut(Pulled)) + Sync,
    measured: impl Fn(usize) -> f64 + Sync,
) -> f64 {
    let one = options.one_stretch();
    let of_sites = |range: Range<usize>| {
        let mut most = 0.0f64;
        for site in range.filter(|site| breaks(*site)) {
            bonds(site, &mut |(other, stretch, s00, alpha)| {
                if stretch <= 0.0 || !s00.is_finite() {
                    return;
                }
                let limit = match (one, alpha == 0.0) {
                    (false, true) => s00,
                    (false, false) => s00 - alpha * measured(site).max(measured(other)),
                    (true, _) => measured(site).min(measured(other)),
                };
                most = most.max(if limit > 0.0 { stretch / limit } else { f64::INFINITY });
            });
        }
        most
    };
    par::reduce(sites, of_sites, f64::max).unwrap_or(0.0)
}
