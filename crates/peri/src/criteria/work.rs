//! The work done on each bond from the start on, w = ∫ (t_i + t_j) d|y| over both volumes, by the trapezoidal rule
//! (Foster, Silling & Chen 2011).

use super::tension::{InList, OnLattice, Rules};
use super::{PART, each_of_row};
use crate::families::lattice::LANES;
use crate::families::{Cell, Families, PeriView};
use perigrain_base::par::{self, Shared};

impl Families {
    /// Adds the work of the step that advances, whose forces are known, to every living bond.
    pub(crate) fn work_on_bonds(&mut self, view: &PeriView, cell: &Cell) {
        let Self { lattices, list, law, options, table, .. } = self;
        let rules = &Rules { law, options, table };
        for body in lattices.iter_mut() {
            let mut work = std::mem::take(&mut body.work);
            let entries = body.stencil.len();
            work.resize(body.alive.len() * LANES, [0.0; 2]);
            let (shared, bonds) = (Shared::new(&mut work), OnLattice::new(rules, body, view));
            par::for_rows(body.planes, |plane| {
                for slot in body.slot(plane, 0)..body.slot(plane + 1, 0) {
                    let chunks = body.rows[slot].chunks();
                    let first = chunks.start * entries * LANES;
                    // SAFETY: each row has its own bonds.
                    let own = unsafe { shared.get(first..chunks.end * entries * LANES) };
                    each_of_row(body, slot, |cell, to, e| {
                        let before = bonds.length_before(cell, to, e);
                        add(&mut own[body.place_of(cell, e) - first], bonds.tension(cell, to, e), before);
                    });
                }
            });
            body.work = work;
        }
        let mut work = std::mem::take(&mut list.work);
        work.resize(list.partner.len(), [0.0; 2]);
        let (shared, n) = (Shared::new(&mut work), list.record.len());
        let bonds = InList { rules, list, cell };
        par::for_rows(n.div_ceil(PART), |part| {
            for i in part * PART..n.min((part + 1) * PART) {
                let places = list.own(i);
                // SAFETY: each record has its own bonds.
                let own = unsafe { shared.get(places.clone()) };
                for (b, own) in places.zip(own).filter(|(b, _)| list.lives(*b)) {
                    add(own, bonds.tension(b), bonds.length_before(b));
                }
            }
        });
        list.work = work;
    }
}

/// Adds ½ (T + T') (l' − l), and keeps T'.
pub(super) fn add([work, last]: &mut [f64; 2], [tension, length]: [f64; 2], before: f64) {
    *work += 0.5 * (*last + tension) * (length - before);
    *last = tension;
}
