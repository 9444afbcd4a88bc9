//! Bonds that weigh otherwise than their length and the lattice spacing say: families of unlike horizons, families made whole.

/// What bonds are weighed by one at a time, when families are found; bodies are then kept as lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct BondWeights {
    /// Horizons count in the spacing around each particle (`peri_modify horizon own`).
    pub own_horizons: bool,
    /// Families are made whole in each direction (`peri_modify surface tensor`).
    pub whole_families: bool,
    /// Families are given the energy of whole ones at an even growth (`peri_modify surface energy`), under laws whose bonds remember:
    /// plain ones have it in their law, see `surface` of the law.
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
