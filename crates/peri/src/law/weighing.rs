//! What a bond counts in sums and forces, and its stretch, one bond at a time: for tables and single bonds.

use crate::families::{FamilyOptions, Influence, Law};
use crate::law::stretch::{Stretch, closed};

/// What a bond counts.
#[derive(Clone, Copy)]
pub enum Weighing {
    /// ω w.
    Influence(Influence),
    /// c w/|xi| of this shape, with the stretch at which it flows in the place of ω.
    Bond(Influence),
}

impl Weighing {
    /// That of a law.
    pub fn of(law: &Law) -> Self {
        match law.kind.bond_based {
            true => Self::Bond(law.shape()),
            false => Self::Influence(law.influence),
        }
    }

    /// ω and ω w, or what stands for them.
    pub fn weigh(self, length: f64, weight: f64, (c, horizon, yields): (f64, f64, f64)) -> (f64, f64) {
        match self {
            Self::Bond(influence) => (yields, c * influence.shape(length, horizon) * weight / length),
            Self::Influence(influence) => {
                let omega = influence.of(length, horizon);
                (omega, omega * weight)
            }
        }
    }
}

/// A stretch, none inside the dead band; `before` as now.
pub fn banded(z: f64, length: f64, options: &FamilyOptions) -> Stretch<f64> {
    let mut stretch = closed(z);
    if z.abs() < options.dead_band(length) {
        (stretch.s, stretch.share, stretch.before) = (0.0, 0.0, 0.0);
    }
    stretch
}
