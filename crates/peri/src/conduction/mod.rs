//! Heat conduction over the bonds of families.
//!
//! ```text
//! ρ c dT_i/dt = Σ_j 3 (k_i/m_i + k_j/m_j) ω w (T_j − T_i) V_j h_ij + q_i        m_i = Σ_j ω w |ξ|² V_j
//! ```
//!
//! with the conductivity k, the weighted volume m of the family at birth, and h = 1 for living bonds. In a whole family the second
//! moment of ω w V is m/3 along each axis, so that an even gradient conducts k exactly (Bobaru & Duangpanya 2010 and Oterkus, Madenci &
//! Agwai 2014 give the bond for ω = 1/|ξ|; here it is normalized by each family). A bond conducts the same in both directions: heat is kept
//! to rounding.

pub mod implicit;
mod sweep;

use crate::families::{Families, Influence};
use perigrain_base::par;

/// ω w of all bonds, which stay as they are from birth.
#[derive(Clone, Debug)]
pub struct Conduction {
    /// By lattice and stencil vector [1/length for ω = 1/|ξ|].
    lattices: Vec<Vec<f64>>,
    /// By places in the list's partners.
    list: Vec<f64>,
    /// What a broken bond conducts, over a living one.
    cracks: f64,
}

/// What particles bring to the conductance of their bonds.
#[derive(Clone, Debug, Default)]
pub struct Conductors {
    /// 3 k V/m of each particle; 0 where it does not conduct.
    pub share: Vec<f64>,
    /// Its volume; 0 where it does not conduct.
    pub volume: Vec<f64>,
}

impl Families {
    /// How heat counts the lengths of bonds: as the law of states does, bond-based ones as 1/|ξ|.
    fn conducting_influence(&self) -> Influence {
        if self.law.kind.bond_based { Influence::Inverse } else { self.law.influence }
    }

    /// Σ ω w |ξ|² V over the family at birth, of each particle.
    pub fn conducting_volumes(&self, kinds: &[u16], volumes: &[f64]) -> Vec<f64> {
        let influence = self.conducting_influence();
        let mut m = vec![0.0; kinds.len()];
        par::each(&mut m[..], |start, m: &mut [f64]| {
            for (k, m) in m.iter_mut().enumerate() {
                let i = start + k;
                self.each_apart(i, |bond, length| {
                    let j = bond.partner as usize;
                    let Some(pair) = self.table.get(kinds[i], kinds[j]) else { return };
                    let weight =
                        influence.of(length, pair.horizon) * self.weight_of(&bond, length, pair.horizon);
                    *m += weight * length * length * volumes[j];
                });
            }
        });
        m
    }
}

impl Conduction {
    /// For the bonds of these families; a broken one conducts `cracks` times as well.
    pub fn new(families: &Families, cracks: f64) -> Self {
        let (influence, options) = (families.conducting_influence(), &families.options);
        let lattices = families.lattices.iter().map(|body| {
            let along = |e: usize| {
                let length = body.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                influence.of(length, body.horizon)
                    * options.volume.weight(length, body.horizon, options.lattice_spacing)
            };
            (0..body.stencil.len()).map(along).collect()
        });
        Self { lattices: lattices.collect(), list: sweep::list_weights(families, influence), cracks }
    }

    /// Σ_j g_ij (T_j − T_i) of each particle [energy/time], g = 3 (k_i/m_i + k_j/m_j) ω w V_i V_j h.
    pub fn flow(&self, families: &Families, ends: &Conductors, t: &[f64], out: &mut [f64]) {
        self.gather::<false>(families, ends, t, out);
    }

    /// Σ_j g_ij of each particle [energy/(time temperature)].
    pub fn conductance(&self, families: &Families, ends: &Conductors, out: &mut [f64]) {
        let none = vec![0.0; out.len()];
        self.gather::<true>(families, ends, &none, out);
    }
}

#[cfg(test)]
mod tests;
