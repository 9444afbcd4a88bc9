//! How long a step peridynamic bodies stand: from the largest frequency of the scene as it is, and by two estimates.

use crate::families::{Families, ForceUnit, PeriView};
use perigrain_base::math::lanczos::largest_eigenvalue;
use perigrain_base::par;

/// Displacements that forces are differentiated with, in sizes of a particle: stretches of 1e-6 are far above rounding
/// (some 1e-14 of a stretch) and far below where bonds bend the force (1e-6 of it).
const SMALL: f64 = 1e-6;

impl Families {
    /// The largest eigenvalue ω² of M⁻¹K [1/time²], K being the derivative of the present forces (bonds that live, under
    /// their law, with the tension they have), by Lanczos' method, which contains power iteration and is never worse.
    /// Nothing changes or breaks. A step of velocity Verlet is stable below 2/ω. `None` without bonds.
    pub fn largest_eigenvalue(&self, view: &PeriView, mass: &[f64], ftm2v: f64) -> Option<f64> {
        let mut k = Stiffness::new(self, view, mass, ftm2v)?;
        let n = k.members.len();
        largest_eigenvalue(n, SMALL, |q| k.times(view, q))
    }

    /// The step of Silling & Askari (2005), √(2 ρ/Σ c w V/|ξ|) over the bonds that live, about half the true limit; c is
    /// 18K/(πδ⁴) for state-based laws. `None` without bonds.
    pub fn silling_step(&self, view: &PeriView, density: &[f64], ftm2v: f64) -> Option<f64> {
        let step = |i: usize| {
            let (mut stiffness, own) = (0.0, self.stiffness_of(i));
            self.each_apart(i, |b, length| {
                let j = b.partner as usize;
                let Some(p) = self.table.get(view.kind[i], view.kind[j]).filter(|_| b.alive) else { return };
                let weight = self.share_of(i, &b, length, p.horizon);
                let factor = 0.5 * (own + self.stiffness_of(j));
                stiffness += factor * p.c * weight * view.volume[j] / length;
            });
            (stiffness > 0.0).then(|| (2.0 * density[i] / (ftm2v * stiffness)).sqrt())
        };
        let chunk = |range: std::ops::Range<usize>| range.filter_map(step).fold(f64::INFINITY, f64::min);
        par::reduce(view.x.len(), chunk, f64::min).filter(|dt| dt.is_finite())
    }

    /// Calls `f` for each living bond once with its ends and its stiffness as a bond by itself [force/length]: c w V_i V_j/|ξ|; for
    /// state-based laws ω w V_i V_j (k_i/m_i + k_j/m_j), k being the larger one of 9K and 15G, which no mode of a body exceeds, and 9K under
    /// correspondence.
    pub fn each_spring(&self, kinds: &[u16], volumes: &[f64], mut f: impl FnMut([u32; 2], f64)) {
        for i in 0..kinds.len().min(self.family_size.len()) {
            let own = self.stiffness_of(i);
            self.each_apart(i, |b, length| {
                let j = b.partner as usize;
                let Some(p) = self.table.get(kinds[i], kinds[j]).filter(|_| b.alive && i < j) else { return };
                let factor = 0.5 * (own + self.stiffness_of(j));
                if !self.law.kind.bond_based {
                    let share =
                        self.law.influence.of(length, p.horizon) * self.weight_of(&b, length, p.horizon);
                    let stiffness = factor * (self.of_modulus(i, kinds[i]) + self.of_modulus(j, kinds[j]));
                    return f([i as u32, b.partner], share * stiffness * volumes[i] * volumes[j]);
                }
                let weight = self.share_of(i, &b, length, p.horizon);
                f([i as u32, b.partner], factor * p.c * weight * volumes[i] * volumes[j] / length);
            });
        }
    }

    /// k/m of a particle.
    fn of_modulus(&self, i: usize, kind: u16) -> f64 {
        let (m, own) = (self.of_site(i, |state| &state.weighted), self.law.of(kind));
        let k = if self.law.kind.correspondence {
            9.0 * own.bulk
        } else {
            f64::max(9.0 * own.bulk, 15.0 * own.shear)
        };
        if m > 0.0 { k / m } else { 0.0 }
    }

    /// The step h/√(K/ρ) of Hartmann et al. (2022, equations 41 and 42), h = V^⅓. `None` without bonds.
    pub fn sound_step(&self, view: &PeriView, density: &[f64], ftm2v: f64) -> Option<f64> {
        let step = |i: usize| {
            if self.family_size[i] == 0 {
                return None;
            }
            let p = self.table.get(view.kind[i], view.kind[i])?;
            let bulk = match self.law.kind.bond_based {
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
