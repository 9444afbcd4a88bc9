//! Sums over the bonds of each particle: every particle gathers its own, in the order of the stencil or of the list, so that the result
//! is the same for any number of threads.

use super::{Conduction, Conductors};
use crate::families::lattice::{LANES, LatticeBody};
use crate::families::list::ListBody;
use crate::families::{Cell, Families, Influence};
use perigrain_base::par::{self, Shared};

/// Rows of a lattice in one task.
const ROWS: usize = 16;

impl Conduction {
    /// Σ g (T_j − T_i), or Σ g alone where `WHOLE`.
    pub(super) fn gather<const WHOLE: bool>(
        &self,
        families: &Families,
        ends: &Conductors,
        t: &[f64],
        out: &mut [f64],
    ) {
        out.fill(0.0);
        let out = Shared::new(out);
        for (body, weights) in families.lattices.iter().zip(&self.lattices) {
            let cells = Cells::of(body, ends, t);
            par::for_rows(body.rows.len().div_ceil(ROWS), |part| {
                for slot in part * ROWS..body.rows.len().min((part + 1) * ROWS) {
                    let mut sums = vec![0.0; body.rows[slot].len as usize];
                    row::<WHOLE>(body, slot, (weights, self.cracks), &cells, &mut sums);
                    let particles = &body.particle[body.rows[slot].cells()];
                    for (&p, sum) in particles.iter().zip(sums).filter(|(p, _)| **p != u32::MAX) {
                        // SAFETY: each particle stands in one cell, and each row is one task's.
                        unsafe { out.get(p as usize..p as usize + 1)[0] = sum };
                    }
                }
            });
        }
        let list = &families.list;
        par::for_chunks(list.particle.len(), |records| {
            for i in records.filter(|i| list.particle[*i] != u32::MAX) {
                let sum = record::<WHOLE>(list, i, (&self.list, self.cracks), ends, t);
                let p = list.particle[i] as usize;
                // SAFETY: each particle has one record.
                unsafe { out.get(p..p + 1)[0] = sum };
            }
        });
    }
}

/// The columns of a lattice in the order of its cells; vacant ones conduct nothing.
struct Cells {
    share: Vec<f64>,
    volume: Vec<f64>,
    t: Vec<f64>,
}

impl Cells {
    fn of(body: &LatticeBody, ends: &Conductors, t: &[f64]) -> Self {
        let by_cells = |column: &[f64]| {
            let mut cells = vec![0.0; body.particle.len()];
            par::each((&mut cells[..], &body.particle[..]), |_, (cells, particle): (&mut [f64], &[u32])| {
                for (cell, &p) in cells.iter_mut().zip(particle).filter(|(_, p)| **p != u32::MAX) {
                    *cell = column[p as usize];
                }
            });
            cells
        };
        Self { share: by_cells(&ends.share), volume: by_cells(&ends.volume), t: by_cells(t) }
    }
}

/// Adds to each cell of a row what its bonds conduct, those that it owns and those that lead to it.
fn row<const WHOLE: bool>(
    body: &LatticeBody,
    slot: usize,
    (weights, cracks): (&[f64], f64),
    cells: &Cells,
    sums: &mut [f64],
) {
    let row = body.rows[slot];
    let (start, entries, conducts) = (row.start as usize, body.stencil.len(), [cracks, 1.0]);
    let mut along = |other: usize, [shift, e]: [isize; 2], owns: bool| {
        let Some(far) = body.rows.get(other).filter(|far| far.len > 0) else { return };
        // The cell of the row that is first in the other one, and one beyond the last.
        let offset = row.lo as isize + shift - far.lo as isize;
        let (first, end) = ((-offset).max(0), (far.len as isize - offset).min(row.len as isize));
        let (weight, e) = (weights[e as usize], e as usize);
        for k in first..end {
            let (i, j) = (start + k as usize, (far.start as isize + k + offset) as usize);
            let owner = if owns { i } else { j };
            let lives = body.alive[owner / LANES * entries + e] >> (owner % LANES) & 1;
            let pair = cells.share[i] * cells.volume[j] + cells.volume[i] * cells.share[j];
            let g = conducts[usize::from(lives)] * weight * pair;
            sums[k as usize] += if WHOLE { g } else { g * (cells.t[j] - cells.t[i]) };
        }
    };
    for (e, &[step, across, up]) in body.stencil.iter().enumerate() {
        let (step, across, up) = (step as isize, across as isize, up as usize * body.width);
        along((slot + up).wrapping_add_signed(across), [step, e as isize], true);
        if let Some(back) = slot.wrapping_add_signed(-across).checked_sub(up) {
            along(back, [-step, e as isize], false);
        }
    }
}

/// What the bonds of a record conduct.
fn record<const WHOLE: bool>(
    list: &ListBody,
    i: usize,
    (weights, cracks): (&[f64], f64),
    ends: &Conductors,
    t: &[f64],
) -> f64 {
    let (own, mut sum) = (list.particle[i] as usize, 0.0);
    list.around(i, |j, b| {
        let Some(far) = list.particle.get(j).filter(|p| **p != u32::MAX).map(|p| *p as usize) else { return };
        let pair = ends.share[own] * ends.volume[far] + ends.volume[own] * ends.share[far];
        let g = if list.lives(b) { 1.0 } else { cracks } * weights[b] * pair;
        sum += if WHOLE { g } else { g * (t[far] - t[own]) };
    });
    sum
}

/// ω w of the bonds of the list; 0 for fillers.
pub(super) fn list_weights(families: &Families, influence: Influence) -> Vec<f64> {
    let (list, cell) = (&families.list, Cell::unstrained(families.birth.periods()));
    let mut weights = vec![0.0; list.partner.len()];
    par::each(&mut weights[..], |start, weights: &mut [f64]| {
        for (k, weight) in weights.iter_mut().enumerate() {
            let b = start + k;
            let (i, j) = (list.owner[b / crate::families::list::GROUP] as usize, list.partner[b] as usize);
            if i != j {
                let length = list.z(false, i, j, &cell).1;
                *weight = influence.of(length, list.constants(b).horizon) * list.weight(b, length);
            }
        }
    });
    weights
}
