//! The plain textbook loop: every bond from both ends, every pair tested for contact. The reference for all layouts.

use perigrain_peri::families::*;

/// Families as full lists.
#[derive(Clone)]
pub struct Textbook {
    table: PmbTable,
    options: FamilyOptions,
    armed: bool,
    rows: Vec<Vec<Bond>>,
    family_volume: Vec<f64>,
    limit: Vec<f64>,
}

#[derive(Clone, Copy)]
struct Bond {
    partner: usize,
    r0: f64,
    alive: bool,
}

fn between(x: &[[f64; 3]], i: usize, j: usize, view: &PeriView) -> [f64; 3] {
    view.bounds.nearest([0, 1, 2].map(|k| x[i][k] - x[j][k]))
}

fn length(d: [f64; 3]) -> f64 {
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

impl Textbook {
    pub fn build(view: &PeriView, table: &PmbTable, options: FamilyOptions) -> Self {
        let n = view.x.len();
        let mut rows = vec![vec![]; n];
        let mut family_volume = vec![0.0; n];
        for i in 0..n {
            for j in (0..n).filter(|&j| j != i) {
                let Some(coeff) = table.get(view.kind[i], view.kind[j]) else { continue };
                let r0 = length(between(view.x, i, j, view));
                if r0 <= options.volume.reach(coeff.horizon, options.lattice_spacing) {
                    rows[i].push(Bond { partner: j, r0, alive: true });
                    family_volume[i] += view.volume[j];
                }
            }
        }
        Self { table: table.clone(), options, armed: false, rows, family_volume, limit: vec![0.0; n] }
    }

    pub fn force(&mut self, view: &PeriView, f: &mut [[f64; 3]], advance: bool) {
        self.short_range(view, f);
        let compat = self.options.compat_lammps;
        let newton = self.options.unit == ForceUnit::Newton;
        let mut next = vec![f64::INFINITY; self.rows.len()];
        let mut broken = Vec::new();
        for i in 0..self.rows.len() {
            let mut most = f64::NEG_INFINITY;
            for (b, bond) in self.rows[i].iter().enumerate().filter(|(_, b)| b.alive) {
                let (j, r0) = (bond.partner, bond.r0);
                let coeff = self.table.get(view.kind[i], view.kind[j]).unwrap();
                let d = between(view.x, i, j, view);
                let r = length(d);
                let tiny = if compat { 2.2204e-16 } else { 4e-13 * r0 };
                let dr = if (r - r0).abs() < tiny { 0.0 } else { r - r0 };
                let stretch = dr / r0;
                let weight = self.options.volume.weight(r0, coeff.horizon, self.options.lattice_spacing);
                let volumes = if newton { view.volume[i] * view.volume[j] } else { view.volume[j] };
                let pull = -coeff.c * volumes * weight * stretch / r;
                (0..3).for_each(|k| f[i][k] += d[k] * pull);
                let limit = match compat {
                    true => self.limit[i].min(self.limit[j]),
                    false => coeff.s00 - coeff.alpha * self.limit[i].max(self.limit[j]),
                };
                if self.armed && stretch > limit {
                    broken.push((i, b));
                }
                most = most.max(coeff.s00 - coeff.alpha * stretch);
                next[i] = if compat { most } else { next[i].min(stretch) };
            }
        }
        if advance {
            broken.into_iter().for_each(|(i, b)| self.rows[i][b].alive = false);
            self.limit = next;
            self.armed = true;
        }
    }

    fn short_range(&self, view: &PeriView, f: &mut [[f64; 3]]) {
        let (reach, bounds) = (1.35 * self.options.lattice_spacing, &view.bounds);
        for i in 0..view.x.len() {
            for j in i + 1..view.x.len() {
                // What is far along one axis, in the box and in the next one, need not be looked at.
                let far = |k: usize| {
                    let apart = (view.x[i][k] - view.x[j][k]).abs();
                    let length = bounds.hi[k] - bounds.lo[k];
                    let images = apart < 1.5 * length && (length - apart).abs() >= reach && !bounds.tilted();
                    apart >= reach && (!bounds.periodic[k] || images)
                };
                if far(0) || far(1) || far(2) {
                    continue;
                }
                let d = between(view.x, i, j, view);
                let r = length(d);
                if r >= reach {
                    continue;
                }
                let Some(coeff) = self.table.get(view.kind[i], view.kind[j]) else { continue };
                let contact = (0.9 * length(between(view.x0, i, j, view))).min(reach);
                if r >= contact {
                    continue;
                }
                let (vi, vj) = match (self.options.unit, self.options.compat_lammps) {
                    (ForceUnit::Newton, _) => {
                        (view.volume[i] * view.volume[j], view.volume[i] * view.volume[j])
                    }
                    (_, true) => (view.volume[j], view.volume[j]),
                    (_, false) => (view.volume[i], view.volume[j]),
                };
                let pull = -15.0 * coeff.c * (r - contact) / coeff.horizon / r;
                for k in 0..3 {
                    f[i][k] += d[k] * pull * vj;
                    f[j][k] -= d[k] * pull * vi;
                }
            }
        }
    }

    pub fn damage(&self, volume: &[f64]) -> Vec<f64> {
        let live = |row: &Vec<Bond>| row.iter().filter(|b| b.alive).map(|b| volume[b.partner]).sum::<f64>();
        let damage = |(row, &all): (&Vec<Bond>, &f64)| if all == 0.0 { 0.0 } else { 1.0 - live(row) / all };
        self.rows.iter().zip(&self.family_volume).map(damage).collect()
    }

    /// Removes particles: their bonds end, the others move.
    pub fn remap(&mut self, old_to_new: &[Option<u32>]) {
        let n = old_to_new.iter().flatten().count();
        let (mut rows, mut volumes, mut limits) = (vec![vec![]; n], vec![0.0; n], vec![0.0; n]);
        for (i, new) in old_to_new.iter().enumerate() {
            let Some(new) = new.map(|n| n as usize) else { continue };
            volumes[new] = self.family_volume[i];
            limits[new] = self.limit[i];
            let kept = |b: &Bond| old_to_new[b.partner].map(|p| Bond { partner: p as usize, ..*b });
            rows[new] = self.rows[i].iter().filter_map(kept).collect();
        }
        (self.rows, self.family_volume, self.limit) = (rows, volumes, limits);
    }
}
