//! Cracks made by hand: bonds cut before or between runs.

use crate::families::lattice::LANES;
use crate::families::{Families, PeriView};

impl Families {
    /// Breaks every living bond for which `cuts` is true of the places of its ends; returns how many.
    pub fn cut(&mut self, view: &PeriView, cuts: impl Fn([f64; 3], [f64; 3]) -> bool) -> usize {
        let mut ends = vec![];
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
                    ends.push([i, j]);
                }
            }
        }
        for p in ends.iter().flatten() {
            self.damaged[*p as usize] = true;
        }
        if !ends.is_empty() {
            self.forget_near();
        }
        ends.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::{Bounds, FamilyOptions, Layout, PmbCoeff, PmbTable};

    #[test]
    fn a_plane_parts_a_row() {
        let x: Vec<[f64; 3]> = (0..10).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.5, s00: 1.0, alpha: 0.0 }).unwrap();
        let bounds = Bounds { lo: [-20.0; 3], hi: [20.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
        let view = PeriView { x: &x, x0: &x, kind: &[1; 10], volume: &[1.0; 10], bounds, excluded: None };
        for layout in [Layout::Auto, Layout::List] {
            let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
            let mut families = Families::build(&view, &table, options).unwrap();
            let before = families.live_bonds();
            // Between 4 and 5: the bonds 3-5, 4-5 and 4-6.
            assert_eq!(families.cut(&view, |a, b| (a[0] - 4.5) * (b[0] - 4.5) < 0.0), 3);
            assert_eq!(families.live_bonds(), before - 6);
            assert!(families.damage(4, &[1.0; 10]) == 0.5 && families.damage(0, &[1.0; 10]) == 0.0);
        }
    }
}
