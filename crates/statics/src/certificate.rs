//! A lower bound of the energy, for any field.
//!
//! Prager and Synge: if bond forces τ balance the residual of a field at all free particles, its energy
//! exceeds the minimum by at most ½ τᵀ C τ, with the bonds' compliances C. Beams transmit all six components,
//! so that such forces can be led from bond to bond to the held particles.

use super::network::Network;
use super::six::Six;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};

/// Paths along which a residual is led to the held particles.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// Particles with paths to the held ones, farthest first.
    order: Vec<u32>,
    /// Index in `towards` of each particle's first bond, in the same order.
    first: Vec<u32>,
    /// Bonds to particles one step nearer.
    towards: Vec<u32>,
    rotations: bool,
}

impl Certificate {
    /// For fully held particles in `base` and ignored particles `out`. Without `rotations`, particles support
    /// any torque.
    pub fn new(network: &Network, base: impl Fn(usize) -> bool, out: &[bool], rotations: bool) -> Self {
        let n = network.particles;
        let (starts, partners) = partners(network);
        let mut level = vec![u32::MAX; n];
        let mut order: Vec<u32> = (0..n as u32).filter(|k| base(*k as usize) && !out[*k as usize]).collect();
        order.iter().for_each(|k| level[*k as usize] = 0);
        let mut at = 0;
        while let Some(&k) = order.get(at) {
            at += 1;
            for [_, other] in &partners[starts[k as usize] as usize..starts[k as usize + 1] as usize] {
                if level[*other as usize] == u32::MAX {
                    level[*other as usize] = level[k as usize] + 1;
                    order.push(*other);
                }
            }
        }
        order.retain(|k| level[*k as usize] > 0);
        order.reverse();
        let (mut first, mut towards) = (vec![0], vec![]);
        for &k in &order {
            let own = &partners[starts[k as usize] as usize..starts[k as usize + 1] as usize];
            let nearer = own.iter().filter(|[_, o]| level[*o as usize] + 1 == level[k as usize]);
            towards.extend(nearer.map(|[bond, _]| *bond));
            first.push(towards.len() as u32);
        }
        Self { order, first, towards, rotations }
    }

    /// Upper bound of the energy of a field above the minimum, from its residual [energy]; infinite if a bond
    /// would need a component that it cannot transmit.
    pub fn gap(&self, network: &Network, r: &[Six]) -> f64 {
        let mut wrench = r.to_vec();
        let mut gap = 0.0;
        for (k, &a) in self.order.iter().enumerate() {
            let bonds = &self.towards[self.first[k] as usize..self.first[k + 1] as usize];
            let total: f64 = bonds.iter().map(|b| network.k[*b as usize].normal).sum();
            let [fx, fy, fz, tx, ty, tz] = wrench[a as usize];
            for bond in bonds.iter().map(|b| *b as usize) {
                let [i, j] = network.pairs.ends[bond];
                // From the parent b to the child a.
                let (b, way) = if i == a { (j, scale(-1.0, network.d(bond))) } else { (i, network.d(bond)) };
                let w = network.k[bond].normal / total;
                let (f, t) = (scale(w, [fx, fy, fz]), scale(w, [tx, ty, tz]));
                let arm = cross(way, f);
                let moment = if self.rotations { add(t, scale(0.5, arm)) } else { [0.0; 3] };
                gap += self.strained(network, bond, f, moment);
                let row = &mut wrench[b as usize];
                (0..3).for_each(|c| row[c] += f[c]);
                if self.rotations {
                    (0..3).for_each(|c| row[3 + c] += t[c] + arm[c]);
                }
            }
        }
        gap
    }

    /// ½ (F_n²/k_n + |F_t|²/k_s + M_n²/k_t + |M_t|²/k_b).
    fn strained(&self, network: &Network, bond: usize, f: Vec3, m: Vec3) -> f64 {
        let (n, k) = (network.n(bond), &network.k[bond]);
        let (along, twist) = (dot(n, f), dot(n, m));
        let (across, bend) = (sub(f, scale(along, n)), sub(m, scale(twist, n)));
        let over = |square: f64, k: f64| if square == 0.0 { 0.0 } else { square / k };
        0.5 * (over(along * along, k.normal)
            + over(dot(across, across), k.shear)
            + over(twist * twist, k.twist)
            + over(dot(bend, bend), k.bend))
    }
}

/// Bonds and partners of each particle, and where they begin.
fn partners(network: &Network) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut starts = vec![0u32; network.particles + 1];
    for end in network.pairs.ends.iter().flatten() {
        starts[*end as usize + 1] += 1;
    }
    for k in 0..network.particles {
        starts[k + 1] += starts[k];
    }
    let mut at = starts.clone();
    let mut list = vec![[0; 2]; 2 * network.bonds()];
    for (bond, [i, j]) in network.pairs.ends.iter().enumerate() {
        for (own, other) in [(i, j), (j, i)] {
            list[at[*own as usize] as usize] = [bond as u32, *other];
            at[*own as usize] += 1;
        }
    }
    (starts, list)
}
