//! Cracks made by hand: bonds cut before or between runs.

use crate::families::lattice::LANES;
use crate::families::{Families, Moved, PeriView};

impl Families {
    /// Breaks every living bond for which `cuts` is true of the places of its ends; returns how many.
    pub fn cut(&mut self, view: &PeriView, cuts: impl Fn([f64; 3], [f64; 3]) -> bool) -> usize {
        let mut ends = vec![];
        let (kind, frees) = (self.law.kind, self.law.kind.frees(self.options.compat_lammps));
        let cell = self.cell(view);
        let crosses = |i: u32, j: u32| {
            let (a, b) = (view.x[i as usize], view.x[j as usize]);
            let d = view.bounds.nearest([0, 1, 2].map(|k| b[k] - a[k]));
            cuts(a, [0, 1, 2].map(|k| a[k] + d[k]))
        };
        for body in &mut self.lattices {
            for cell in 0..body.particle.len() {
                let slot = body.slot_of(cell);
                for e in 0..body.stencil.len() {
                    if !body.lives(cell, e) {
                        continue;
                    }
                    let Some(to) = body.ahead(slot, cell, e) else { continue };
                    let (i, j) = (body.particle[cell], body.particle[to]);
                    if crosses(i, j) {
                        body.set(cell, e, false);
                        if frees {
                            body.free(cell, e, &kind, Moved::Before);
                        }
                        body.intact[cell / LANES] = false;
                        ends.push([i, j]);
                    }
                }
            }
        }
        let list = &mut self.list;
        for record in 0..list.record.len() {
            for b in list.own(record) {
                let (i, j) = (list.particle[record], list.particle[list.partner[b] as usize]);
                if list.lives(b) && crosses(i, j) {
                    list.end(b);
                    if frees {
                        list.free(b, &self.law, &cell, Moved::Before);
                    }
                    ends.push([i, j]);
                }
            }
        }
        for p in ends.iter().flatten() {
            self.damaged[*p as usize] = true;
        }
        if kind.correspondence {
            self.reshape(view, &ends);
        }
        if !ends.is_empty() {
            self.forget_near();
        }
        ends.len()
    }
}
