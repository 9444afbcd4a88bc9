//! Bonds that weigh otherwise than their length and the lattice spacing say: families of unlike horizons, families made whole.

use super::{Families, FamilyOptions, Neighbour};

/// What bonds are weighed by one at a time, when families are found; bodies are then kept as lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct BondWeights {
    /// Horizons count in the spacing around each particle (`peri_modify horizon own`).
    pub own_horizons: bool,
    /// Families are made whole in each direction (`peri_modify surface tensor`).
    pub whole_families: bool,
    /// Families are given the energy of whole ones at an even growth (`peri_modify surface energy`), under laws whose bonds remember:
    /// plain ones have it in their law, see [`super::Law::surface`].
    pub whole_energies: bool,
}

impl BondWeights {
    /// Whether there is such a thing.
    pub fn any(self) -> bool {
        self.own_horizons || self.whole_families || self.whole_energies
    }
}

/// What weighing bonds one at a time has come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weighed {
    /// The share of bonds that count in part for partial volumes.
    pub in_part: f64,
    /// The mean weight of all bonds by partial volumes.
    pub mean: f64,
    /// What making families whole has changed.
    pub factors: Option<Factors>,
}

/// What a correction has come to: the factors on the weights of bonds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Factors {
    /// The least.
    pub least: f64,
    /// Their mean.
    pub mean: f64,
    /// The largest.
    pub most: f64,
    /// The share of bonds whose factors were cut off.
    pub cut: f64,
}

impl Families {
    /// A particle's own spacing over that of the lattice; 1 unless horizons are the particles' own.
    pub fn spacing_of(&self, i: usize) -> f64 {
        self.spacing.get(i).copied().unwrap_or(1.0)
    }

    /// What multiplies the micro-modulus c of a pair of types, 18K/(πδ⁴) of state-based laws, in the bond from particle `i` that
    /// was so long at the start, under the horizon of the pair.
    pub(crate) fn share_of(&self, i: usize, bond: &Neighbour, length: f64, horizon: f64) -> f64 {
        if self.law.kind.bond_based() || self.spacing.is_empty() {
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
}
