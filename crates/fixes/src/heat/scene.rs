//! What conducts, stores and brings heat at one step, by particles.

use super::boundary::{Boundary, Does};
use perigrain_base::par;
use perigrain_peri::conduction::Conductors;
use perigrain_peri::families::{Families, ForceUnit};
use perigrain_world::World;

/// The particles that conduct, and what happens at the edges; entries of all others are 0.
#[derive(Default)]
pub struct Scene {
    /// What each brings to the conductance of its bonds.
    pub ends: Conductors,
    /// Heat capacities [energy/temperature].
    pub capacity: Vec<f64>,
    /// Heat from elsewhere, and the films' part that does not depend on T [energy/time].
    pub source: Vec<f64>,
    /// What films conduct [energy/(time temperature)].
    pub film: Vec<f64>,
    /// Whether the temperature is given.
    pub held: Vec<bool>,
}

/// A boundary at one step, with its particles.
pub struct Edge {
    pub boundary: Boundary,
    /// Those that conduct.
    pub members: Vec<u32>,
    /// Of how many particles the group is: they share the area.
    pub count: usize,
}

impl Edge {
    /// Finds the particles of a boundary.
    pub fn of(w: &World, boundary: Boundary, conducts: impl Fn(usize) -> bool) -> Self {
        let mask = &w.particles.mask;
        let all = (0..mask.len()).filter(|i| mask[*i] & boundary.bit != 0);
        let (mut members, mut count) = (vec![], 0);
        for i in all {
            count += 1;
            if conducts(i) {
                members.push(i as u32);
            }
        }
        Self { boundary, members, count }
    }

    /// What each particle gets at the temperature 0, and what it loses for each degree.
    pub fn each(&self) -> [f64; 2] {
        let value = self.boundary.value;
        match self.boundary.does {
            Does::Holds => [0.0; 2],
            Does::Heats { area } => [value * area / self.count as f64, 0.0],
            Does::Cools { film, area } => {
                let own = film * area / self.count as f64;
                [own * value, own]
            }
        }
    }
}

impl Scene {
    /// The particles of a group with bonds, of which `m` are the weighted volumes.
    pub fn of(w: &World, families: &Families, bit: u32, m: &[f64]) -> Self {
        let (p, volumes, n) = (&w.particles, w.volumes(), w.n());
        let (mut share, mut volume, mut capacity) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let dense = families.options.unit == ForceUnit::Density;
        par::each(
            (&mut share[..], &mut volume[..], &mut capacity[..]),
            |start, (share, volume, capacity)| {
                for k in 0..share.len() {
                    let i = start + k;
                    if p.mask[i] & bit == 0 || m[i] <= 0.0 {
                        continue;
                    }
                    let own = families.law.of(p.kind[i]);
                    let mass = if dense { p.mass[i] * volumes[i] } else { p.mass[i] };
                    (share[k], volume[k]) = (3.0 * own.conductivity * volumes[i] / m[i], volumes[i]);
                    capacity[k] = mass * own.heat_capacity;
                }
            },
        );
        let ends = Conductors { share, volume };
        Self { ends, capacity, source: vec![0.0; n], film: vec![0.0; n], held: vec![false; n] }
    }

    /// Adds what happens at an edge.
    pub fn add(&mut self, edge: &Edge) {
        let [source, film] = edge.each();
        let holds = edge.boundary.does == Does::Holds;
        for &i in &edge.members {
            let i = i as usize;
            self.source[i] += source;
            self.film[i] += film;
            self.held[i] |= holds;
        }
    }

    /// The longest explicit step, 1/max((Σ g + G)/C): a temperature goes no farther than the mean of those around it.
    pub fn limit(&self, conductance: &[f64]) -> f64 {
        let fastest = par::max(self.capacity.len(), |i| match self.capacity[i] > 0.0 {
            true => (conductance[i] + self.film[i]) / self.capacity[i],
            false => 0.0,
        });
        if fastest > 0.0 { 1.0 / fastest } else { f64::INFINITY }
    }
}
