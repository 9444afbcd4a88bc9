//! The box of families, the spacing around their particles, and factors on their bonds.

use crate::families::cell::{Cell, strain};
use crate::families::scatter::Scatter;
use crate::families::{Families, FamilyOptions, Neighbour, PeriView};

impl Families {
    /// The box as it is.
    pub(crate) fn cell(&self, view: &PeriView) -> Cell {
        let birth = self.birth.periods();
        let strain = [view.bounds.periods(), self.before.periods()].map(|now| strain(&birth, &now));
        Cell { birth, strain }
    }

    /// The box as it was in the last step that advanced.
    pub(crate) fn cell_before(&self) -> Cell {
        let birth = self.birth.periods();
        Cell { birth, strain: [strain(&birth, &self.before.periods()); 2] }
    }

    /// A particle's own spacing over that of the lattice; 1 unless horizons are the particles' own.
    pub fn spacing_of(&self, i: usize) -> f64 {
        self.spacing.get(i).copied().unwrap_or(1.0)
    }

    /// What multiplies the micro-modulus c of a pair of types, 18K/(πδ⁴) of state-based laws, in the bond from particle `i` that
    /// was so long at the start, under the horizon of the pair.
    pub(crate) fn share_of(&self, i: usize, bond: &Neighbour, length: f64, horizon: f64) -> f64 {
        if self.law.kind.bond_based || self.spacing.is_empty() {
            return self.weight_of(bond, length, horizon);
        }
        // Weights of state-based bonds of unlike horizons are none of a micro-modulus.
        let finer = [i, bond.partner as usize].map(|p| self.spacing_of(p).powi(-4));
        0.5 * (finer[0] + finer[1])
    }

    /// The weight of partial volumes of a bond, and of whatever else it weighs.
    pub(crate) fn weight_of(&self, bond: &Neighbour, length: f64, horizon: f64) -> f64 {
        let FamilyOptions { volume, lattice_spacing, .. } = self.options;
        bond.weight.unwrap_or_else(|| volume.weight(length, horizon, lattice_spacing))
    }

    /// Gives particles factors on the critical stretches and on the micro-moduli of their bonds, in columns that are empty where
    /// there are none. A bond has the smaller strength of its ends and the mean of their stiffnesses, which only
    /// laws with stiffened ends ask for. To be said anew after [`Families::refresh`].
    pub fn scatter(&mut self, strength: &[f64], stiffness: &[f64]) {
        for body in &mut self.lattices {
            body.scatter = Scatter::new(&body.particle, strength, stiffness);
        }
        self.list.scatter = Scatter::new(&self.list.particle, strength, stiffness);
    }

    /// Gives particles other factors on the critical stretches of their bonds, by a column that is empty where there are none.
    pub fn set_strengths(&mut self, strength: &[f64]) {
        for body in &mut self.lattices {
            body.scatter.set_strengths(&body.particle, strength);
        }
        self.list.scatter.set_strengths(&self.list.particle, strength);
    }

    /// The factor on how stiff the bonds of a particle are.
    pub(crate) fn stiffness_of(&self, i: usize) -> f64 {
        let Some(place) = self.place.get(i).copied().filter(|place| *place != u32::MAX) else { return 1.0 };
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        match self.lattices.get(body) {
            Some(body) => body.scatter.stiffness((place - body.first_place) as usize),
            None => self.list.scatter.stiffness((place - self.list.first_place) as usize),
        }
    }
}
