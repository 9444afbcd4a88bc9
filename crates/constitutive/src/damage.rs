//! Damage that softens: from its onset on, tension falls over a displacement that spends the fracture energy.

use crate::johnson_cook::FractureStrain;
use crate::site::{Memory, Moment};

/// When damage begins.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Onset {
    /// At this equivalent plastic strain.
    Strain(f64),
    /// Where Σ Δε̄/ε_f reaches 1, with ε_f of Johnson and Cook.
    JohnsonCook(FractureStrain),
    /// Where the largest principal stress of matter that flows reaches this [pressure].
    Stress(f64),
}

/// Softening: after its onset D grows by Δū/ū_f with Δū = Δx Δε̄ and ū_f = 2G_f/σ_y, σ_y that of the onset. A layer of sites then
/// spends G_f per area, whatever Δx is. Stress is (1 − D) times that of the undamaged matter, but for its pressure in compression.
///
/// Source: A. Hillerborg, M. Modéer, P.-E. Petersson, Cem. Concr. Res. 6, 773 (1976) for the displacement.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Damage {
    /// When it begins.
    pub onset: Onset,
    /// Fracture energy G_f [energy/area].
    pub energy: f64,
}

/// The plastic flow of a step, for damage.
#[derive(Clone, Copy, Debug)]
pub struct Flowed {
    /// Increment of the equivalent plastic strain Δε̄ > 0.
    pub step: f64,
    /// Mean stress over equivalent stress p/q.
    pub ratio: f64,
    /// Yield stress at the end of the step [pressure].
    pub limit: f64,
    /// The largest principal stress, where [`Damage::needs_largest`] [pressure].
    pub largest: f64,
}

impl Damage {
    /// Whether its onset depends on the largest principal stress.
    #[inline]
    pub fn needs_largest(&self) -> bool {
        matches!(self.onset, Onset::Stress(_))
    }

    /// Adds the wear and the damage of a step to a memory.
    #[inline]
    pub fn grow(&self, memory: &mut Memory, flowed: Flowed, moment: &Moment) {
        let beyond = match &self.onset {
            Onset::Strain(strain) => worn(memory, flowed.step, *strain),
            Onset::JohnsonCook(law) => {
                let strain = law.at(flowed.ratio, flowed.step, moment.dt, moment.temperature);
                worn(memory, flowed.step, strain)
            }
            Onset::Stress(strength) => {
                memory.wear = memory.wear.max(flowed.largest / strength).min(1.0);
                if memory.wear < 1.0 { 0.0 } else { flowed.step }
            }
        };
        if beyond > 0.0 {
            if memory.onset == 0.0 {
                memory.onset = flowed.limit;
            }
            let opened = moment.spacing * beyond;
            memory.damage = (memory.damage + opened * memory.onset / (2.0 * self.energy)).min(1.0);
        }
    }
}

/// Adds a step of strain to the wear; returns the part of it beyond the onset. Matter whose fracture strain is not positive has none
/// left.
#[inline]
fn worn(memory: &mut Memory, step: f64, strain: f64) -> f64 {
    let intact = if strain > 0.0 { (1.0 - memory.wear) * strain } else { 0.0 };
    let beyond = step - intact.clamp(0.0, step);
    memory.wear = if beyond > 0.0 { 1.0 } else { memory.wear + step / strain };
    beyond
}
