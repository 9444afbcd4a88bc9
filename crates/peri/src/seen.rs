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

    /// Gives particles thermal strains, in a column that is empty where there are none. The law has to be linear in a bond's stretch, with
    /// columns of its ends: forces, energies and limits of bonds are then those of the stretch without them.
    pub fn warm(&mut self, strain: &[f64]) {
        debug_assert!(strain.is_empty() || self.law.kind.strains_thermally());
        let Self { lattices, list, .. } = self;
        let bodies = lattices.iter_mut().map(|body| (&mut body.scatter, &body.particle, &mut body.state));
        for (scatter, particle, state) in bodies.chain([(&mut list.scatter, &list.particle, &mut list.state)])
        {
            if strain.is_empty() && scatter.heated() {
                // Bond-based laws have no dilatations but these.
                state.theta.fill(0.0);
            }
            scatter.warm(particle, strain);
        }
    }

    /// Whether particles have thermal strains.
    pub fn heated(&self) -> bool {
        self.list.scatter.heated() || self.lattices.iter().any(|body| body.scatter.heated())
    }

    /// The thermal strain of a particle.
    pub fn thermal_strain(&self, i: usize) -> f64 {
        self.scatter_of(i).map_or(0.0, |(scatter, site)| scatter.strain(site))
    }

    /// The factor on how stiff the bonds of a particle are.
    pub(crate) fn stiffness_of(&self, i: usize) -> f64 {
        self.scatter_of(i).map_or(1.0, |(scatter, site)| scatter.stiffness(site))
    }

    /// The factors of a particle's body, and where its own are.
    fn scatter_of(&self, i: usize) -> Option<(&Scatter, usize)> {
        let place = self.place.get(i).copied().filter(|place| *place != u32::MAX)?;
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        Some(match self.lattices.get(body) {
            Some(body) => (&body.scatter, (place - body.first_place) as usize),
            None => (&self.list.scatter, (place - self.list.first_place) as usize),
        })
    }
}
