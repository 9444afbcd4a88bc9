//! How long a step peridynamic bodies stand: from the largest frequency of the scene as it is, and by two estimates.

use crate::evaluate::periods;
use crate::families::{Families, ForceUnit, PeriView};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::par;

/// Displacements that forces are differentiated with, in sizes of a particle: stretches of 1e-6 are far above rounding
/// (some 1e-14 of a stretch) and far below where bonds bend the force (1e-6 of it).
const SMALL: f64 = 1e-6;
/// Most forces asked for, in pairs.
const MOST: usize = 300;
/// The search ends when ten more vectors raise the square of the frequency by less than this part: on lattices the rest
/// is then below 5e-4, so the step is right to 3e-4.
const SETTLED: f64 = 1e-4;

impl Families {
    /// The largest eigenvalue ω² of M⁻¹K [1/time²], K being the derivative of the present forces (bonds that live, under
    /// their law, with the tension they have), by Lanczos' method, which contains power iteration and is never worse.
    /// Nothing changes or breaks. A step of velocity Verlet is stable below 2/ω. `None` without bonds.
    pub fn largest_eigenvalue(&self, view: &PeriView, mass: &[f64], ftm2v: f64) -> Option<f64> {
        let mut k = Stiffness::new(self, view, mass, ftm2v)?;
        let n = k.members.len();
        let mut stream = ParkMiller::new(12345);
        let mut q: Vec<[f64; 3]> = (0..n).map(|_| [0; 3].map(|_| stream.uniform() - 0.5)).collect();
        normalize(&mut q);
        let mut before = vec![[0.0; 3]; n];
        let (mut diagonal, mut beside, mut tops) = (vec![], Vec::<f64>::new(), Vec::<f64>::new());
        for _ in 0..MOST {
            let mut next = k.times(view, &q);
            let along = dot(&next, &q);
            let back = beside.last().copied().unwrap_or(0.0);
            combine(&mut next, &q, -along);
            combine(&mut next, &before, -back);
            diagonal.push(along);
            let top = largest(&diagonal, &beside);
            tops.push(top);
            let settled = tops.len() > 20 && top - tops[tops.len() - 11] < SETTLED * top;
            let size = normalize(&mut next);
            // Beyond this the space is used up: what is left is the error of differences.
            if settled || size <= SMALL * top.abs() {
                break;
            }
            beside.push(size);
            before = std::mem::replace(&mut q, next);
        }
        tops.last().copied().filter(|top| *top > 0.0)
    }

    /// The step of Silling & Askari (2005), √(2 ρ/Σ c w V/|ξ|) over the bonds that live, about half the true limit; c is
    /// 18K/(πδ⁴) for state-based laws. `None` without bonds.
    pub fn silling_step(&self, view: &PeriView, density: &[f64], ftm2v: f64) -> Option<f64> {
        let periods = periods(&view.bounds);
        let step = |i: usize| {
            let mut stiffness = 0.0;
            self.each_apart(i, periods, |b, length| {
                let j = b.partner as usize;
                let Some(p) = self.table.get(view.kind[i], view.kind[j]).filter(|_| b.alive) else { return };
                let weight = self.options.volume.weight(length, p.horizon, self.options.lattice_spacing);
                stiffness += p.c * weight * view.volume[j] / length;
            });
            (stiffness > 0.0).then(|| (2.0 * density[i] / (ftm2v * stiffness)).sqrt())
        };
        let chunk = |range: std::ops::Range<usize>| range.filter_map(step).fold(f64::INFINITY, f64::min);
        par::reduce(view.x.len(), chunk, f64::min).filter(|dt| dt.is_finite())
    }

    /// The step h/√(K/ρ) of Hartmann et al. (2022, equations 41 and 42), h = V^⅓. `None` without bonds.
    pub fn sound_step(&self, view: &PeriView, density: &[f64], ftm2v: f64) -> Option<f64> {
        let step = |i: usize| {
            if self.family_size[i] == 0 {
                return None;
            }
            let p = self.table.get(view.kind[i], view.kind[i])?;
            let bulk = match self.law.kind.bond_based() {
                true => std::f64::consts::PI * p.c * p.horizon.powi(4) / 18.0,
                false => self.law.of(view.kind[i]).bulk,
            };
            Some(view.volume[i].cbrt() * (density[i] / (ftm2v * bulk)).sqrt())
        };
        (0..view.x.len().min(self.family_size.len())).filter_map(step).reduce(f64::min)
    }
}

/// The derivative of the forces, in coordinates √m u in which it is symmetric.
struct Stiffness {
    families: Families,
    members: Vec<usize>,
    /// √m of each member, m its true mass.
    root: Vec<f64>,
    /// 1/m in units of the force column, with the unit of force.
    inverse: Vec<f64>,
    size: f64,
    places: Vec<[f64; 3]>,
    forces: [Vec<[f64; 3]>; 2],
}

impl Stiffness {
    fn new(families: &Families, view: &PeriView, mass: &[f64], ftm2v: f64) -> Option<Self> {
        let sizes = &families.family_size;
        let members: Vec<usize> = (0..view.x.len().min(sizes.len())).filter(|&i| sizes[i] > 0).collect();
        let size = members.iter().map(|&i| view.volume[i].cbrt()).reduce(f64::min)?;
        let mut families = families.clone();
        families.options.skip_rest = false;
        let true_mass = |i: usize| match families.options.unit {
            ForceUnit::Density => mass[i] * view.volume[i],
            ForceUnit::Newton => mass[i],
        };
        let root = members.iter().map(|&i| true_mass(i).sqrt()).collect();
        let inverse = members.iter().map(|&i| ftm2v / mass[i]).collect();
        let forces = [vec![[0.0; 3]; view.x.len()], vec![[0.0; 3]; view.x.len()]];
        Some(Self { families, members, root, inverse, size, places: view.x.to_vec(), forces })
    }

    /// K q by central differences: what bends the force cancels.
    fn times(&mut self, view: &PeriView, q: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let most = q.iter().zip(&self.root).map(|(q, m)| q.map(|a| (a / m).abs()));
        let most = most.flatten().fold(0.0, f64::max);
        let step = SMALL * self.size / most;
        for (f, side) in self.forces.iter_mut().zip([step, -step]) {
            for ((&i, q), m) in self.members.iter().zip(q).zip(&self.root) {
                self.places[i] = std::array::from_fn(|d| view.x[i][d] + side * q[d] / m);
            }
            f.fill([0.0; 3]);
            let moved = PeriView { x: &self.places, ..*view };
            self.families.force(&moved, f, false, None);
        }
        let [ahead, behind] = &self.forces;
        let rows = self.members.iter().zip(self.root.iter().zip(&self.inverse));
        rows.map(|(&i, (m, inverse))| {
            std::array::from_fn(|d| (behind[i][d] - ahead[i][d]) * m * inverse / (2.0 * step))
        })
        .collect()
    }
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    par::sum(a.len(), |i| a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2])
}

/// a + s b.
fn combine(a: &mut [[f64; 3]], b: &[[f64; 3]], s: f64) {
    a.iter_mut().zip(b).for_each(|(a, b)| (0..3).for_each(|d| a[d] += s * b[d]));
}

/// Gives a vector the length 1; the length it had.
fn normalize(a: &mut [[f64; 3]]) -> f64 {
    let size = dot(a, a).sqrt();
    if size > 0.0 {
        a.iter_mut().flatten().for_each(|x| *x /= size);
    }
    size
}

/// The largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the signs of its minors.
fn largest(diagonal: &[f64], beside: &[f64]) -> f64 {
    let n = diagonal.len();
    let at = |k: usize| beside.get(k).map_or(0.0, |b| b.abs());
    let reach = |k: usize| at(k) + if k > 0 { at(k - 1) } else { 0.0 };
    let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut high = (0..n).map(|k| diagonal[k] + reach(k)).fold(f64::NEG_INFINITY, f64::max);
    let all_below = |x: f64| {
        let mut minor = diagonal[0] - x;
        (1..n).all(|k| {
            let below = minor < 0.0;
            minor = diagonal[k] - x - at(k - 1) * at(k - 1) / minor;
            below
        }) && minor < 0.0
    };
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if all_below(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    // Frequencies of lattices are compared with Bloch waves in tests/peri/limits.rs.
    #[test]
    fn the_top_of_a_chain() {
        // −1 2 −1: eigenvalues 2 − 2 cos(kπ/(n+1)).
        let top = largest(&[2.0; 9], &[1.0; 8]);
        assert!((top - (2.0 + 2.0 * (PI / 10.0).cos())).abs() < 1e-12, "{top}");
        assert_eq!(largest(&[3.0], &[]), 3.0);
    }
}
